"""The study's chapters."""

from workbench.report import numbers
from workbench.report.contents import Chapter, Paragraph, Table
from workbench.report.reproduction import Printed

from . import actuator as fig1
from . import drawn, paper
from .actuator import Actuator
from .chapters_compensated import compensation_chapter, limits_chapter, responses_chapter
from .compensated import Compensated
from .identified import Identified, Ladder
from .ladder import preload_gain
from .loop import CALIBRATED, PRINTED, Margins, margins, notch
from .records import HELD_OUT


def gain(value: float) -> str:
    return numbers.placed(value, 4) if value < 0.1 else numbers.placed(value, 3)


def every(seen: Actuator, fits: Identified, held: Compensated, printed: list[Printed]) -> tuple[Chapter, ...]:
    """Return all chapters, in the order of the paper."""
    return (
        loop_chapter(),
        actuator_chapter(seen),
        extraction_chapter(fits),
        operators_chapter(fits),
        beyond_chapter(fits),
        responses_chapter(fits, held),
        compensation_chapter(held),
        limits_chapter(held),
        paper.chapter(printed),
    )


def loop_chapter() -> Chapter:
    """Presets, margins, the notch."""
    found = notch()
    text = (
        "The plant is K P_res(s)/s² of eq. (2), the controller eq. (1) at 12 kHz, without further delay; margins are python-control's, "
        "of the plant behind its hold. At that rate the printed filter has its zeros at "
        f"{found['zero_frequency']:.1f} Hz with a damping ratio of {found['zero_damping']:.4f}, and its poles at "
        f"{found['pole_frequency']:.1f} Hz with {found['pole_damping']:.4f}: a notch on the first mode, which proves the rate."
    )
    rows = [
        ("printed in the paper", "", "945", "49", "8.7", "", ""),
        *(row(p.name, p.kc, margins(p)) for p in (PRINTED, CALIBRATED)),
    ]
    table = Table(
        ("loop", "kc", "crossover (Hz)", "phase (°)", "gain (dB)", "gain may fall by (dB)", "Ms (dB)"), tuple(rows),
        "Margins of the loop on the plant without friction. All that follows is with “calibrated”.", "lrrrrrr",
    )  # fmt: skip
    return Chapter("The loop, as printed and as it must have been", (Paragraph(text), table))


def row(name: str, kc: float, m: Margins) -> tuple[str, ...]:
    cells = (m.crossover, m.phase, m.gain, -m.lower, m.sensitivity)
    return (name, f"{kc:g}", *(numbers.placed(v, 0 if i == 0 else 1) for i, v in enumerate(cells)))


def actuator_chapter(seen: Actuator) -> Chapter:
    """Fig. 1 again, and eq. (2) out of it."""
    said = fig1.expected()
    first, second = seen.modes.modes[0], seen.modes.modes[-1]
    got = {
        "K₀ (V/(V s²))": (said["gain"], seen.gain),
        "first mode (Hz)": (said["first_frequency"], first.frequency),
        "its damping ratio": (said["first_damping"], first.damping),
        "zero (Hz)": (said["zero_frequency"], seen.zero[0]),
        "its damping ratio ": (said["zero_damping"], seen.zero[1]),
        "second mode (Hz)": (said["second_frequency"], second.frequency),
        "its damping ratio  ": (said["second_damping"], second.damping),
    }
    table = Table(
        ("what", "eq. (2)", "modal fit", "off"),
        tuple((n, numbers.number(a, 5), numbers.number(b, 5), numbers.percent(b / a - 1.0)) for n, (a, b) in got.items()),
        "The actuator as printed and as fitted.", "lrrr",
    )  # fmt: skip
    text = (
        "A multisine from 300 Hz to 18 kHz shakes the actuator at its input, through its friction, with windage and the vibrometer's "
        "noise; the workbench fits modes to acceleration over drive, behind a delay that the hold makes."
    )
    return Chapter("The actuator, measured again", (Paragraph(text), drawn.actuator(seen), table))


def extraction_chapter(fits: Identified) -> Chapter:
    """How friction is got out of u and x, and what the noise leaves."""
    text = (
        "f = u − u_a, and u_a is x divided by the plant behind its zero-order hold, line by line of the spectrum of whole settled "
        "periods, up to 250 Hz (or five harmonics), averaged. Without noise it is right to "
        f"{numbers.number(max(fits.peak.floor, fits.amplitude.floor), 2)} mV/V; with a windage of 0.3 mV, 50 periods leave a floor of "
        f"{gain(fits.noisy.floor)} mV/V. An energy gain without its floor says nothing: below, it stands beside each."
    )
    rows = tuple((n, gain(v)) for n, v in fits.converted.items())
    converters = Table(
        ("records through 16 bits over 20 V", "mV/V"), rows,
        "With converters: one count is 0.3 mV, and the friction at 0.25 V spans a few. Not judged.", "lr",
    )  # fmt: skip
    return Chapter("Friction, got out of the records", (Paragraph(text), drawn.drive_over_position(), converters))


def ladder_rows(one: Ladder):
    """Rows of the ladder's table for one set."""
    best = one.best_simplex
    spread = f"{gain(min(s.gain for s in one.simplex))} to {gain(max(s.gain for s in one.simplex))}"
    met = sum(s.converged for s in one.simplex)
    yield one.name, "floor", gain(one.floor), ""
    yield (
        one.name,
        "simplex search, 3 + 3",
        gain(best.gain),
        f"{spread}; {met} of {len(one.simplex)} starts met its tolerances",
    )
    yield one.name, "passive, 3 + 3, radii and rates searched", gain(one.passive.gain), spread_of(one.passive.starts)
    yield one.name, "passive, dense", gain(one.dense.gain), f"{active(one)} elements in use"
    yield one.name, "passive, springs never rise with radius", gain(one.shaped.gain), "quadratic program"
    yield one.name, "preload and two slopes", gain(one.preload_gain), "all amplitudes"
    others = ", ".join(gain(preload_gain(one.smallest, [e.record])) for e in one.seen[1:])
    yield one.name, "the same, of the smallest amplitude", gain(one.smallest_gain), f"on the others {others}"


def spread_of(starts) -> str:
    return f"{gain(min(starts))} to {gain(max(starts))} over {len(starts)} starts"


def active(one: Ladder) -> int:
    return int((one.dense.bank.springs > 0).sum() + (one.dense.bank.creeps > 0).sum())


def operators_chapter(fits: Identified) -> Chapter:
    """Fig. 5, the ladder, Figs. 6, 7, 9 and 10."""
    better = fits.amplitude
    text = (
        "F = k₀ x + Σ kᵢ (x − playᵢ) + Σ cⱼ (x − lⱼ) with all weights at or above zero is the paper's operator, written so that it is "
        "passive: its negative weights are springs that slip or creep. The least squares is then convex. Against "
        f"{gain(better.best_simplex.gain)} mV/V of the paper's own search, as many passive operators leave {gain(better.passive.gain)}, "
        f"and a dense bank {gain(better.dense.gain)}; what is left there is not friction of this class: limits that grow with "
        "speed, and a cubic."
    )
    rows = tuple(r for one in (fits.amplitude, fits.peak, fits.noisy) for r in ladder_rows(one))
    table = Table(
        ("amplitudes read as", "fit", "mV/V", "of what, and else"), rows,
        "Energy gain of every way to the weights, at 10 Hz. “3 + 3”: plays and creep operators.", "wwrp",
    )  # fmt: skip
    blocks = (Paragraph(text), drawn.operators(), table, drawn.friction_loops(fits.noisy), drawn.rivals(fits.peak))
    return Chapter("Operators, and every way to their weights", blocks)


def beyond_chapter(fits: Identified) -> Chapter:
    """What one frequency cannot determine, and what several do."""
    b = fits.broad
    tests = (
        (f"{f:g} Hz, {a:g} V", gain(one), gain(few), gain(many))
        for (f, a), one, few, many in zip(HELD_OUT, held_of(fits), b.few_held, b.held, strict=True)
    )
    table = Table(
        ("not fitted", "10 Hz alone, dense", "2, 10, 40, 100 Hz, 3 + 3", "the same, dense"), tuple(tests),
        "Energy gain, mV/V, on other frequencies and amplitudes, against the pivot without noise.", "lrrr",
    )  # fmt: skip
    rank = {one.name: one.rank[0] for one in (fits.peak, fits.amplitude)}
    text = (
        "At one settled frequency x and all creep operators span two dimensions: of the paper's ten parameters "
        f"{rank['peak to peak']} can be told where its amplitudes are peak to peak, {rank['amplitude']} where they are amplitudes, and "
        f"{b.rank[0]} from four frequencies and four amplitudes (there the largest play is never left). A model of 10 Hz alone is "
        "right at 10 Hz. The model that is used from here on is of all four frequencies."
    )
    chosen = ", ".join(f"{numbers.placed(v, 3)} with {even:g}" for even, v in b.left.items())
    more = (
        "Records of large displacement rule a sum of squares. To count small ones for more is a knob and no gain: root mean square, over "
        f"records that are left out in turn, of the energy gain on them {chosen} (0: as here; 1: all records alike), floors included."
    )
    return Chapter("What one frequency cannot determine", (Paragraph(text), table, Paragraph(more)))


def held_of(fits: Identified) -> list[float]:
    from .ladder import held_out

    return held_out(fits.noisy.dense.bank, fits.broad.tests)

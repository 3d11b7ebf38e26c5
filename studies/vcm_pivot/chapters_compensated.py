"""The chapters on the nonlinear loop: its responses over amplitude, the friction compensated, and what that does not bear."""

from workbench.report import numbers
from workbench.report.contents import BAD, GOOD, Callout, Chapter, Heading, Items, Marked, Paragraph, Table

from . import drawn
from .compensated import SIZES, TEN, Compensated, ceiling, off_response
from .identified import Identified
from .limits import largest_decaying


def decibels(value: float) -> str:
    return f"{numbers.placed(value, 1)}\u00a0dB"


def responses_chapter(fits: Identified, held: Compensated) -> Chapter:
    """Fig. 8, and the best linear approximation."""
    magnitude, phase = off_response(held, fits.broad.bank)
    preload, _ = off_response(held, fits.peak.smallest)
    text = (
        "The response of this actuator depends on amplitude. Sines stepped through the loop are the reference; the describing "
        f"function of the identified bank is within {decibels(magnitude)} and {phase:.1f}° of them from 5 to 300 Hz, and costs "
        f"milliseconds; preload and two slopes are {decibels(preload)} off. So the paper's claim holds, where the records "
        "excite more than 10 Hz. The best linear approximation under a multisine is another thing, and a detector: its scatter from "
        "phase to phase falls where compensation has made the actuator linear."
    )
    blocks = (
        Paragraph(text),
        drawn.responses(held, fits.broad.bank, fits.peak.smallest),
        drawn.best_linear_figure(held),
    )
    return Chapter("Responses of a loop that is not linear", blocks)


def compensation_chapter(held: Compensated) -> Chapter:
    """Figs. 11 to 15."""
    rows = tuple(
        (
            f"{a:g} V",
            decibels(held.simplex[a]),
            decibels(float(held.change(a)[TEN])),
            decibels(ceiling(held, a)),
            within(float(held.after[a].over_integrator[TEN])),
        )
        for a in SIZES
    )
    table = Table(
        ("reference", "paper's search, 10 Hz alone", "dense, four frequencies", "friction gone", "x/u over K₀/s²"), rows,
        "Change of |S| at 10 Hz. Beyond “friction gone” it is over-compensated: the actuator answers with more than its "
        "inertia alone would (last column, of the dense bank).", "lrrrr",
    )  # fmt: skip
    text = (
        "The identified force is added to the controller's command (Fig. 11), at the same sample, from the measured position. "
        "The 20 dB at 10 Hz are had at every amplitude, and more than the paper's at 0.25 V. Both sides count: "
        "inertia at 10 Hz is 0.079 mV/V, so a model that is off by as much leaves a resonance where it removes a spring."
    )
    cost = (
        f"It has a price. From 50 to 120 Hz |S| rises by up to {decibels(held.hump)}: the "
        "pivot's stiffness and loss held the head there, and without them |S| is that of the linear loop, within "
        f"{decibels(max(held.hump_off(a) for a in (0.25, 0.5, 1.5)))}."
    )
    blocks = (
        Paragraph(text), table, drawn.compensated_responses(held), drawn.sensitivities(held), Callout(cost),
        drawn.straightened(held),
    )  # fmt: skip
    return Chapter("The friction, compensated", blocks)


def within(value: float) -> Marked:
    return Marked(f"{'+' if value > 0 else ''}{decibels(value)}", GOOD if abs(value) <= 3.0 else BAD)


def limits_chapter(held: Compensated) -> Chapter:
    """Mismatch, over-compensation, the bare double integrator, and disturbances that it does not see."""
    over = {n: largest_decaying(v) for n, v in held.over.items()}
    weak = held.weak
    said = (
        f"Too much of it: every motion still decays with {over['calibrated']:g} times the friction ({over['printed']:g} times with "
        "the printed gain); beyond, the loop hunts.",
        "Another pivot: with 0.7 or 1.3 times the friction "
        f"{decibels(held.off['friction 0.7'])} and {decibels(held.off['friction 1.3'])} are left of {decibels(held.off['gain 1'])}; with "
        f"other break-away displacements {decibels(held.off['break-away 0.7'])} and {decibels(held.off['break-away 1.3'])}.",
        "A weak loop: with kc = 0.02 the pivot's stiffness is all that holds the head. A pulse dies out with friction "
        f"({numbers.number(weak['with the pivot'], 1)} of it is left), and grows with the friction compensated "
        f"({numbers.number(weak['compensated'], 2)}) as it does on the bare double integrator. A loop is checked there before "
        "compensation closes.",
    )
    rows = tuple(
        (place(d), *(decibels(d[n]) for n in ("compensation", "from the reference", "observer", "both")))
        for d in held.disturbed
    )
    table = Table(
        ("disturbance", "compensation", "of the reference", "observer, 200 Hz", "both"), rows,
        "Change of the error, by friction compensation from measured position or from the reference, by a disturbance observer, and by "
        "both. Output: seen by the loop alone, as a drive without a vibrometer sees its track.", "lrrrr",
    )  # fmt: skip
    worth = (
        "For a force at the input, and for a disturbance that only the position error shows, friction compensation is worth nothing: "
        "the loop holds what it reads still, and an operator that reads no motion adds no force. An observer is worth 22 dB "
        "there. The paper's scheme is for references, with the position measured absolutely."
    )
    blocks = (drawn.limits_figure(held), Items(said), Heading("Which sensitivity"), Callout(worth, BAD), table)
    return Chapter("What compensation does not bear, and where it helps nothing", blocks)


def place(d: dict) -> str:
    return f"{d['where']}, {d['amplitude']:g} V, {d['frequency']:g} Hz"

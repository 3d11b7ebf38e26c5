"""A voice-coil pivot: its loop, its friction got out of records, named by operators, and compensated.

The pivot and its loop are simulated beside the workbench (machine.py); fits, describing functions and the modal fit are the
workbench's own.
"""

from workbench.description import described
from workbench.finding import Finding
from workbench.report.recommend import RECOMMENDED
from workbench.study import standard
from workbench.study.configuration import Study
from workbench.study.outcome import Outcome, Part, with_part
from workbench.tracing.tracing import trace

from . import actuator, bias, chapters, compensated, identified, limits, paper
from .identified import Sizes
from .loop import CALIBRATED, PRINTED, margins, notch
from .records import Noise

FURTHER = ("noise", "fits")
BITS = 16
LOOPS = {PRINTED: (274.0, 23.7, 21.2), CALIBRATED: (945.0, 41.4, 8.5)}  # Hz, deg, dB that each preset stands for


def run(study: Study, say) -> Outcome:
    """Check the loop, measure the actuator, fit, compensate, look for the limits, and trace a cable's pull."""
    noise, count, sizes = asked(study)
    say("measuring the actuator's frequency response")
    seen = actuator.measured(noise.windage, noise.sensor)
    fits = identified.identified(noise, count, sizes, say)
    bank = fits.broad.bank
    held = compensated.compensated(bank, fits.amplitude.best_simplex.bank, say)
    figures, units = compensated.figures(held, bank, fits.peak.smallest)
    outcome = with_part(
        traced(study, fits, noise, say),
        Part(figures | loop_figures(seen) | fit_figures(fits), units | UNITS, findings=(advice(fits, held),)),
    )
    printed = paper.rows(fits, held)
    tables = {"reproduction": paper.as_table(printed), "converters": fits.converted, "disturbances": held.disturbed}
    return with_part(
        outcome, Part(paper.counted(printed), {}, chapters.every(seen, fits, held, printed), (), tables)
    )  # fmt: skip


def advice(fits: identified.Identified, held: compensated.Compensated) -> Finding:
    """Return what to do about the pivot, for the first page: what compensation is worth, what it costs, and where it is worth nothing."""
    falls = [-float(held.change(a)[compensated.TEN]) for a in compensated.SIZES]
    forced = held.at("force", limits.TEN)
    sentence = (
        f"Compensate the friction where the position is measured absolutely or planned: at 10 Hz the error of a reference falls by "
        f"{min(falls):.0f} to {max(falls):.0f} dB, over 0.25 to 3 V. The bank leaves {fits.amplitude.dense.gain:.3f} mV/V of the "
        f"friction, as many passive operators as the paper's {fits.amplitude.passive.gain:.3f}, and the paper 0.08. It costs up to "
        f"{held.hump:.1f} dB from 50 to 120 Hz, and against a force, or an error that the loop alone sees, it is worth "
        f"{abs(forced['compensation']):.1f} dB: there take a disturbance observer ({forced['observer']:.0f} dB)."
    )
    return Finding(RECOMMENDED, "compensation", sentence)


def asked(study: Study) -> tuple[Noise, float, Sizes]:
    """Return (noise, V of one count of the converters, sizes of the fits) as study.toml states them."""
    given = study.table.table("noise", ("windage", "sensor", "averages", "converter"))
    fits = study.table.table("fits", ("starts", "dense", "many", "few", "even"))
    noise = Noise(
        *(given.quantity(n, "V", above=0.0) for n in ("windage", "sensor")), int(given.number("averages", above=1.0))
    )
    pairs = (tuple(int(v) for v in fits.values[n]) for n in ("dense", "many", "few"))
    sizes = Sizes(int(fits.number("starts", above=0.0)), *pairs, fits.number("even"))
    return noise, given.quantity("converter", "V", above=0.0) / 2**BITS, sizes


UNITS = {
    "a1_notch_frequency": "Hz",
    "a2_crossover": "Hz",
    "a2_phase_margin": "deg",
    "a2_gain_margin": "dB",
    **dict.fromkeys(
        (
            "a5_extraction", "a6_passive_as_many", "a6_dense", "a7_passive_as_many", "a7_dense", "a8_floor", "a8_gain",
            "a8_against_true", "a10_held_out", "simplex_amplitude", "simplex_peak_to_peak", "trained_on_ten_held_out",
        ),
        "mV/V",
    ),
}  # fmt: skip


def loop_figures(seen: actuator.Actuator) -> dict[str, float]:
    """Rows A1 and A2, and what the modal fit says of eq. (2)."""
    found, filtered = {p: margins(p) for p in LOOPS}, notch()
    first, second = seen.modes.modes[0], seen.modes.modes[-1]
    said, got = actuator.expected(), {"gain": seen.gain, "zero_frequency": seen.zero[0]}
    got |= {"first_frequency": first.frequency, "second_frequency": second.frequency}
    got |= {"first_damping": first.damping, "second_damping": second.damping}
    return {
        "a1_notch_frequency": max(abs(filtered[f"{n}_frequency"] - 4200.0) for n in ("zero", "pole")),
        "a1_notch_damping": max(abs(filtered["zero_damping"] - 0.05), abs(filtered["pole_damping"] - 0.10)),
        "a2_crossover": max(abs(found[p].crossover - v[0]) for p, v in LOOPS.items()),
        "a2_phase_margin": max(abs(found[p].phase - v[1]) for p, v in LOOPS.items()),
        "a2_gain_margin": max(abs(found[p].gain - v[2]) for p, v in LOOPS.items()),
        "modes_off": max(abs(got[n] / said[n] - 1.0) for n in got),
    }


def fit_figures(fits: identified.Identified) -> dict[str, float]:
    """Rows A3 to A10."""
    identity, inverse, describing = identified.identities()
    ten = identified.worst(fits.noisy.dense.bank, fits.broad.tests)
    everything = [fits.peak.dense, fits.amplitude.dense, fits.noisy.dense, fits.broad.fit]
    return {
        "a3_identity": identity,
        "a3_inverse": inverse,
        "a4_describing_function": describing,
        "a5_extraction": max(fits.peak.floor, fits.amplitude.floor),
        "a6_passive_as_many": fits.amplitude.passive.gain,
        "a6_dense": fits.amplitude.dense.gain,
        "a7_passive_as_many": fits.peak.passive.gain,
        "a7_dense": fits.peak.dense.gain,
        "a8_floor": fits.noisy.floor,
        "a8_gain": fits.noisy.dense.gain,
        "a8_gain_over_floor": fits.noisy.dense.gain / fits.noisy.floor,
        "a8_against_true": fits.noisy.true(fits.noisy.dense.bank),
        "a9_optimality": max(f.optimality for f in everything),
        "a10_held_out": max(fits.broad.held),
        "simplex_amplitude": fits.amplitude.best_simplex.gain,
        "simplex_peak_to_peak": fits.peak.best_simplex.gain,
        "trained_on_ten_held_out": ten,
        "identifiable_of_ten_parameters": float(fits.peak.rank[0]),
    }


def traced(study: Study, fits: identified.Identified, noise: Noise, say) -> Outcome:
    """Trace the records of a loop whose flex cable pulls to one side, from the identified pivot."""
    lacking = bias.declared(fits.broad.few.bank)
    seen = bias.inverses(noise)
    found = trace(lacking, seen, say, most=2, only=bias.CANDIDATES)
    return Outcome(
        plant=lacking,
        campaign="synthetic pivot with a flex cable that the declared model lacks (chapters 2 to 7), records simulated by this study",
        bandwidth=bias.BANDWIDTH,
        trace=found,
        records=tuple(p.motion.record for p in seen),
        equivalents=described(found.after.plant, standard.amplitudes(study)),
        figures=found.figures,
        findings=(*found.findings, *found.after.findings),
    )

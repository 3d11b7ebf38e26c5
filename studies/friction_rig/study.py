"""The friction rig: from a declared Coulomb friction to what the measured loops ask for.

178 steps of the time axis are twice as long as the others (single dropped samples); the record is resampled at its
median step, and the report says so. Only the loaded part counts. The rig measures friction itself, so there is no inertia,
and nothing of a drive (its lag, its magnets, the force that it carries) is a candidate.
"""

from collections.abc import Sequence
from statistics import median

import numpy as np

from workbench import readers
from workbench.definition import find
from workbench.effects.hysteresis import maxwell_slip
from workbench.finding import Finding, title
from workbench.identification.by_role import refitted
from workbench.identification.fit import identify
from workbench.identification.result import Estimate, Fit
from workbench.inverse.dynamics import inverse_dynamics
from workbench.motion import Motion
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, ROLES, VALIDATION, Record
from workbench.report import drawing
from workbench.report.contents import Chapter, Figure, Items, Paragraph, Table
from workbench.report.steps import hundredths, steps_table
from workbench.residual.attainable import attainable
from workbench.study.configuration import Study
from workbench.study.outcome import Outcome
from workbench.tracing.result import Trace
from workbench.tracing.steps import steps
from workbench.tracing.tracing import trace
from workbench.units import to_si

FURTHER = ("rig",)
COLUMNS = {"time": "t_s", "normal": "normal_N", "position": "pos_um", "force": "friction_N"}
CONTACT = (
    "presliding_length presliding_hysteresis lugre_friction fading_memory creep stribeck_friction viscous_friction "
    "nonlinear_viscous_friction coulomb_asymmetry cyclic_friction friction_drift cable_spring kinematic_error sensor_trend "
    "clock_skew"
).split()  # what a contact and its two sensors can have; the rest of the catalogue belongs to a drive or a mass
SLIPS = tuple(np.linspace(5e-6, 120e-6, 24))  # m, to the half of the largest stroke; stiffnesses come from the data
STILL, DWELL = 0.05, 0.5  # of the largest speed; s: what a dwell is
LOOP = 1600  # samples of two cycles of 4 s: the figure shows the first of the last two


def rig(study: Study):
    """Return the table of study.toml that says how the record is read."""
    return study.table.table("rig", ("loaded_above", "split", "settled", "bandwidth", "logged", "resolution"))


def records(study: Study) -> tuple[tuple[Record, Record], Finding]:
    """Return the loaded record in its two roles, resampled, and what was done to it."""
    given = rig(study)
    channels, source = readers.read(study.measured("record"), COLUMNS)
    time, position = channels["time"], to_si(channels["position"], "um", "m", "pos_um")
    steps = np.diff(time)
    step = median(steps)
    off = np.flatnonzero(np.abs(steps - step) > 0.01 * step)
    loaded = np.flatnonzero(channels["normal"] > given.quantity("loaded_above", "N", above=0.0))
    first, last = loaded[0], loaded[-1]
    inside = int(np.count_nonzero((off >= first) & (off < last)))
    even = time[first] + step * np.arange(int((time[last] - time[first]) / step + 1.5))
    values = {"position": np.interp(even, time, position), "force": np.interp(even, time, channels["force"])}
    split = given.quantity("split", "s", above=0.0)
    before = even < split

    def record(role: str, keep: np.ndarray, counts_from: float) -> Record:
        return Record(
            name=role,
            role=role,
            time=even[keep].copy(),
            channels={n: v[keep].copy() for n, v in values.items()},
            units={"position": "m", "force": "N"},
            source=source,
            resolution={"position": given.quantity("resolution", "m", above=0.0)},
            motion="reciprocating, 1 s ramps at about 0.23 mm/s with 1 s dwells",
            counts_from=counts_from,
        )

    # The validation record holds the first half too, for the state of the operators; errors count after the split only.
    settled = given.quantity("settled", "s")
    pair = (record(IDENTIFICATION, before, settled), record(VALIDATION, np.ones(even.size, bool), split))
    finding = Finding(
        "resampled",
        source.path.name,
        f"{off.size} of {steps.size} time steps differ from {1e3 * step:.0f} ms (single dropped samples), {inside} of them "
        "while the contact is loaded; the record was resampled by linear interpolation.",
        {"steps": float(off.size), "while loaded": float(inside), "largest": float(steps.max())},
    )
    return pair, finding


def above(record: Record, frequency: float) -> float:
    """Return what share of the rms of the logged force lies above a frequency in Hz."""
    force = record.channels["force"]
    spectrum = np.abs(np.fft.rfft((force - force.mean()) * np.hanning(force.size))) ** 2
    return float(np.sqrt(spectrum[np.fft.rfftfreq(force.size, record.dt) > frequency].sum() / spectrum[1:].sum()))


def dwells(motion: Motion, loaded_from: float) -> dict[str, np.ndarray]:
    """Return, for the two ends of the stroke, mean position in m and force in N of every dwell, (dwells, 2)."""
    still = np.abs(motion.v) < STILL * np.abs(motion.v).max()
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still.view(np.int8), [0]])))
    spans = [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if (b - a) * motion.dt > DWELL]
    means = np.array([
        [motion.record.channels[n][(a + b) // 2 : b].mean() for n in ("position", "force")]
        for a, b in spans if motion.t[a] > loaded_from
    ])  # fmt: skip
    middle = 0.5 * (means[:, 0].min() + means[:, 0].max())
    return {"near": means[means[:, 0] < middle], "far": means[means[:, 0] > middle]}


def slope(means: np.ndarray) -> tuple[float, float]:
    """Return (slope in N/m, correlation) of force over position from dwell to dwell."""
    q, force = means.T
    return float(np.polyfit(q - q.mean(), force, 1)[0]), float(np.corrcoef(q, force)[0, 1])


def run(study: Study, say) -> Outcome:
    """Trace the declared Coulomb friction, fit the Maxwell-slip models beside it, and say what can be attained."""
    pair, resampled = records(study)
    given = rig(study)
    bandwidth, logged = (given.quantity(n, "Hz", above=0.0) for n in ("bandwidth", "logged"))
    inverses, slow = inverse_dynamics(pair, bandwidth), inverse_dynamics(pair, logged)
    offset = Plant(ONE_MASS, (find("constant_offset"),), rotary=False)
    declared = offset + find("coulomb_friction")
    found = trace(declared, slow, say, only=CONTACT, own=(find("presliding_length"),))
    say("fitting Maxwell slip")
    models = {
        "Coulomb friction, held in the dwells": identify(declared, inverses),
        "Presliding hysteresis, exponential virgin curve": identify(
            offset + find("presliding_hysteresis")(x0=1e-5), inverses
        ),
        "One Maxwell-slip element": identify(offset + maxwell_slip((1e-5,), searched=True), inverses),
        f"A bank of {len(SLIPS)} Maxwell-slip elements": identify(offset + maxwell_slip(SLIPS), inverses),
        "One element, stiffer in one direction": identify(
            declared + find("presliding_length")(length=5e-5) + find("coulomb_asymmetry"), inverses
        ),
        "As traced": identify(found.after.plant, inverses),
    }
    coulomb, exponential, one, bank, uneven, traced = models.values()
    floors = attainable(found.after, slow)
    days = refitted(found.after.plant, slow)
    ends = dwells(inverses[1].motion, given.quantity("settled", "s"))
    figures = found.figures | {
        "validation_error_coulomb": coulomb.validation,
        "validation_error_exponential": exponential.validation,
        "validation_error_one_element": one.validation,
        "validation_error_bank": bank.validation,
        "validation_error_uneven": uneven.validation,
        "validation_error_whole_band": traced.validation,
        "force_above_logged": above(pair[1], logged),
        "dwell_correlation": max(slope(e)[1] for e in ends.values()),
        "record_floor": floors.across,
    }
    figures |= {f"repeat_floor_{role}": floor for role, floor in floors.within.items()}
    return Outcome(
        plant=declared,
        campaign="reciprocating dry contact under 5 N",
        bandwidth=logged,
        trace=found,
        records=pair,
        figures=figures,
        chapters=(
            evidence_chapter(found, figures["force_above_logged"], logged, bandwidth, traced),
            hysteresis_chapter(models),
            attainable_chapter(floors, ends, days, found.after),
        ),
        findings=(resampled, *found.findings, *found.after.findings),
        tables={
            "models": [
                {"model": n, "identification": f.identification, "validation": f.validation} for n, f in models.items()
            ],
            "evidence": [vars(s) for s in steps(found)],
        },
    )


# --- chapters --------------------------------------------------------------------------------------------------------


def meanings(estimates: Sequence[Estimate]) -> dict[str, str]:
    """Return effect -> what it means of the contact, by the estimates of a model that may have it."""
    values = {(e.effect, e.parameter): e.value for e in estimates}
    length = values.get(("presliding_length", "length"), np.nan)
    off, order = (values.get(("kinematic_error", n), np.nan) for n in ("amplitude", "order"))
    level = values["coulomb_friction", "coulomb"]
    if level > 0.0:
        uneven = values.get(("coulomb_asymmetry", "coulomb_difference"), np.nan) / level
        spring = f"a spring of {level / length:.3g} N/m that slips."
        sides = (
            f"The spring is {100 * abs(uneven):.0f} % {'softer' if uneven < 0 else 'stiffer'} under forward force and as much the "
            "other way under backward force: what holds the contact, or the contact, is not symmetric."
        )
    else:  # a curve that was added may say all of the declared friction
        spring = (
            "of the declared Coulomb friction nothing is left beside what was added, so that no stiffness is stated."
        )
        sides = f"Friction is not the same in both directions: {spring}"
    return {
        "presliding_length": f"Friction builds up over {1e6 * length:.1f} µm: {spring}",
        "coulomb_asymmetry": sides,
        "kinematic_error": f"The contact deflects by up to {1e6 * off:.2g} µm more or less than is read, in a wave of "
        f"{2e6 * np.pi / order:.3g} µm over the stroke: the spring that slips is not the same along the stroke, or the sensor "
        "is not straight. The record cannot tell these apart, nor from a spring that is stiffer in one direction.",
        "cyclic_friction": f"Friction varies over the stroke ({title('cyclic_friction')}, with a period near the stroke's "
        "length): the surface is not the same everywhere. Strokes of one length alone cannot part this from a spring that "
        "bends; strokes of other lengths and places would.",
    }


def evidence_chapter(found: Trace, share: float, logged: float, bandwidth: float, traced: Fit) -> Chapter:
    """What the trace added, with the evidence, and what it was searched in."""
    means = meanings(found.after.estimates)
    text = (
        f"Above {logged:g} Hz the logged force holds {100 * share:.2f} % of its rms: it begins to change before the position "
        "does and goes on after it has stopped, so it was smoothed, forwards and backwards, before it was logged. "
        f"What is missing is therefore searched below {logged:g} Hz, where a short wave over position cannot be mistaken for "
        f"what the dwells hold. Compared up to {bandwidth:g} Hz the traced model leaves {100 * traced.validation:.2f} %."
    )
    said = tuple(means[n] for n in found.added if n in means)
    return Chapter("What Coulomb friction lacks, step by step", (Paragraph(text), steps_table(found), Items(said)))


def hysteresis_chapter(models: dict[str, Fit]) -> Chapter:
    """The Maxwell-slip models beside the traced one, in the whole band."""
    _, exponential, one, bank, uneven, traced = models.values()
    active = sum(e.parameter.startswith("k") and e.value > 0 for e in bank.estimates)
    slip = next(e for e in one.estimates if e.parameter == "slip1")
    spring = next(e for e in one.estimates if e.parameter == "k1")
    text = (
        f"The loops are nearly those of one stop operator: a spring of {spring.value:.3g} N/m that slips after "
        f"{1e6 * slip.value:.1f} µm leaves {100 * one.validation:.2f} % on the validation half. A bank with "
        f"stiffnesses from the data ({active} of {len(SLIPS)} are not zero) leaves {100 * bank.validation:.2f} %: more elements "
        "bend the curve the same way in both directions, and that is not what the loops do. One element whose spring is "
        f"not the same under force of either sign leaves {100 * uneven.validation:.2f} %, with three parameters more. "
        f"The exponential virgin curve bends too early for this contact: {100 * exponential.validation:.1f} %."
    )
    table = Table(
        ("Model", "Identification error", "Validation error"),
        tuple((n, hundredths(f.identification), hundredths(f.validation)) for n, f in models.items()),
        "A constant offset is free in every model; error: rms residual over rms friction force, in the whole band.",
        "prr",
    )
    figure = Figure(
        "loops",
        lambda: loops_figure(one, traced),
        "A loop from the validation half. The branch upwards begins stiff and becomes soft, the branch downwards the other way.",
        "Friction force over position, a parallelogram with bent sides; the traced model follows the bends.",
    )
    return Chapter("Hysteresis from the data", (Paragraph(text), figure, table))


def attainable_chapter(floors, ends, days: dict[str, Fit], traced: Fit) -> Chapter:
    """How far the cycles repeat, and what the dwells say that no friction of the motion can."""
    first, second = (days[role].plant["coulomb_friction"].parameters["coulomb"].value for role in ROLES)
    slopes = " and ".join(
        f"{1e-6 * k:.2f} N/µm (correlation {r:.3f})".replace("-", "−") for k, r in map(slope, ends.values())
    )
    repeated = (
        f"Beside the traced model the force in the same state of motion differs by {100 * floors.within[IDENTIFICATION]:.2f} % of "
        f"its rms within the first half and by {100 * floors.within[VALIDATION]:.2f} % within the second; between the halves by "
        f"{100 * floors.across:.2f} %. The traced model leaves {100 * traced.validation:.2f} %; Coulomb friction, which is "
        f"{100 * abs(second / first - 1):.1f} % {'larger' if second > first else 'smaller'} in the second half than in the first, "
        "is part of it, and no law of the first half."
    )
    dwelling = (
        "From one dwell to the next, at the two ends of the stroke, force follows position by "
        f"{slopes}: where friction happens to be higher, the stage stops shorter. That is what a drive does "
        "that goes to the same place each time and gives way by so much: the force moves the position, and not the position "
        "the force; a spring of the contact would have the other sign. A wave over position of a few "
        "micrometres can be laid through these points, and lowers the error on both halves; it is not offered, because it "
        "would take an effect for its cause."
    )
    figure = Figure(
        "dwells",
        lambda: dwells_figure(ends),
        "Mean force and position of every dwell, both halves of the record, the far end of the stroke above, the near end below.",
        "Two graphs of force over position; in both the points lie along a falling line.",
    )
    return Chapter("What can be attained", (Paragraph(repeated), Paragraph(dwelling), figure))


def dwells_figure(ends) -> bytes:
    """Force over position from dwell to dwell."""

    def draw(axes):
        for a, name in zip(axes, ("far", "near"), strict=True):
            q, force = ends[name].T
            a.plot(1e6 * q, force, "o", markersize=3, color=drawing.AFTER)
            a.set_ylabel(f"force, {name} end (N)")
        axes[-1].set_xlabel("position in the dwell (µm)")

    return drawing.svg(
        "Where the stage stops, force and position fall on a line: it gives way", draw, rows=2, height=3.4
    )


def loops_figure(one: Fit, traced: Fit) -> bytes:
    """One measured loop late in the validation half, and what two models make of it."""
    measured = one.series[VALIDATION]
    part = slice(measured.keep.stop - LOOP, measured.keep.stop - LOOP // 2)
    q = 1e6 * measured.position[part]

    def draw(axes):
        (a,) = axes
        a.plot(q, measured.measured[part], color=drawing.MEASURED, linewidth=3.2, label="measured")
        a.plot(
            q, measured.predicted[part], color=drawing.BEFORE, linestyle=(0, (4, 1.5)), label="one Maxwell-slip element"
        )
        a.plot(q, traced.series[VALIDATION].predicted[part], color=drawing.AFTER, label="as traced")
        a.set_xlabel("position (µm)")
        a.set_ylabel("friction force (N)")
        a.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3)

    return drawing.svg(
        "The spring is stiffer under backward force, so the two branches are not alike", draw, height=3.0
    )

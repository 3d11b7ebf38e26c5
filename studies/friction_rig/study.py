"""The friction rig: from a declared Coulomb friction to what the measured loops ask for.

178 steps of the time axis are twice as long as the others (single dropped samples); the record is resampled at its
median step, and the report says so. Only the loaded part counts. The rig measures friction itself, so there is no inertia.
"""

from statistics import median

import numpy as np

from workbench import readers
from workbench.effect import find
from workbench.effects.hysteresis import maxwell_slip
from workbench.finding import Finding
from workbench.identify.fit import identify, passes_of
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record
from workbench.report.contents import Chapter, Paragraph, Table
from workbench.study import standard
from workbench.study.configuration import Study
from workbench.study.outcome import Outcome
from workbench.trace.tracing import trace
from workbench.units import to_si

FURTHER = ("rig",)
COLUMNS = {"time": "t_s", "normal": "normal_N", "position": "pos_um", "force": "friction_N"}
SLIPS = tuple(np.linspace(5e-6, 120e-6, 24))  # m, to the half of the largest stroke; stiffnesses come from the data


def rig(study: Study):
    """Return the table of study.toml that says how the record is read."""
    return study.table.table("rig", ("loaded_above", "split", "bandwidth", "resolution"))


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
    pair = (record(IDENTIFICATION, before, -np.inf), record(VALIDATION, np.ones(even.size, bool), split))
    finding = Finding(
        "resampled",
        source.path.name,
        f"{off.size} of {steps.size} time steps differ from {1e3 * step:.0f} ms (single dropped samples), {inside} of them "
        "while the contact is loaded; the record was resampled by linear interpolation.",
        {"steps": float(off.size), "while loaded": float(inside), "largest": float(steps.max())},
    )
    return pair, finding


def run(study: Study, say) -> Outcome:
    """Trace the declared Coulomb friction, then fit the Maxwell-slip models beside it."""
    pair, resampled = records(study)
    bandwidth = rig(study).quantity("bandwidth", "Hz", above=0.0)
    passes = passes_of(pair, bandwidth)
    offset = Plant(ONE_MASS, (find("constant_offset"),), rotary=False)
    declared = offset + find("coulomb_friction")
    found = trace(declared, passes, say, most=1)  # the form of the hysteresis is what the models below compare
    say("fitting Maxwell slip")
    models = {
        "Coulomb friction, held in the dwells": found.before,
        "Presliding hysteresis, exponential virgin curve": identify(
            offset + find("presliding_hysteresis")(x0=1e-5), passes
        ),
        "One Maxwell-slip element": identify(offset + maxwell_slip((1e-5,), searched=True), passes),
        f"A bank of {len(SLIPS)} Maxwell-slip elements": identify(offset + maxwell_slip(SLIPS), passes),
    }
    coulomb, exponential, one, bank = models.values()
    rows = [[name, fit.identification, fit.validation] for name, fit in models.items()]
    active = sum(e.parameter.startswith("k") and e.value > 0 for e in bank.estimates)
    slip = next(e for e in one.estimates if e.parameter == "slip1")
    spring = next(e for e in one.estimates if e.parameter == "k1")
    chapter = Chapter(
        "Hysteresis from the data",
        (
            Paragraph(
                f"The loops are nearly those of one stop operator: a spring of {spring.value:.3g} N/m that slips after "
                f"{1e6 * slip.value:.1f} µm leaves {100 * one.validation:.2f} % on the validation half. A bank with "
                f"stiffnesses from the data ({active} of {len(SLIPS)} are not zero) leaves {100 * bank.validation:.2f} %. "
                f"The exponential virgin curve bends too early for this contact: {100 * exponential.validation:.1f} %."
            ),
            Table(
                ("Model", "Identification error", "Validation error"),
                tuple((name, f"{100 * a:.2f} %", f"{100 * b:.2f} %") for name, a, b in rows),
                "A constant offset is free in every model; error: rms residual over rms friction force.",
                "prr",
            ),
        ),
    )
    figures = standard.trace_figures(found) | {
        "validation_error_coulomb": coulomb.validation,
        "validation_error_exponential": exponential.validation,
        "validation_error_one_element": one.validation,
        "validation_error_bank": bank.validation,
    }
    return Outcome(
        plant=declared,
        campaign="reciprocating dry contact under 5 N",
        bandwidth=bandwidth,
        trace=found,
        records=pair,
        figures=figures,
        chapters=(chapter,),
        findings=(resampled, *found.findings, *found.after.findings),
        tables={"models": [{"model": n, "identification": a, "validation": b} for n, a, b in rows]},
    )

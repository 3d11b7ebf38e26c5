"""A periodic effect whose phase does not carry over: it is fitted to each record alone, and offered as a calibration.

An incremental encoder counts from where the axis stood at power-up. What is periodic in a motor's or a gear's true angle
then has another phase in every power-up, with the same order and the same amplitude; used silently it makes a validation
record worse. Its phase is a number to be found at each power-up, by an index pulse or by a short motion.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from workbench.definition import Effect
from workbench.finding import Finding, capital, title
from workbench.identification.fit import identify, series_of
from workbench.identification.result import Estimate, Fit
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.result import Cause, Trace
from workbench.tracing.wording import not_carried

PERIODS = ("order", "turns")  # what is held: the period is the machine's
PHASE, AMPLITUDE = "phase", "amplitude"
APART = 2.0  # times both 95 % half widths together, from which two phases are two


@dataclass(frozen=True)
class Phase:
    """The first harmonic of a periodic effect, fitted to one record alone. phase: rad, with its 95 % interval."""

    record: str
    role: str
    amplitude: Estimate
    phase: Estimate

    @property
    def half(self) -> float:
        """Half of the phase's 95 % interval, rad."""
        return (self.phase.high - self.phase.low) / 2

    @property
    def shown(self) -> str:
        return f"{self.phase.value:.2f} ± {self.half:.2f} rad on {self.record}"


@dataclass(frozen=True)
class Calibration:
    """A periodic effect that does not carry over. phases: of each record alone. identified, calibrated: error on the
    validation records with the phase of identification, and with amplitude and phase found on each of them."""

    effect: str
    at: str
    phases: tuple[Phase, ...]
    identified: float
    calibrated: float

    @property
    def differs(self) -> bool:
        """Whether a validation record's phase is another one than those of the identification records."""
        known = [p for p in self.phases if p.role == IDENTIFICATION]
        return any(_apart(p, k) for p in self.phases if p.role == VALIDATION for k in known)

    @property
    def sentence(self) -> str:
        name = capital(title(self.effect))
        known = "; ".join(p.shown for p in self.phases)
        if not self.differs:
            return f"{name} does not carry over, and not for its phase: that is {known}. It is not to be used."
        return (
            f"The phase of {title(self.effect)} is {known}: it belongs to one power-up. With amplitude and phase found anew, "
            f"the validation error is {100 * self.calibrated:.2f} % instead of {100 * self.identified:.2f} %. Calibrate it at "
            "each power-up, by an index pulse or a slow motion over one period; until then it is better left out, as it is in the "
            "predictions of validation records that it would make worse."
        )


def _apart(a: Phase, b: Phase) -> bool:
    """Whether two phases differ by more than their intervals, on the circle."""
    off = (a.phase.value - b.phase.value + pi) % (2 * pi) - pi
    return abs(off) > APART * float(np.hypot(a.half, b.half))


def periodic(effect: Effect) -> bool:
    """Whether an effect is a wave with a phase of its own."""
    return PHASE in effect.outside and any(n in effect.parameters for n in PERIODS)


def _alone(plant: Plant, key: str) -> Plant:
    """Return the plant with every value held but the amplitudes and phases of one effect."""
    held = replace(plant, effects=tuple(e(fixed=True, **_values(e)) for e in plant.effects))
    effect = held[key]
    return held.swap(effect.free(*(n for n in effect.parameters if n not in PERIODS)))


def _values(effect: Effect) -> dict[str, float]:
    return {n: p.value for n, p in effect.parameters.items()}


def calibrate(plant: Plant, key: str, passes: Sequence[InverseDynamics], identified: float) -> Calibration:
    """Return the phases of one periodic effect of an identified plant, record by record.

    identified: error on the validation records with the plant as it is.
    """
    effect, model = plant[key], _alone(plant, key)
    phases, left, whole = [], 0.0, 0.0
    for p in sorted(passes, key=lambda p: p.motion.record.name):
        record = p.motion.record
        fit = identify(model, [InverseDynamics(replace(p.motion, record=replace(record, role=IDENTIFICATION)))])
        amplitude, phase = (_estimate(fit, effect, n) for n in (AMPLITUDE, PHASE))
        phases.append(Phase(record.name, record.role, amplitude, phase))
        if record.role == VALIDATION:
            series = fit.series[record.name]
            left += float(np.sum(series.residual[series.keep] ** 2))
            whole += float(np.sum(series.measured[series.keep] ** 2))
    calibrated = float(np.sqrt(left / whole)) if whole > 0.0 else float("nan")
    return Calibration(effect.named, effect.at, tuple(phases), identified, calibrated)


def _estimate(fit: Fit, effect: Effect, name: str) -> Estimate:
    return next(e for e in fit.estimates if (e.effect, e.at, e.parameter) == (effect.named, effect.at, name))


def calibrations(passes: Sequence[InverseDynamics], found: Trace) -> tuple[Calibration, ...]:
    """Return a calibration for every periodic cause of a trace that explains little of the validation records."""
    plant = found.after.plant
    identified = _validation_error(plant, passes)
    return tuple(calibrate(plant, c.key, passes, identified) for c in _lost(found) if periodic(plant[c.key]))


def _validation_error(plant: Plant, passes: Sequence[InverseDynamics]) -> float:
    """Return the error of a plant on the validation records, nrmse."""
    left = whole = 0.0
    for p in passes:
        if p.motion.record.role == VALIDATION:
            series, _ = series_of(plant, p)
            left += float(np.sum(series.residual[series.keep] ** 2))
            whole += float(np.sum(series.measured[series.keep] ** 2))
    return float(np.sqrt(left / whole)) if whole > 0.0 else float("nan")


def withheld(fit: Fit, causes: Sequence[Cause], passes: Sequence[InverseDynamics]) -> Fit:
    """Return a fit whose validation records are predicted by a fit without the periodic causes that make them worse.

    Their phase is that of another power-up, and a ripple of a wrong phase is worse than none. The plant keeps them.
    """
    plant = fit.plant
    for key in (c.key for c in causes if c.share_validation < 0.0):
        if periodic(fit.plant[key]):
            plant = plant.without(key)
    if plant is fit.plant:
        return fit
    other = identify(plant, passes)
    unseen = {p.motion.record.name for p in passes if p.motion.record.role == VALIDATION}

    def mixed(ours: Mapping, theirs: Mapping) -> dict:
        return {name: theirs[name] if name in unseen else x for name, x in ours.items()}

    return replace(
        fit, series=mixed(fit.series, other.series), predictions=mixed(fit.predictions, other.predictions),
        nrmse=mixed(fit.nrmse, other.nrmse), rms={**fit.rms, VALIDATION: other.rms[VALIDATION]}, validation=other.validation,
    )  # fmt: skip


def _lost(found: Trace) -> list[Cause]:
    """Return the causes that do not carry over to the validation records."""
    return [c for c in found.causes if any(not_carried([c], found.criteria))]


def finding(c: Calibration) -> Finding:
    """Return a calibration as a finding."""
    evidence = {f"phase on {p.record}": p.phase.value for p in c.phases}
    evidence |= {"validation error as identified": c.identified, "validation error calibrated": c.calibrated}
    remedy = "give the axis an absolute encoder or an index pulse, and count from it" if c.differs else ""
    return Finding("calibration", f"{c.effect}@{c.at}", c.sentence, evidence, remedy)


def as_dict(c: Calibration) -> dict:
    """Return a calibration as trace.json holds it."""
    phases = [
        {
            "record": p.record,
            "role": p.role,
            "amplitude": {"value": p.amplitude.value, "unit": p.amplitude.unit},
            "phase": {"value": p.phase.value, "unit": "rad", "interval_95": [p.phase.low, p.phase.high]},
        }
        for p in c.phases
    ]
    nrmse = {"identified": c.identified, "calibrated": c.calibrated}
    return {
        "effect": c.effect,
        "at": c.at,
        "differs": c.differs,
        "phases": phases,
        "nrmse": nrmse,
        "sentence": c.sentence,
    }

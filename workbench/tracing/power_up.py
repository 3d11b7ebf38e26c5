"""What a power-up changes: a periodic effect is fitted to each record alone, and left out where its phase makes a record worse."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from workbench.definition import Effect
from workbench.identification.fit import identify, series_of
from workbench.identification.result import Estimate, Fit
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.calibration import Calibration, Phase
from workbench.tracing.criteria import Criteria
from workbench.tracing.result import Cause
from workbench.tracing.wording import not_carried

PERIODS = ("order", "turns")  # what is held: the period is the machine's
PHASE, AMPLITUDE = "phase", "amplitude"


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


def calibrate(plant: Plant, key: str, inverses: Sequence[InverseDynamics], identified: float) -> Calibration:
    """Return the phases of one periodic effect of an identified plant, record by record.

    identified: error on the validation records with the plant as it is.
    """
    effect, model = plant[key], _alone(plant, key)
    phases, left, whole = [], 0.0, 0.0
    for p in sorted(inverses, key=lambda p: p.motion.record.name):
        record = p.motion.record
        fit = identify(
            model, [InverseDynamics(replace(p.motion, record=replace(record, role=IDENTIFICATION)), times=p.times)]
        )
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


def calibrations(
    plant: Plant, causes: Sequence[Cause], inverses: Sequence[InverseDynamics], criteria: Criteria
) -> tuple[Calibration, ...]:
    """Return a calibration for every periodic cause of the extended plant that explains little of the validation records."""
    lost = [c.key for c in causes if any(not_carried([c], criteria)) and periodic(plant[c.key])]
    identified = _validation_error(plant, inverses) if lost else 0.0
    return tuple(calibrate(plant, key, inverses, identified) for key in lost)


def _validation_error(plant: Plant, inverses: Sequence[InverseDynamics]) -> float:
    """Return the error of a plant on the validation records, nrmse."""
    left = whole = 0.0
    for p in inverses:
        if p.motion.record.role == VALIDATION:
            series, _ = series_of(plant, p)
            left += float(np.sum(series.residual[series.keep] ** 2))
            whole += float(np.sum(series.measured[series.keep] ** 2))
    return float(np.sqrt(left / whole)) if whole > 0.0 else float("nan")


def withheld(fit: Fit, causes: Sequence[Cause], inverses: Sequence[InverseDynamics]) -> Fit:
    """Return a fit whose validation records are predicted by a fit without the periodic causes that make them worse.

    Their phase is that of another power-up, and a ripple of a wrong phase is worse than none. The plant keeps them.
    """
    plant = fit.plant
    for key in (c.key for c in causes if c.share_validation < 0.0):
        if periodic(fit.plant[key]):
            plant = plant.without(key)
    if plant is fit.plant:
        return fit
    other = identify(plant, inverses)
    unseen = {p.motion.record.name for p in inverses if p.motion.record.role == VALIDATION}

    def mixed(ours: Mapping, theirs: Mapping) -> dict:
        return {name: theirs[name] if name in unseen else x for name, x in ours.items()}

    return replace(
        fit, series=mixed(fit.series, other.series), predictions=mixed(fit.predictions, other.predictions),
        nrmse=mixed(fit.nrmse, other.nrmse), rms={**fit.rms, VALIDATION: other.rms[VALIDATION]}, validation=other.validation,
    )  # fmt: skip

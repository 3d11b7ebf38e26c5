"""The time-optimal bound: full torque, full speed, full braking with the help of friction, at rest on the target."""

from dataclasses import replace

import numpy as np

from workbench.description.friction import friction_of
from workbench.inverse.forces import force_along
from workbench.plant import ONE_MASS, Plant

POINTS = 400  # of speed
SLIDING = 400  # samples over which friction with memory comes to sliding


def sliding_torque(plant: Plant, speeds: np.ndarray, counts: float) -> np.ndarray:
    """Return the torque or force of all friction when sliding forward at each speed (n,), N*m or N."""
    rest, _, viscous = friction_of(plant)
    reach = max((10.0 * e.parameters["x0"].value for e in rest.effects if "x0" in e.parameters), default=100 * counts)
    result = np.empty(speeds.size)
    ones = np.ones(SLIDING)
    for i, v in enumerate(speeds):
        forces = force_along(rest, 1e-3, counts, q=0 * ones, dq=reach / SLIDING * ones, v=v * ones, a=0 * ones)
        result[i] = forces[-1] + viscous * v
    return result


def _bodies(plant: Plant) -> tuple[Plant, ...]:
    """Return the plant, or each body of two masses as one with its own forces: a rigid axis is their sum."""
    if plant.kind == ONE_MASS:
        return (plant,)
    return tuple(
        replace(plant, kind=ONE_MASS, effects=tuple(e(at="axis") for e in plant.effects if e.at == place))
        for place in ("motor", "load")
    )


def time_optimal(
    plant: Plant, step: float, *, load_inertia: float = 0.0, counts: float = 1e-6, band: float = 0.01, speeds=None
) -> float:
    """Return the least time in s in which a step (rad or m, from rest) can enter the band about the target to stay there.

    Bang-bang with the plant's torque and speed limits, sliding friction helping the brake, and the axis at rest exactly
    on the target; the time counts to the edge of the band. Forces that depend on position are left out. Two masses count as
    rigidly joined.
    """
    parts = _bodies(plant)
    mass, step = sum(friction_of(p)[1] for p in parts) + load_inertia, abs(step)
    drive, fastest = plant.limits.drive, plant.limits.speed
    v = np.linspace(0.0, 1.0, POINTS) * min(fastest, np.sqrt(2 * drive * step / mass))
    coarse = np.linspace(0.0, v[-1], 24)
    friction = np.interp(v, coarse, sum(sliding_torque(p, coarse, counts) for p in parts))
    speeding, braking = (drive - friction) / mass, (drive + friction) / mass
    if np.any(speeding <= 0.0):
        v = v[: np.argmax(speeding <= 0.0)]
        speeding, braking = speeding[: v.size], braking[: v.size]
    from scipy.integrate import cumulative_trapezoid  # an eighth of the time that the package takes to load

    # from rest to each speed: the distance is the integral of v/a dv, the time that of 1/a dv
    run_up, run_down, time_up, time_down = (
        cumulative_trapezoid(y, v, initial=0.0) for y in (v / speeding, v / braking, 1.0 / speeding, 1.0 / braking)
    )
    total = run_up + run_down
    if total[-1] >= step:  # the speed limit is not reached: switch where both branches meet
        top = float(np.interp(step, total, v))
        rise, fall = float(np.interp(top, v, time_up)), float(np.interp(top, v, time_down))
    else:
        top = v[-1]
        rise, fall = time_up[-1] + (step - total[-1]) / top, time_down[-1]
    # the last stretch, inside the band, does not count
    crossing = float(np.interp(band * step, run_down, v))
    return rise + fall - float(np.interp(crossing, v, time_down))

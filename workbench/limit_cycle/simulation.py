"""Limit cycles confirmed or refuted: the simulated loop from several starts, and what of its motion does not die out."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from workbench.control import Controller, Table
from workbench.limit_cycle.axis import COUNTS
from workbench.plant import Plant
from workbench.simulation import Loop, ScenarioArrays, simulate

SUBSTEPS = 32  # a sample, at least
KEEPS = 0.9  # share of its amplitude that a motion keeps from the third quarter of the time to the fourth
PERIODS = 3.0  # in the fourth quarter: what is slower is a drift that has not ended
PIECE = 6  # periods
SLOW, LONGER = 0.01, 4  # an amplitude that moves by more than 1 % is looked at for longer


@dataclass(frozen=True, eq=False)
class Motion:
    """Of each lane (n,): whether it goes on, and its amplitude, frequency (rad/s) and third harmonic over the first.

    drift: logarithm of its amplitude in the last quarter of the time over that in the third.
    """

    lasts: np.ndarray
    drift: np.ndarray
    amplitude: np.ndarray
    omega: np.ndarray
    third: np.ndarray


def _refined_loop(loop: Loop) -> Loop:
    """Return the loop as it is simulated: with fine substeps."""
    return replace(loop, substeps=max(SUBSTEPS, loop.substeps))


def as_simulated(loop: Loop) -> Loop:
    """Return the loop whose exact motion the simulation has to second order: semi-implicit Euler leads by half a substep.

    Near the edge of stability even a microsecond decides, and both sides are to speak of one loop.
    """
    fine = _refined_loop(loop)
    return replace(fine, delay=max(fine.delay - fine.substep / 2.0, 0.0))


def _stacked(controllers: Sequence[Controller]) -> Controller:
    """Return controllers of one law as one, a lane each."""
    first = controllers[0]
    parameters = {n: np.array([float(np.ravel(c.parameters[n])[0]) for c in controllers]) for n in first.parameters}
    if not first.tables:
        return replace(first, parameters=parameters)
    tables: tuple[Table, ...] = tuple(c.tables[0] for c in controllers)
    return replace(first, parameters=parameters, tables=tables, table=np.arange(len(controllers)))


def simulated(
    plant: Plant, loop: Loop, controllers: Sequence[Controller], starts: np.ndarray, duration: float,
    *, inertia: float = 1.0, friction: float = 1.0,
) -> Motion:  # fmt: skip
    """Return what is left of the motion after a release at `starts` (n,) from rest, one controller a lane, target zero.

    Where the amplitude still moves after `duration` (s), or there is a motion that cannot yet be said to last because too few
    of its periods were seen, the lane is run again, LONGER times as long.
    """
    motion = _released(plant, loop, controllers, starts, duration, inertia, friction)
    moves = motion.lasts & (np.abs(motion.drift) > SLOW)
    slow = np.flatnonzero(moves | (~motion.lasts & (motion.amplitude > COUNTS * loop.count)))
    if not slow.size:
        return motion
    longer = _released(
        plant, loop, [controllers[k] for k in slow], starts[slow], LONGER * duration, inertia, friction
    )  # fmt: skip
    out = {f.name: getattr(motion, f.name).copy() for f in fields(Motion)}
    for name, values in out.items():
        values[slow] = getattr(longer, name)
    return Motion(**out)


def _released(plant, loop: Loop, controllers, starts, duration: float, inertia: float, friction: float) -> Motion:
    scenarios = ScenarioArrays(starts.size, start=starts, phase=0.5, inertia=inertia, friction=friction)
    m = simulate(plant, _refined_loop(loop), _stacked(controllers), scenarios, duration, ("q",))
    q = m.trajectories["q"]
    with np.errstate(all="ignore"):
        found = [_lane(q[:, k], len(q), loop) for k in range(starts.size)]
    return Motion(*(np.array(x) for x in zip(*found, strict=True)))


def _lane(q: np.ndarray, n: int, loop: Loop) -> tuple[bool, float, float, float, float]:
    if not np.isfinite(q).all():
        return True, np.inf, np.inf, np.nan, np.nan
    before, _, _ = harmonics(q[n // 2 : 3 * n // 4], loop.sample_time)
    amplitude, omega, third = harmonics(q[3 * n // 4 :], loop.sample_time)
    periods = omega * (n - 3 * n // 4) * loop.sample_time / (2.0 * np.pi)
    lasts = amplitude > COUNTS * loop.count and amplitude > KEEPS * before and periods > PERIODS
    drift = np.log(amplitude / before) if lasts and before > 0.0 else -np.inf
    return bool(lasts), float(drift), amplitude, omega, third


def harmonics(q: np.ndarray, dt: float) -> tuple[float, float, float]:
    """Return (amplitude, w in rad/s, third harmonic over the first) of an oscillation q (n,); zeros where there is none.

    The frequency is that of passages upward through the mean, or of its turns where these give the larger motion: beneath a fast
    cycle the mean may wander by as much, and passages are missed. Harmonics are means over pieces of a few periods, since a cycle that
    the encoder disturbs does not keep its phase.
    """
    x = q - (q.max() + q.min()) / 2.0
    return max(_harmonics(x, _frequency(seen, dt), dt) for seen in (x, np.diff(q)))


def _frequency(x: np.ndarray, dt: float) -> float:
    """Return the frequency, rad/s, of passages of x (n,) upward through zero; 0 where there are none."""
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    if up.size < 2:
        return 0.0
    passage = up + x[up] / (x[up] - x[up + 1])
    return float(2.0 * np.pi * (up.size - 1) / (passage[-1] - passage[0]) / dt)


def _harmonics(x: np.ndarray, omega: float, dt: float) -> tuple[float, float, float]:
    """Return what `harmonics` does, of x (n,) at a frequency omega."""
    if omega == 0.0:
        return 0.0, 0.0, 0.0
    length = min(int(round(PIECE * 2.0 * np.pi / (omega * dt))), x.size)
    pieces = x[: x.size // length * length].reshape(-1, length)
    first, third = (np.abs(pieces @ np.exp(-1j * h * omega * dt * np.arange(length))).mean() for h in (1, 3))
    return float(2.0 * first / length), float(omega), float(third / first) if first > 0.0 else 0.0

"""Whether what tuning promises at each amplitude is what the axis does: the same gains on the plant that they meet, encoder and all."""

from dataclasses import dataclass, replace

import numpy as np

from workbench.control import fixed_pd
from workbench.design.polish import LASTS, REST, Polished, Stepped
from workbench.keeping import kept
from workbench.plant import Plant
from workbench.simulation import ScenarioArrays, simulate
from workbench.task.stepping import figures_of
from workbench.task.task import Task

PHASES = (0.2, 0.5, 0.8)  # of the encoder within a count


@dataclass(frozen=True, eq=False)
class Promise:
    """amplitude, promised, simulated (n,): 1 % times about the own final value, s; simulated: the one of all encoder phases that
    is farthest from what was promised. read (n,): whether the encoder's counts were in the loop."""

    amplitude: np.ndarray
    promised: np.ndarray
    simulated: np.ndarray
    read: np.ndarray

    @property
    def deviation(self) -> float:
        """Largest |simulated - promised|, s."""
        return float(np.max(np.abs(self.simulated - self.promised)))


@kept
def promise(plant: Plant, polished: Polished, task: Task) -> Promise:
    """Run the gains that were optimised for the nominal plant on `plant`, through the encoder wherever half a count, by which
    a reading may be off, is less than what the overshoot leaves of the band: else counts alone take the response out of it."""
    gains, count = polished.nominal, task.loop.count
    left = task.criteria.band - min(task.weights.overshoot, task.criteria.band)
    read = left * gains.amplitude >= count / 2.0
    duration = LASTS * float(polished.linear.time.max()) + REST
    simulated = np.full(gains.kp.size, np.nan)
    for rows, resolution in ((read, count), (~read, 0.0)):
        if rows.any():
            simulated[rows] = _farthest(plant, gains, rows, replace(task.loop, resolution=resolution), duration, task)
    return Promise(gains.amplitude, gains.nominal.time, simulated, read)


def _farthest(plant: Plant, gains: Stepped, rows: np.ndarray, loop, duration: float, task: Task) -> np.ndarray:
    """Return the 1 % times of some amplitudes, of the encoder phase that is farthest from what was promised."""
    every = np.tile(np.flatnonzero(rows), len(PHASES))
    target = gains.amplitude[every]
    scenarios = ScenarioArrays(target.size, target=target, phase=np.repeat(PHASES, int(rows.sum())))
    q = simulate(plant, loop, fixed_pd(gains.kp[every], gains.kd[every]), scenarios, duration, ("q",)).trajectories["q"]
    time = figures_of(q, 0.0 * target, target, loop.sample_time, task.criteria.band).time.reshape(len(PHASES), -1)
    off = np.abs(time - gains.nominal.time[rows])
    return np.take_along_axis(time, off.argmax(axis=0)[None, :], axis=0)[0]

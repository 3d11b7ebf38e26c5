"""The region of gains that hunt: predicted and simulated on a grid of two gains, and held against each other."""

from dataclasses import dataclass

import numpy as np

from workbench.control import Controller
from workbench.keeping import kept
from workbench.limit_cycle.axis import COUNTS, axis_of
from workbench.limit_cycle.describing import Dials, command, dials, turned
from workbench.limit_cycle.further import Cycle
from workbench.limit_cycle.harmonic_balance import balance
from workbench.limit_cycle.simulation import as_simulated, simulated
from workbench.plant import Plant
from workbench.processes import shared
from workbench.simulation import Loop, loop_under
from workbench.threads import one_thread

THIRD = 0.05  # largest third harmonic at which one harmonic says enough
SMALL = 50.0  # encoder counts of a start where no cycle is predicted
# Of COUNTS encoder counts, up to which a predicted cycle is not looked for in simulation: beneath them no motion there is called
# one, and amplitudes agree to 5 %. Halved or doubled, cases at the edge of stability change sides.
FAINT = 1.1
APART = 1.0 / 3.0  # of a predicted amplitude: another start, and its inverse


@dataclass(frozen=True, eq=False)
class Region:
    """first, second (n,), (m,): factors on the two gains that `dials` names. cycles: (i, j) -> the predicted ones.

    exists, amplitude, omega, third (n, m): simulated; of all starts that on a predicted cycle where its motion lasts, since a
    motion may lock to the sampling in several ways; else that which is steadiest. controller: what the factors are on.
    inertia, friction: of the axis, factors. speed: its limit. least: amplitude from which a predicted cycle can be seen.
    """

    dials: Dials
    first: np.ndarray
    second: np.ndarray
    cycles: dict[tuple[int, int], tuple[Cycle, ...]]
    exists: np.ndarray
    amplitude: np.ndarray
    omega: np.ndarray
    third: np.ndarray
    controller: Controller
    inertia: float
    friction: float
    speed: float
    least: float = 0.0

    @property
    def predicted(self) -> np.ndarray:
        """Whether a stable limit cycle is predicted, (n, m)."""
        found = np.zeros(self.exists.shape, dtype=bool)
        for at, cycles in self.cycles.items():
            found[at] = any(c.stable for c in cycles)
        return found

    @property
    def judged(self) -> np.ndarray:
        """Cases that count, (n, m): the third harmonic is at most 5 %, of the simulated cycle, and where none is simulated, of
        those that are predicted; and these are not so small that the encoder shapes them."""
        foretold, faint = np.zeros(self.exists.shape), np.zeros(self.exists.shape, dtype=bool)
        for at, cycles in self.cycles.items():
            stable = [c for c in cycles if c.stable]
            foretold[at] = min((c.third for c in stable), default=0.0)
            faint[at] = bool(stable) and max(c.amplitude for c in stable) < self.least
        return (np.where(self.exists, self.third, foretold) <= THIRD) & (self.exists | ~faint)

    @property
    def right(self) -> np.ndarray:
        """Whether prediction and simulation agree that there is a limit cycle, or none, (n, m)."""
        return self.predicted == self.exists

    def nearest(self, at: tuple[int, int]) -> Cycle | None:
        """Return the stable cycle that is predicted nearest in amplitude to the simulated one, or None."""
        stable = [c for c in self.cycles[at] if c.stable]
        if not stable or not self.exists[at]:
            return None
        return min(stable, key=lambda c: abs(np.log(c.amplitude / self.amplitude[at])))

    @property
    def limited(self) -> np.ndarray:
        """Whether the predicted motion would be faster than the axis can be, (n, m): its frequency is not predicted."""
        near = {at: self.nearest(at) for at in self.cycles}
        out = np.zeros(self.exists.shape, dtype=bool)
        for at, c in near.items():
            out[at] = c is not None and c.speed > self.speed
        return out

    @property
    def frequency_error(self) -> np.ndarray:
        """Relative, predicted to simulated, (n, m), of cases that count and are not limited in speed; else NaN."""
        out = np.full(self.exists.shape, np.nan)
        counts = self.judged & ~self.limited
        for at in self.cycles:
            near = self.nearest(at)
            if near is not None and counts[at]:
                out[at] = near.omega / self.omega[at] - 1.0
        return out

    @property
    def figures(self) -> dict[str, float]:
        """How often prediction and simulation agree, and how well the frequency is met; cases with a third harmonic of at
        most 5 % and above ten encoder counts, frequencies of those that the axis' speed does not limit."""
        error = np.abs(self.frequency_error)
        return {
            "limit_cycle_wrong": float(np.sum(self.judged & ~self.right)),
            "limit_cycle_cases": float(np.sum(self.judged)),
            "limit_cycle_frequency_error": float(np.nanmax(error)) if np.isfinite(error).any() else 0.0,
        }

    @property
    def as_tuned(self) -> tuple[int, int]:
        """Where in the region the gains are nearest to those that the controller has."""
        return tuple(int(np.argmin(np.abs(np.log(x)))) for x in (self.first, self.second))

    @property
    def as_dict(self) -> dict[str, object]:
        """The region as results.json holds it."""
        rows, columns = range(self.first.size), range(self.second.size)
        return {
            "gains": [self.dials.first, self.dials.second],
            "first": self.first,
            "second": self.second,
            "inertia": self.inertia,
            "friction": self.friction,
            "predicted": [[[vars(c) for c in self.cycles[i, j]] for j in columns] for i in rows],
            "exists": self.exists,
            "amplitude": self.amplitude,
            "omega": self.omega,
            "third": self.third,
        }


@one_thread
@kept
def region(
    plant: Plant, loop: Loop, controller: Controller, first: np.ndarray, second: np.ndarray, largest: float, duration: float,
    *, inertia: float = 1.0, friction: float = 1.0,
) -> Region:  # fmt: skip
    """Return the region of factors first (n,) by second (m,) on a controller's two gains, around rest at a target.

    largest: amplitude up to which cycles are sought, rad or m. duration: of the simulation, s. Every case is released from
    rest at a third of the predicted amplitude, at it and at three times it; where no cycle is predicted, at 50 encoder counts
    and at `largest`/50. Raises WorkbenchError for a law or a plant whose cycles are not predicted.
    """
    of, loop = dials(controller), loop_under(controller, loop)
    solved = balance(axis_of(plant, as_simulated(loop), largest, inertia=inertia, friction=friction), largest)
    limit = plant.limits.drive
    laws = {(i, j): turned(controller, a, b) for i, a in enumerate(first) for j, b in enumerate(second)}
    found = shared(lambda c: solved.cycles(command(c, limit, loop)), [*laws.values()])
    cycles = dict(zip(laws, found, strict=True))
    lanes = [(at, start) for at in laws for start in _starts(cycles[at], loop, largest)]
    m = simulated(
        plant, loop, [laws[at] for at, _ in lanes], np.array([s for _, s in lanes]), duration,
        inertia=inertia, friction=friction,
    )  # fmt: skip
    shape = (len(first), len(second))
    out = {n: np.full(shape, np.nan) for n in ("amplitude", "omega", "third")}
    exists = np.zeros(shape, dtype=bool)
    own = np.array([start in {c.amplitude for c in cycles[at]} for at, start in lanes])
    for k in np.lexsort((-np.abs(m.drift), own)):  # what was released on a predicted cycle last, so that it stays
        at = lanes[k][0]
        if m.lasts[k]:
            exists[at] = True
            out["amplitude"][at], out["omega"][at], out["third"][at] = m.amplitude[k], m.omega[k], m.third[k]
    return Region(of, first, second, cycles, exists, **out, controller=controller, inertia=inertia,
                  friction=friction, speed=plant.limits.speed, least=FAINT * COUNTS * loop.count)  # fmt: skip


def _starts(cycles: tuple[Cycle, ...], loop: Loop, largest: float) -> tuple[float, ...]:
    """Return where the simulation is released from, for the cycles that are predicted."""
    stable = [c.amplitude for c in cycles if c.stable]
    if not stable:
        return SMALL * (loop.count or largest / 1e6), largest / SMALL
    return APART * stable[0], stable[-1], stable[-1] / APART

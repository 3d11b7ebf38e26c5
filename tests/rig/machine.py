"""A machine is the facts of an axis and the laws on it; it is run along motions, and its balance says what is not explained."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rig import kernel
from rig.kernel import JOINT, LAWS, LOAD, MOVER, PER_CONTROL, RATE, ROW, WIDTH, Axis
from rig.motions import Motion
from rig.signals import decimated, low_pass

PLACE = {"axis": MOVER, "motor": MOVER, "load": LOAD, "joint": JOINT}
ENDS = 0.1  # s, at both ends of a record, in which nothing is compared
Target = str | tuple[str, int]


@dataclass(frozen=True)
class Law:
    at: str
    p: tuple[float, ...]


@dataclass(frozen=True)
class Machine:
    """axis: its facts. laws: name of a law -> where it acts, and its parameters."""

    axis: Axis
    laws: dict[str, Law]

    @property
    def two(self) -> bool:
        return self.axis.load_inertia > 0.0

    def get(self, target: Target) -> float:
        """A field of the axis, or a parameter (law, index)."""
        return getattr(self.axis, target) if isinstance(target, str) else self.laws[target[0]].p[target[1]]

    def put(self, target: Target, value: float) -> "Machine":
        if isinstance(target, str):
            return replace(self, axis=self.axis._replace(**{target: value}))
        name, index = target
        p = list(self.laws[name].p)
        p[index] = value
        return self.adding(name, self.laws[name].at, tuple(p))

    def adding(self, law: str, at: str, p: tuple[float, ...]) -> "Machine":
        return replace(self, laws={**self.laws, law: Law(at, p)})

    def tables(self) -> tuple[np.ndarray, np.ndarray]:
        """Return parameters (laws, WIDTH) and places (laws,) for the kernel."""
        p, places = np.zeros((len(LAWS), WIDTH)), np.full(len(LAWS), -1)
        for name, law in self.laws.items():
            if law.p[0] != 0.0:
                p[ROW[name], : len(law.p)], places[ROW[name]] = law.p, PLACE[law.at]
        return p, places


@dataclass(frozen=True, eq=False)
class Run:
    """One record at the log rate, before noise: bench time t, command u, positions as read (load's: ql), not yet counted."""

    start: float
    rate: int
    u: np.ndarray
    q: np.ndarray
    ql: np.ndarray
    locked: bool = False

    @property
    def t(self) -> np.ndarray:
        return self.start + np.arange(self.q.size) / self.rate

    def counted(self, count: float, load_count: float) -> "Run":
        """The same with positions in whole counts."""
        return replace(self, q=whole(self.q, count), ql=whole(self.ql, load_count))


def whole(x: np.ndarray, count: float) -> np.ndarray:
    return count * np.floor(x / count + 0.5) if count > 0.0 else x


def run(machine: Machine, start: float, motion: Motion, rate: int = 1000) -> Run:
    """Run a machine from rest; the log begins at `start` on the bench clock."""
    per_sample = RATE // rate
    logs = np.zeros((3, motion.reference.size * PER_CONTROL))
    kernel.simulate(
        machine.axis, *machine.tables(), start, motion.reference, motion.speed, motion.injected, motion.closed,
        motion.locked, *logs,
    )  # fmt: skip
    q, ql, u = logs
    skewed = [q, ql]
    if machine.axis.late or machine.axis.skew:  # of the load's encoder, where there is one
        t = start + np.arange(q.size) / RATE
        k = 1 if machine.two else 0
        skewed[k] = np.interp(t - machine.axis.late - machine.axis.skew * t, t, skewed[k])
    q, ql = (x[::per_sample].copy() for x in skewed)
    return Run(start, rate, decimated(u, per_sample), q, ql, motion.locked)


# --- balance ----------------------------------------------------------------------------------------------------------


def dead(x: np.ndarray, count: float) -> np.ndarray:
    """A position behind a dead band of one count, so that an encoder that flickers does not rub."""
    return _dead(x, count)


@kernel.numba.njit(cache=True)
def _dead(x, count):
    out = np.empty(x.size)
    at = x[0]
    for n in range(x.size):
        at = min(max(at, x[n] - count), x[n] + count)
        out[n] = at
    return out


def unexplained(machine: Machine, r: Run, band: float, count: float = 0.0, load_count: float = 0.0) -> np.ndarray:
    """Return what the machine's balances leave of a record below the band (n,) or, on two masses, motor's then load's (2n,).

    The machine's laws must have no states, and its drive be ideal: it is what somebody declared. count: width of the dead
    band in front of what rubs.
    """
    a, two = machine.axis, machine.two
    p, places = machine.tables()

    def moved(x):
        return [low_pass(x, r.rate, 2 * band, k) for k in range(3)]

    def resisting(place, x, v, rubbed, rate):
        d = kernel.masing(rubbed - rubbed[0], rate) if rate > 0.0 else np.zeros(x.size)
        return d, kernel.along(p, places, place, x, v, d, r.t, r.u)

    q, v, acc = moved(r.q)
    rubbed = dead(r.q, count)
    d, laws = resisting(MOVER, q, v, rubbed, a.rate)
    motor = r.u - a.inertia * acc - a.viscous * v - a.h0 * d - laws
    keep = slice(round(ENDS * r.rate), -round(ENDS * r.rate))
    if not two:
        return low_pass(motor, r.rate, band)[keep]
    ql, vl, accl = moved(r.ql)
    x, xv = q - ql, v - vl
    dj, laws = resisting(JOINT, x, xv, dead(r.q - r.ql, count + load_count), a.rate2)
    pull = a.k2 * x + a.c2 * xv + a.h2 * dj + laws
    motor = low_pass(motor - pull, r.rate, band)[keep]
    if r.locked:
        return motor
    _, laws = resisting(LOAD, ql, vl, dead(r.ql, load_count), 0.0)
    load = pull - a.load_inertia * accl - a.load_viscous * vl - laws
    return np.concatenate([motor, low_pass(load, r.rate, band)[keep]])


def stacked(machine: Machine, made: Sequence[Run], band: float, *counts: float) -> np.ndarray:
    return np.concatenate([unexplained(machine, r, band, *counts) for r in made])


def columns(machine: Machine, free: Sequence[Target], made: Sequence[Run], band: float) -> np.ndarray:
    """How the residual changes with each free parameter: what a fit of them takes out, to first order."""
    here = stacked(machine, made, band)
    return np.stack([stacked(machine.put(t, 1.01 * machine.get(t)), made, band) - here for t in free], axis=1)


def beyond(a: np.ndarray, y: np.ndarray) -> np.ndarray:
    """y less its projection on the columns of a (n, k)."""
    scaled = a / np.maximum(np.linalg.norm(a, axis=0), 1e-300)
    return y - scaled @ np.linalg.lstsq(scaled, y, rcond=1e-9)[0]

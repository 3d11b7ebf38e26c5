"""What an axis may do while it is measured, and how well its log sees it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite

import numpy as np

from workbench.errors import WorkbenchError
from workbench.inverse.balances import balances
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import LowPass
from workbench.plant import ONE_MASS, Plant

USED = 0.8  # of the drive's limit: the rest is left to the feedback


@dataclass(frozen=True)
class Envelope:
    """low, high: position, rad or m. speed, acceleration: largest, SI. drive: largest that a plan may ask for, N*m or N."""

    low: float
    high: float
    speed: float
    acceleration: float
    drive: float

    def __post_init__(self):
        if not self.low < self.high:
            raise WorkbenchError(f"the lowest position {self.low:g} is not below the highest {self.high:g}.")
        for name in ("speed", "acceleration", "drive"):
            value = getattr(self, name)
            if not (isfinite(value) and value > 0.0):
                raise WorkbenchError(f"the limit of {name} is {value:g}; a plan needs a finite one above 0.")

    @property
    def span(self) -> float:
        return self.high - self.low

    @property
    def centre(self) -> float:
        return 0.5 * (self.low + self.high)


@dataclass(frozen=True)
class Sensing:
    """drive: standard deviation of one sample of the drive's noise, white, N*m or N. counts: encoder step, rad or m.

    dt: s, at which the axis is logged. bandwidth: Hz, below which errors count. load: as drive, of what is left of the load's
    balance where there are two masses; there both are as the records show them, with what counts do through the joint.
    """

    drive: float
    counts: float
    dt: float
    bandwidth: float
    load: float = 0.0

    def scatter(self, columns: np.ndarray, plant: Plant) -> np.ndarray:
        """Return C' S C (p, p) of filtered columns C, S the covariance of the noise behind the evaluation filter F.

        C is (n, p) or, of two masses, (2 n, p) with both balances of a sample side by side. Drive noise is white with `drive`
        before F; on one mass encoder counts are white with counts/sqrt(12) before mass d2/dt2 F.
        """
        rows = 1 if plant.kind == ONE_MASS else 2
        smooth = LowPass(self.bandwidth, 1 / self.dt, len(columns) // rows)
        if rows == 2:
            motor, load = smooth(columns[0::2].T), smooth(columns[1::2].T)
            return self.drive**2 * (motor @ motor.T) + (self.load or self.drive) ** 2 * (load @ load.T)
        seen, curved = smooth.derivatives(columns.T, 3)[::2]
        return self.drive**2 * (seen @ seen.T) + (_mass_of(plant) * self.counts) ** 2 / 12.0 * (curved @ curved.T)


def _mass_of(plant: Plant) -> float:
    """Return the declared inertia of all bodies, kg*m^2 or kg; 0 where none is declared."""
    return sum(e.parameters["inertia"].value for e in plant.effects if e.name == "inertia")


def envelope_of(plant: Plant, inverses: Sequence[InverseDynamics]) -> Envelope:
    """Return the limits that the plant states and, where it states none, what the records have shown the axis to do.

    Travel is that of the records; acceleration is what the drive leaves beyond the largest other force that they show.
    """
    motions = [p.motion for p in inverses]
    drive = plant.limits.drive
    drive = USED * drive if isfinite(drive) else max(float(np.abs(m.u).max()) for m in motions)
    speed = min(plant.limits.speed, max(float(np.abs(m.v).max()) for m in motions))
    fastest = max(float(np.abs(m.a).max()) for m in motions)
    mass = _mass_of(plant)
    if mass > 0.0:
        fastest = max((drive - _resistance(plant, inverses)) / mass, 0.1 * drive / mass)
    return Envelope(
        min(float(m.q.min()) for m in motions), max(float(m.q.max()) for m in motions), speed, fastest, drive
    )


def _resistance(plant: Plant, inverses: Sequence[InverseDynamics]) -> float:
    """Return the largest part of the drive that does not accelerate a body, on records whose load is free."""
    bodies = replace(plant, effects=tuple(e for e in plant.effects if e.name == "inertia"))
    largest = 0.0
    for p in inverses:
        if not p.motion.record.locked:
            m = p.motion
            rest = m.filter(m.u - balances(p, bodies).sum(axis=0))
            largest = max(largest, float(np.abs(rest[m.keep]).max()))
    return largest


def load_rest(plant: Plant, inverses: Sequence[InverseDynamics]) -> float:
    """Return the rms of what a plant leaves of the load's balance behind the evaluation filter; 0 of one mass."""
    free = [p for p in inverses if p.rows(plant) == 2]
    left = [p.motion.filter(balances(p, plant)[1])[p.motion.keep] for p in free]
    return float(np.sqrt(np.mean(np.concatenate(left) ** 2))) if left else 0.0


def sensing_of(
    inverses: Sequence[InverseDynamics], rms: float, load: float = 0.0, logged: Sequence[InverseDynamics] = ()
) -> Sensing:
    """Return how well these records are seen. rms: of the drive's noise behind the evaluation filter, N*m or N. load: as
    rms, of the load's balance (load_rest); as large as that where it is 0.

    F passes a share of white noise, the mean of |F|^2 up to half the sampling rate; a sample has the whole. logged: the same
    records at the rate at which they are logged, where `inverses` are decimated ones: as many samples fewer, as much less counts
    say, so that their noise in the band is that of the log.
    """
    m = inverses[0].motion
    f = np.fft.rfftfreq(4096, m.dt)
    share = float(np.mean(1 / (1 + (f / m.filter.bandwidth) ** 8) ** 2))
    counts = max(p.motion.counts for p in inverses)
    if logged:
        counts *= (logged[0].motion.dt / m.dt) ** 0.5
    if not (rms > 0.0 and rms < inf):
        raise WorkbenchError(f"the noise of the drive is {rms:g}; a plan needs one above 0.")
    return Sensing(rms / share**0.5, counts, m.dt, m.filter.bandwidth, load / share**0.5)

"""Where a residual lives: its mean and size over position, velocity, acceleration, load, stroke, direction and time.

A map holds what is left in bins of one coordinate, for both directions of motion and for each of them. Neighbouring samples of a
record say almost the same, so the standard error of a bin's mean counts visits: it is cluster-robust over the stretches in
which a record stays in the bin. Which window stands out is told by `windows`; frequency and order are in `spectra`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.identification.result import Fit
from workbench.inverse.bodies import POSITION
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import increments
from workbench.plant import TWO_MASS, Plant
from workbench.residual.window import DIRECTIONS, EITHER

BINS = 60
TURNED = 3.0  # counts back at which a motion has reversed
LOWEST = 1e-6  # first border of a stroke, over the longest
REST = 0.01  # of the speed's rms, below which an axis is at rest
POSITION_NAME, TURN, MOTOR_TURN, TIME, DIRECTION = (
    "position",
    "place in a turn",
    "place in a motor turn",
    "time",
    "direction",
)
STROKE = "distance since reversal"


@dataclass(frozen=True, eq=False)
class Map:
    """A residual in bins of one coordinate: edges (bins + 1,), mean, rms, count and error (bins,), SI.

    error: standard error of the mean; NaN in a bin that was visited once, as mean and rms are in one never visited. unit: of
    the coordinate. direction: 1 forward, -1 backward, 0 either. record: where the map is of one record alone.
    """

    coordinate: str
    unit: str
    direction: int
    edges: np.ndarray
    mean: np.ndarray
    rms: np.ndarray
    count: np.ndarray
    error: np.ndarray
    record: str = ""

    @property
    def centre(self) -> np.ndarray:
        """Middle of each bin, (bins,)."""
        return (self.edges[1:] + self.edges[:-1]) / 2


@dataclass(frozen=True, eq=False)
class Coordinate:
    """What residuals are held against: values (n,) of pooled records, and the edges of its bins."""

    name: str
    unit: str
    values: np.ndarray
    edges: np.ndarray


@dataclass(frozen=True, eq=False)
class Pooled:
    """The samples in which errors count, one record after another. first: (n,) where a record begins. direction: (n,) 1, 0, -1."""

    records: tuple[str, ...]
    first: np.ndarray
    direction: np.ndarray
    coordinates: tuple[Coordinate, ...]


def borders(values: np.ndarray, bins: int = BINS) -> np.ndarray:
    """Return the borders of bins: half of them even in the values, half in how many fall into each.

    The first reach the largest speeds; the second resolve what happens near standstill, where most samples are.
    """
    half = np.linspace(0, 1, bins // 2 + 1)
    low, high = np.min(values), np.max(values)
    return np.unique(np.concatenate((low + (high - low) * half, np.quantile(values, half))))


def _decades(values: np.ndarray) -> np.ndarray:
    """Return borders that are even in the logarithm: friction changes over the first microradians after a reversal."""
    high = float(np.max(values))
    low = max(float(np.quantile(values, 0.01)), LOWEST * high)
    return np.concatenate([[0.0], np.geomspace(low, high, BINS)])


def directions(position: np.ndarray, counts: float) -> tuple[np.ndarray, np.ndarray]:
    """Return (direction of motion 1, 0 or -1, distance since the last reversal), (n,) each, of a raw position.

    A reversal counts after three encoder counts back, so that an axis that stands between two counts does not reverse.
    """
    moved = increments(position, TURNED * counts if counts > 0 else 1e-6 * float(np.ptp(position)))
    index = np.arange(moved.size)
    direction = np.sign(moved)[np.maximum.accumulate(np.where(moved != 0.0, index, 0))]
    turned = np.concatenate([[False], direction[1:] * direction[:-1] < 0.0])
    travelled = np.cumsum(np.abs(moved))
    return direction, travelled - travelled[np.maximum.accumulate(np.where(turned, index, 0))]


def pooled(inverses: Sequence[InverseDynamics], plant: Plant, drive: Mapping[str, np.ndarray]) -> Pooled:
    """Return records side by side with what residuals are held against. drive: record -> (n,) what the model asks for."""
    x, turn = plant.displacement, 2 * np.pi
    parts: dict[tuple[str, str], list[np.ndarray]] = {}
    ends, moves = [], []
    for p in inverses:
        m, keep = p.motion, p.motion.keep
        direction, stroke = directions(m.record.channels["position"], m.counts)
        found = {(POSITION_NAME, x): m.q}
        if plant.rotary:
            found[TURN, x] = np.mod(m.q, turn)
            if plant.geometry.gear_ratio != 1.0:
                found[MOTOR_TURN, x] = np.mod(m.q * plant.geometry.gear_ratio, turn)
        found |= {("velocity", f"{x}/s"): m.v, ("acceleration", f"{x}/s^2"): m.a}
        found |= {("load", plant.effort): drive[m.record.name], (STROKE, x): stroke}
        if plant.kind == TWO_MASS:
            found["deflection of the joint", x] = p.bodies.body(plant, "joint")[1][POSITION]
        for key, values in found.items():
            parts.setdefault(key, []).append(values[keep])
        moves.append(direction[keep])
        ends.append(m.q[keep].size)
    first = np.zeros(sum(ends), bool)
    first[np.cumsum([0, *ends[:-1]])] = True
    signals = {key: np.concatenate(values) for key, values in parts.items()}
    direction, v = np.concatenate(moves), signals["velocity", f"{x}/s"]
    moving = np.where(np.abs(v) > REST * np.sqrt(np.mean(v**2)), np.sign(v), 0.0)
    found = []
    for (name, unit), values in signals.items():
        if np.ptp(values) > 0.0:
            found.append(Coordinate(name, unit, values, (_decades if name == STROKE else borders)(values)))
    found.append(Coordinate(DIRECTION, "1", moving, np.array([-1.5, -0.5, 0.5, 1.5])))
    return Pooled(tuple(p.motion.record.name for p in inverses), first, direction, tuple(found))


def binned(c: Coordinate, residual: np.ndarray, pool: Pooled, direction: int = EITHER, record: str = "") -> Map:
    """Return the map of a residual (n,) over one coordinate, of the samples that move in this direction."""
    bins = c.edges.size - 1
    index = np.searchsorted(c.edges[1:-1], c.values, side="right")
    if direction:
        index = np.where(pool.direction == direction, index, bins)  # one bin more, for what is not looked at
    visit = np.cumsum(pool.first | (np.diff(index, prepend=index[0]) != 0)) - 1
    where = index[np.flatnonzero(np.diff(visit, prepend=-1))]
    samples, sums = np.bincount(visit), np.bincount(visit, weights=residual)

    def over(weights) -> np.ndarray:
        return np.bincount(where, weights=weights, minlength=bins + 1)[:bins]

    count, visits = over(samples), np.bincount(where, minlength=bins + 1)[:bins]
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = over(sums) / count
        rms = np.sqrt(np.bincount(index, weights=residual**2, minlength=bins + 1)[:bins] / count)
        off = sums - samples * np.append(np.nan_to_num(mean), 0.0)[where]
        error = np.sqrt(over(off**2) * visits / np.where(visits > 1, visits - 1.0, np.nan)) / count
    return Map(c.name, c.unit, direction, c.edges, mean, rms, count, error, record)


def maps(pool: Pooled, residual: np.ndarray) -> tuple[Map, ...]:
    """Return every map of a residual (n,) of the pooled samples: each coordinate, both directions and each of them."""
    found = []
    for c in pool.coordinates:
        found += [binned(c, residual, pool, way) for way in ((EITHER,) if c.name == DIRECTION else DIRECTIONS)]
    return tuple(found)


def over_time(fit: Fit) -> tuple[Map, ...]:
    """Return each record's residual over its bench clock, in the order of their names."""
    found = []
    for name, s in sorted(fit.series.items()):
        time, residual = s.time[s.keep], s.residual[s.keep]
        blank = Pooled((name,), np.arange(time.size) == 0, np.zeros(time.size), ())
        clock = Coordinate(TIME, "s", time, np.linspace(time[0], time[-1], BINS + 1))
        found.append(binned(clock, residual, blank, record=name))
    return tuple(found)

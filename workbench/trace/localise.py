"""Where a residual lives: the places, speeds or moments outside which the model leaves no more than noise.

The excess of a residual is its power above the floor's. A window covers a share of the samples, and holds the share of the
excess that is gone outside when the model is fitted without the window's samples; the window in which the second exceeds
the first most is where the residual lives. Windows are intervals of position or of speed, in one direction or in both, in
COUNT steps of the range. Moments are the steps of the clock that hold most of the excess; they are asked only where no
window is a place, because whatever is somewhere is also sometime.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.identify.passes import Passes
from workbench.trace.score import DETERMINED, Deviations

COUNT = 80  # steps of position and of speed over their range
MOMENT = 0.02  # s, step of the clock
APART = 0.1  # s, gap up to which two moments are one
MOST = 0.98  # share of the excess that moments are to hold
ROUNDS = 4  # fits without the moments
LOCAL = 0.55  # share of the excess in a place, less the share of samples, from which it lives there
CONTRAST = 2.0  # rms inside over rms outside
WIDE = 0.8  # share of the range above which an interval is no place
WAYS = {0: "either direction", 1: "forward", -1: "backward"}


@dataclass(frozen=True)
class Place:
    """coordinate: "position", "velocity" (spans of its magnitude) or "time". spans: (low, high), SI.

    direction: 1 forward, -1 backward, 0 either. share: of the excess power inside. covered: share of the samples inside.
    inside, outside: rms of the residual over the floor's. rows: (N,) of bool, the rows of the problem inside.
    """

    coordinate: str
    spans: tuple[tuple[float, float], ...]
    direction: int
    share: float
    covered: float
    inside: float
    outside: float
    rows: np.ndarray

    @property
    def sentence(self) -> str:
        """Where, in words."""
        unit = {"position": "", "velocity": "", "time": " s"}[self.coordinate]
        spans = ", ".join(f"{low:.4g} to {high:.4g}{unit}" for low, high in self.spans[:6])
        more = f" and {len(self.spans) - 6} more" if len(self.spans) > 6 else ""
        name = {"position": "at positions", "velocity": "at speeds", "time": "at the times"}[self.coordinate]
        way = f", moving {WAYS[self.direction]}" if self.direction else ""
        return f"{name} from {spans}{more}{way}"


@dataclass(frozen=True, eq=False)
class Samples:
    """What is known of each row of a stacked problem: position, velocity, time, drive balance or not, floor (rms)."""

    q: np.ndarray
    v: np.ndarray
    t: np.ndarray
    drive: np.ndarray
    floor: np.ndarray


def samples(passes: Sequence[Passes], rows: Sequence[int], level: Mapping[str, float]) -> Samples:
    """Return the samples of a problem over these passes. rows: balances of each; level: record -> rms of the floor."""
    parts: list[list[np.ndarray]] = [[], [], [], [], []]
    for p, balances in zip(passes, rows, strict=True):
        m, keep = p.motion, p.motion.keep
        n = keep.stop - keep.start
        drive = np.tile(np.arange(balances) == 0, n)
        floor = np.full(n, level[m.record.name])
        for part, x in zip(parts, (m.q[keep], m.v[keep], m.t[keep], None, floor), strict=True):
            part.append(drive if x is None else np.repeat(x, balances))
    return Samples(*(np.concatenate(part) for part in parts))


def lives(residual: np.ndarray, known: Samples, model: Deviations) -> Place | None:
    """Return where `residual` (N,) of a model lives, or None where nothing exceeds the floor."""
    excess = excess_of(residual, known)
    if not excess.sum() > 0:
        return None
    cells = Scan(residual, known, model)
    options = [cells.window("position", known.q), cells.window("velocity", np.abs(known.v))]
    found = [weighed(o, model.without(residual, o.rows), known) for o in options if o]
    best = max(found, key=score, default=None)
    if local(best):
        return best
    times = moments_of(residual, known, model)
    return weighed(times, model.without(residual, times.rows), known) if times else best


def excess_of(residual: np.ndarray, known: Samples) -> np.ndarray:
    """Return each row's squared residual less the floor's, zero where it is no drive's balance."""
    return np.where(known.drive, residual**2 - known.floor**2, 0.0)


def moments_of(residual: np.ndarray, known: Samples, model: Deviations) -> Place | None:
    """Return the moments that hold most of the excess of a fit without them, sought anew ROUNDS times at most."""
    place, r = None, residual
    for _ in range(ROUNDS):
        excess = excess_of(r, known)
        if not excess.sum() > 0:
            break
        before, place = place, moments(known.t, excess, known.drive)
        if before is not None and np.array_equal(before.rows, place.rows):
            break
        r = model.without(residual, place.rows)
    return place


def weighed(place: Place, residual: np.ndarray, known: Samples) -> Place:
    """Return the place with what `residual` leaves inside and outside."""

    def over(rows):
        rows = rows & known.drive
        power, floor = np.sum(residual[rows] ** 2), np.sum(known.floor[rows] ** 2)
        return float(np.sqrt(power / floor)) if floor > 0 else float("inf") if power > 0 else 0.0

    return Place(
        place.coordinate, place.spans, place.direction, place.share, place.covered, over(place.rows), over(~place.rows),
        place.rows,
    )  # fmt: skip


def score(place: Place) -> float:
    return place.share - place.covered


def local(place: Place | None) -> bool:
    """Whether a place is one: most of the excess, few of the samples, and calm outside."""
    return place is not None and score(place) > LOCAL and place.inside > CONTRAST * place.outside


class Scan:
    """Fits of a model without each window in turn, from the Gram matrices of cells of a coordinate and a way of motion.

    A fit to everything smears what is local over all of the record, and the window of the largest residual is then not the
    one that the cause lives in; what is left outside after a fit without it tells.
    """

    def __init__(self, residual: np.ndarray, known: Samples, model: Deviations):
        self.residual, self.known = residual, known
        self.columns = model.columns
        self.every = int(np.count_nonzero(known.drive))
        self.excess = float(excess_of(residual, known).sum())

    def sums(self, cell: np.ndarray, count: int) -> tuple[np.ndarray, ...]:
        """Return, of each cell, normal equations of all rows and of the drive's: (cells, r, r), (cells, r), twice, and the
        power, the floor's power and the count of the drive's rows, (cells,) each. cell: (N,) of int."""
        known, r = self.known, self.columns.shape[1]
        grams, moments = np.zeros((2, count, r, r)), np.zeros((2, count, r))
        order = np.argsort(cell, kind="stable")
        edges = np.searchsorted(cell[order], np.arange(count + 1))
        for k in range(count):
            rows = order[edges[k] : edges[k + 1]]
            for which, chosen in enumerate((rows, rows[known.drive[rows]])):
                columns = self.columns[chosen]
                grams[which, k], moments[which, k] = columns.T @ columns, columns.T @ self.residual[chosen]
        weights = (self.residual**2, known.floor**2, np.ones(cell.size))
        powers = [np.bincount(cell, np.where(known.drive, w, 0.0), count) for w in weights]
        return grams[0], moments[0], grams[1], moments[1], *powers

    def window(self, name: str, x: np.ndarray) -> Place | None:
        """Return the interval of x, in one way or both, whose share of the excess exceeds its share of samples most."""
        low, high = float(x.min()), float(x.max())
        if not high > low:
            return None
        index = np.minimum((COUNT * (x - low) / (high - low)).astype(int), COUNT - 1)
        v = self.known.v
        ways = np.sign(v).astype(int) + 1
        sums = [
            s.reshape(COUNT, len(WAYS), *s.shape[1:]) for s in self.sums(index * len(WAYS) + ways, COUNT * len(WAYS))
        ]
        i, j = np.triu_indices(COUNT + 1, 1)
        narrow = j - i <= WIDE * COUNT
        i, j = i[narrow], j[narrow]
        best = None
        for direction in WAYS:
            chosen = [s.sum(axis=1) if direction == 0 else s[:, direction + 1] for s in sums]
            upto = [np.concatenate([np.zeros((1, *s.shape[1:])), np.cumsum(s, axis=0)]) for s in chosen]
            inside = [c[j] - c[i] for c in upto]
            share = 1.0 - self.left([s.sum(axis=(0, 1)) - part for s, part in zip(sums, inside, strict=True)])
            covered = inside[-1] / self.every
            k = int(np.argmax(share - covered))
            if best is None or share[k] - covered[k] > best[0] + 1e-12:
                best = (share[k] - covered[k], int(i[k]), int(j[k]), direction, float(share[k]), float(covered[k]))
        _, first, last, direction, share, covered = best
        rows = (index >= first) & (index < last) & ((v * direction > 0) if direction else True)
        step = (high - low) / COUNT
        span = (low + first * step, low + last * step)
        return Place(name, (span,), direction, share, covered, np.nan, np.nan, rows)

    def left(self, outside: Sequence[np.ndarray]) -> np.ndarray:
        """Return the share of the excess that a fit to the rows outside leaves there, one a window."""
        gram, moment, gram_drive, moment_drive, power, floor, _ = outside
        whole = np.maximum(np.trace(gram, axis1=1, axis2=2), 1e-300)
        loaded = gram + DETERMINED * whole[:, None, None] * np.eye(gram.shape[1])
        d = np.linalg.solve(loaded, moment[..., None])[..., 0]
        fitted = 2.0 * np.einsum("ki,ki->k", d, moment_drive) - np.einsum("ki,kij,kj->k", d, gram_drive, d)
        return np.maximum(power - fitted - floor, 0.0) / self.excess


def moments(t: np.ndarray, excess: np.ndarray, drive: np.ndarray) -> Place | None:
    """Return the steps of the clock that hold MOST of the excess, the strongest first; neighbours are one span."""
    step = np.floor(t / MOMENT).astype(int)
    first = int(step.min())
    power = np.bincount(step - first, weights=excess)
    count = np.bincount(step - first, weights=drive)
    order = np.argsort(-power, kind="stable")
    held = np.cumsum(power[order])
    many = int(np.searchsorted(held, MOST * excess.sum())) + 1
    chosen = np.zeros(power.size, bool)
    chosen[order[:many]] = True
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(int)))
    spans: list[tuple[float, float]] = []
    for a, b in edges.reshape(-1, 2):
        low, high = float((first + a) * MOMENT), float((first + b) * MOMENT)
        if spans and low - spans[-1][1] <= APART:
            low = spans.pop()[0]
        spans.append((low, high))
    share, covered = power[chosen].sum() / excess.sum(), count[chosen].sum() / np.count_nonzero(drive)
    return Place("time", tuple(spans), 0, float(share), float(covered), np.nan, np.nan, chosen[step - first])

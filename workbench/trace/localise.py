"""Where a residual lives: the places, speeds or moments outside which the model leaves no more than noise.

The excess of a residual is its power above the floor's. A window holds a share of the excess and covers a share of the
samples; the window in which the first exceeds the second most is where the residual lives. The model is then fitted again
without that window's samples, because a fit to everything smears what is local over all of the record, and the window is
sought anew. Windows are intervals of position or of speed, in one direction or in both, in COUNT steps of the range; moments
are the steps of the clock that hold most of the excess.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.identify.passes import Passes

COUNT = 80  # steps of position and of speed over their range
MOMENT = 0.02  # s, step of the clock
APART = 0.1  # s, gap up to which two moments are one
MOST = 0.98  # share of the excess that moments are to hold
ROUNDS = 4  # fits without the window
TIME_LAST = 0.15  # by which moments must do better than a place or a speed: whatever is somewhere is also sometime
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


def lives(residual: np.ndarray, known: Samples, refitted: Callable[[np.ndarray], np.ndarray]) -> Place | None:
    """Return where `residual` (N,) lives, or None where nothing exceeds the floor.

    refitted: rows to leave out (N,) -> residual of the model fitted to the others.
    """
    place, r = None, residual
    for _ in range(ROUNDS):
        found = best_place(r, known)
        if found is None:
            return place
        place, before = found, place
        if before is not None and np.array_equal(before.rows, place.rows):
            break
        r = refitted(place.rows)
    return weighed(place, r, known)


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


def best_place(residual: np.ndarray, known: Samples) -> Place | None:
    """Return the window or the moments with most of the excess for their size."""
    excess = np.where(known.drive, residual**2 - known.floor**2, 0.0)
    if not excess.sum() > 0:
        return None
    options = [
        window("position", known.q, known.v, excess, known.drive),
        window("velocity", np.abs(known.v), known.v, excess, known.drive),
    ]
    best = max((o for o in options if o), key=score, default=None)
    times = moments(known.t, excess, known.drive)
    if times and (best is None or score(times) > score(best) + TIME_LAST):
        return times
    return best


def score(place: Place) -> float:
    return place.share - place.covered


def window(name: str, x: np.ndarray, v: np.ndarray, excess: np.ndarray, drive: np.ndarray) -> Place | None:
    """Return the interval of x, in one direction or in both, whose share of the excess exceeds its share of samples most."""
    low, high = float(x.min()), float(x.max())
    if not high > low:
        return None
    index = np.minimum((COUNT * (x - low) / (high - low)).astype(int), COUNT - 1)
    whole, every = excess.sum(), np.count_nonzero(drive)
    best = None
    for direction in (0, 1, -1):
        chosen = drive & (v * direction > 0) if direction else drive
        power = np.cumsum(np.bincount(index[chosen], weights=excess[chosen], minlength=COUNT)) / whole
        count = np.cumsum(np.bincount(index[chosen], minlength=COUNT)) / every
        gain = np.concatenate([[0.0], power - count])
        rise = gain[None, :] - gain[:, None]  # of the interval from step i up to step j
        i, j = np.indices(rise.shape)
        rise[(j <= i) | (j - i > WIDE * COUNT)] = -np.inf
        i, j = divmod(int(np.argmax(rise)), COUNT + 1)
        if best is None or rise[i, j] > best[0] + 1e-12:
            share, covered = (np.concatenate([[0.0], c]) for c in (power, count))
            best = (rise[i, j], i, j, direction, share[j] - share[i], covered[j] - covered[i])
    _, i, j, direction, share, covered = best
    rows = (index >= i) & (index < j) & ((v * direction > 0) if direction else True)
    step = (high - low) / COUNT
    span = (low + i * step, low + j * step)
    return Place(name, (span,), direction, float(share), float(covered), np.nan, np.nan, rows)


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

"""Where a residual lives: the windows of position or speed, or the moments, outside which the model leaves no more than noise.

The excess of a residual is its power above the floor's. A window covers a share of the samples, and holds the share of the
excess that is gone outside when the model is fitted without the window's samples; the window in which the second exceeds
the first most is where the residual lives. Windows are intervals of position or of speed, in one direction or in both, in
COUNT steps of the range. Moments are the steps of the clock that hold most of the excess; they are said where no window
stands for it, or where they hold the excess in far fewer samples.
"""

from collections.abc import Sequence

import numpy as np

from workbench.identification.cross_validation import DETERMINED, Deviations
from workbench.residual.change_points import change_points
from workbench.residual.samples import Samples, excess_of, left_in, relative_rms
from workbench.residual.window import DIRECTIONS, Window, local

COUNT = 80  # steps of position and of speed over their range
MOMENT = 0.02  # s, step of the clock
APART = 0.1  # s, gap up to which two moments are one
MOST = 0.98  # share of the excess that moments are to hold
SOMETIME = 0.3  # by which moments must do better than a window: whatever is somewhere is also sometime
FAINT = 0.05  # of what a span holds on average, below which one is none
ROUNDS = 4  # fits without the moments
JUMPED = 0.9  # share of the excess that jumps of the level must take away
WIDE = 0.8  # share of the range above which an interval is no window


def localise(residual: np.ndarray, known: Samples, model: Deviations) -> Window | None:
    """Return where `residual` (N,) of a model lives, or None where nothing exceeds the floor."""
    excess = excess_of(residual, known)
    if not excess.sum() > 0:
        return None
    cells = Scan(residual, known, model)
    options = [cells.window("position", known.q), cells.window("velocity", np.abs(known.v))]
    found = [left_in(o, model.without(residual, o.rows), known) for o in options if o]
    best = max(found, key=lambda w: w.contrast, default=None)
    times = _moments_of(residual, known, model)
    if times is None or plainer(best, times):
        return best
    return left_in(times, model.without(residual, times.rows), known)


def plainer(window: Window | None, moments: Window) -> bool:
    """Whether a window of position or of speed says it better than moments do, which hold as much of nearly everything."""
    named = local(window) and window.coordinate != "time"
    return named and window.contrast > moments.contrast - SOMETIME


def _moments_of(residual: np.ndarray, known: Samples, model: Deviations) -> Window | None:
    """Return the moments that hold most of the excess of a fit without them, sought anew ROUNDS times at most."""
    window, r = None, residual
    for _ in range(ROUNDS):
        excess = excess_of(r, known)
        if not excess.sum() > 0:
            break
        before, window = window, _moments(known.t, excess, known.drive)
        if before is not None and np.array_equal(before.rows, window.rows):
            break
        r = model.without(residual, window.rows)
    return window


def change_windows(residual: np.ndarray, known: Samples, model: Deviations) -> Window | None:
    """Return the moments at which the level of a residual jumps and stays, or None where that is not nearly all of it.

    inside, outside: rms of the whole residual over the floor's, before and after levels of its own between the moments.
    """
    whole = float(excess_of(residual, known).sum())
    if not whole > 0:
        return None
    found = change_points(residual, known.t, known.drive, known.floor, model)
    share = 1.0 - max(float(excess_of(found.residual, known).sum()), 0.0) / whole
    if not found.times or share < JUMPED:
        return None
    near = np.zeros(known.t.size, bool)
    for t in found.times:
        near |= np.abs(known.t - t) <= MOMENT
    covered = float(np.count_nonzero(near & known.drive) / np.count_nonzero(known.drive))
    every = np.ones(known.t.size, bool)
    before, after = (relative_rms(r, every, known) for r in (residual, found.residual))
    spans = tuple((t - MOMENT, t + MOMENT) for t in found.times)
    return Window("time", spans, 0, share, covered, before, after, rows=near)


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

    def window(self, name: str, x: np.ndarray) -> Window | None:
        """Return the interval of x, in one way or both, whose share of the excess exceeds its share of samples most."""
        low, high = float(x.min()), float(x.max())
        if not high > low:
            return None
        index = np.minimum((COUNT * (x - low) / (high - low)).astype(int), COUNT - 1)
        way = self.known.direction.astype(int)
        sums = [
            s.reshape(COUNT, len(DIRECTIONS), *s.shape[1:])
            for s in self.sums(index * len(DIRECTIONS) + way + 1, COUNT * len(DIRECTIONS))
        ]
        i, j = np.triu_indices(COUNT + 1, 1)
        narrow = j - i <= WIDE * COUNT
        i, j = i[narrow], j[narrow]
        best = None
        for direction in DIRECTIONS:
            chosen = [s.sum(axis=1) if direction == 0 else s[:, direction + 1] for s in sums]
            upto = [np.concatenate([np.zeros((1, *s.shape[1:])), np.cumsum(s, axis=0)]) for s in chosen]
            inside = [c[j] - c[i] for c in upto]
            share = 1.0 - self.left([s.sum(axis=(0, 1)) - part for s, part in zip(sums, inside, strict=True)])
            covered = inside[-1] / self.every
            k = int(np.argmax(share - covered))
            if best is None or share[k] - covered[k] > best[0] + 1e-12:
                best = (share[k] - covered[k], int(i[k]), int(j[k]), direction, float(share[k]), float(covered[k]))
        _, first, last, direction, share, covered = best
        rows = (index >= first) & (index < last) & ((way == direction) if direction else True)
        step = (high - low) / COUNT
        span = (low + first * step, low + last * step)
        return Window(name, (span,), direction, min(share, 1.0), covered, np.nan, np.nan, rows=rows)

    def left(self, outside: Sequence[np.ndarray]) -> np.ndarray:
        """Return the share of the excess that a fit to the rows outside leaves there, one a window."""
        gram, moment, gram_drive, moment_drive, power, floor, _ = outside
        whole = np.maximum(np.trace(gram, axis1=1, axis2=2), 1e-300)
        loaded = gram + DETERMINED * whole[:, None, None] * np.eye(gram.shape[1])
        d = np.linalg.solve(loaded, moment[..., None])[..., 0]
        fitted = 2.0 * np.einsum("ki,ki->k", d, moment_drive) - np.einsum("ki,kij,kj->k", d, gram_drive, d)
        return np.maximum(power - fitted - floor, 0.0) / self.excess


def _moments(t: np.ndarray, excess: np.ndarray, drive: np.ndarray) -> Window | None:
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
    runs: list[list[int]] = []
    for a, b in np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(int))).reshape(-1, 2).tolist():
        if runs and MOMENT * (a - runs[-1][1]) <= APART:
            a = runs.pop()[0]
        runs.append([a, b])
    held = [float(power[a:b].sum()) for a, b in runs]
    runs = [r for r, x in zip(runs, held, strict=True) if x > FAINT * np.mean(held)]
    inside = np.zeros(power.size, bool)
    for a, b in runs:
        inside[a:b] = chosen[a:b]
    share, covered = power[inside].sum() / excess.sum(), count[inside].sum() / np.count_nonzero(drive)
    spans = tuple((float((first + a) * MOMENT), float((first + b) * MOMENT)) for a, b in runs)
    return Window("time", spans, 0, min(float(share), 1.0), float(covered), np.nan, np.nan, rows=inside[step - first])

"""Channels that stand where the axis moves: clipped at their ends, or frozen; and samples that are missing in between."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from workbench.checking.scale import pooled
from workbench.checking.seen import ENCODERS, Seen
from workbench.record import Record

STANDS = 5  # samples of one value, from which an encoder may stand
HELD = 20e-3  # s, and twice STANDS samples, from which a drive of one value is frozen
COUNTS = 4  # of the encoder, that any two increments may differ by
MARGIN = 2.0  # on the acceleration that the drive can give
CLIPPED = 3  # samples of one run at the end of a drive's range
LIMIT = 0.02  # about the declared limit: a drive that stands there is at its limit, and says so truly
OUTLIER = 6.0  # ranges of its neighbours that an increment lies outside where samples are missing


@dataclass(frozen=True)
class Run:
    """Samples first to last of one value."""

    first: int
    last: int

    @property
    def size(self) -> int:
        return self.last - self.first + 1


@dataclass(frozen=True)
class Frozen:
    """A channel stands for these s: from `at` s on, while other channels tell of motion, or in the whole record (None)."""

    record: str
    channel: str
    seconds: float
    at: float | None = None


@dataclass(frozen=True)
class Clipped:
    """An encoder stands at an end of its range for `samples`, and stops there more abruptly than the drive can stop it.

    lowest, highest: its range in `unit`, SI.
    """

    record: str
    channel: str
    unit: str
    samples: int
    lowest: float
    highest: float


@dataclass(frozen=True)
class ClippedDrive:
    """A drive has exactly one value, SI, for `samples` in `runs`: the "largest" or the "smallest" that it has (`end`)."""

    record: str
    channel: str
    unit: str
    end: str
    value: float
    samples: int
    runs: int


@dataclass(frozen=True)
class Leaping:
    """A channel leaps this many times by more than its speed before and after, first at `at` s: samples are missing."""

    record: str
    channel: str
    leaps: int
    at: float


def runs(x: np.ndarray, shortest: int) -> list[Run]:
    """Return the runs of equal samples, at least this many each."""
    edges = np.flatnonzero(np.diff(x)) + 1
    starts, ends = np.append(0, edges), np.append(edges, x.size) - 1
    long = ends - starts + 1 >= shortest
    return [Run(int(a), int(b)) for a, b in zip(starts[long], ends[long], strict=True)]


def _reach(seen: Seen, r: Record) -> np.ndarray | None:
    """Return the largest change of speed a sample (n,) that the drive can have given, or None where that is not known.

    What it reports within five samples and what it reports anywhere, as friction and joints may hold that much, over the
    inertia that the records have.
    """
    inertia = abs(pooled(seen.balances).values.get(seen.inertia, 0.0)) if seen.inertia else 0.0
    if inertia == 0.0:
        return None
    from numpy.lib.stride_tricks import sliding_window_view

    u = np.abs(r.drive - np.mean(r.drive))
    near = sliding_window_view(np.pad(u, 5, mode="edge"), 11).max(axis=1)
    return MARGIN * (near + np.quantile(u, 0.99)) / inertia * r.dt**2


def unsound(seen: Seen) -> Iterator[Frozen | Clipped | ClippedDrive | Leaping]:
    """Yield which channels miss samples, are clipped or frozen."""
    yield from _dropped(seen)
    yield from _standing(seen)
    yield from drives(seen)


def _standing(seen: Seen) -> Iterator[Frozen | Clipped]:
    """Yield which encoders are clipped or frozen: they stand, and stop or start more abruptly than the drive can make them."""
    for r in seen.campaign.records:
        for name in ENCODERS:
            if name not in r.channels or (r.locked and name == "load_position"):
                continue
            x = r.channels[name]
            if np.ptp(x) == 0.0:
                yield Frozen(r.name, name, x.size * r.dt)
                continue
            within = _reach(seen, r)
            if within is not None:
                yield from _abrupt(r, name, seen.steps[name], within * (1 if name == "position" else 2))


def _abrupt(r: Record, name: str, step: float, within: np.ndarray) -> Iterator[Frozen | Clipped]:
    x = r.channels[name]
    moved = np.abs(np.diff(x))
    clipped, frozen = [], []
    for run in runs(x, STANDS):
        before = moved[run.first - 1] if run.first > 0 else 0.0
        after = moved[run.last] if run.last < moved.size else 0.0
        if max(before, after) > within[run.first : run.last + 1].max() + COUNTS * step:
            at_end = x[run.first] in (x.max(), x.min())
            (clipped if at_end else frozen).append(run)
    if frozen:
        longest = max(frozen, key=lambda run: run.size)
        yield Frozen(r.name, name, longest.size * r.dt, float(r.time[longest.first]))
    if clipped:
        count = sum(run.size for run in clipped)
        yield Clipped(r.name, name, r.units[name], count, float(x.min()), float(x.max()))


def drives(seen: Seen) -> Iterator[Frozen | ClippedDrive]:
    """Yield which drives are clipped or frozen."""
    limit = seen.campaign.plant.limits.drive
    for r, p in zip(seen.campaign.records, seen.inverses, strict=True):
        u = r.drive
        if np.ptp(u) == 0.0:
            yield Frozen(r.name, seen.drive, u.size * r.dt)
            continue
        step = float(np.min(np.abs(np.diff(u))[np.diff(u) != 0.0]))
        ends, frozen = {"largest": [], "smallest": []}, []
        for run in runs(u, CLIPPED):
            value = u[run.first]
            if value != 0.0 and value in (u.max(), u.min()) and abs(abs(value) / limit - 1.0) > LIMIT:
                ends["largest" if value == u.max() else "smallest"].append(run)
            elif run.size >= max(2 * STANDS, round(HELD / r.dt)) and _accelerates(p.motion, run, value):
                frozen.append(run)
        for word, at in ends.items():
            away = [abs(u[run.first - 1] - u[run.first]) for run in at if run.first > 0]
            count = sum(run.size for run in at)
            if count > CLIPPED + 1 and away and float(np.median(away)) >= 3 * step:
                value = float(u[at[0].first])
                yield ClippedDrive(r.name, seen.drive, r.units[seen.drive], word, value, count, len(at))
        if frozen:
            longest = max(frozen, key=lambda run: run.size)
            yield Frozen(r.name, seen.drive, longest.size * r.dt, float(r.time[longest.first]))


def _accelerates(motion, run: Run, value: float) -> bool:
    """Whether the axis accelerates in a run as it does elsewhere; coasting without drive is no fault."""
    inside = slice(run.first, run.last + 1)
    if value == 0.0 and abs(motion.v[run.last]) <= abs(motion.v[run.first]):
        return False
    return bool(np.std(motion.a[inside]) > 0.3 * np.std(motion.a))


def _dropped(seen: Seen) -> Iterator[Leaping]:
    """Yield where samples are missing by the motion: the time channel was made afterwards."""
    for r in seen.campaign.records:
        for name in ENCODERS:
            if name in r.channels:
                at = _leaps(r.channels[name], seen.steps[name])
                if at.size:
                    yield Leaping(r.name, name, at.size, float(r.time[at[0]]))
                    break


def _leaps(x: np.ndarray, step: float) -> np.ndarray:
    """Return the samples whose increment lies far outside those of three neighbours on either side, all in motion."""
    moved = np.diff(x)
    around = np.stack([np.roll(moved, k) for k in (-3, -2, -1, 1, 2, 3)])
    moving = np.any(around[:3], axis=0) & np.any(around[3:], axis=0)  # else it stood before, or stands after
    low, high = around.min(axis=0), around.max(axis=0)
    beyond = np.maximum(moved - high, low - moved)
    step = step or float(np.min(np.abs(moved[moved != 0.0]), initial=np.inf))
    leaps = beyond > OUTLIER * (high - low) + (COUNTS - 1) * step
    leaps[:3] = leaps[-3:] = False
    return np.flatnonzero(leaps & moving & (beyond > 0.4 * np.abs(0.5 * (low + high)))) + 1

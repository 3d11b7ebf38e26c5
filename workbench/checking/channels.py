"""Channels that stand where the axis moves: clipped at their ends, or frozen; and samples that are missing in between."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from workbench.checking.scale import pooled
from workbench.checking.seen import ENCODERS, Seen
from workbench.finding import RESAMPLED, Finding
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


def unsound(seen: Seen) -> Iterator[Finding]:
    """Say which channels miss samples, are clipped or frozen."""
    yield from _dropped(seen)
    yield from _standing(seen)
    yield from drives(seen)


def _standing(seen: Seen) -> Iterator[Finding]:
    """Say which encoders are clipped or frozen: they stand, and stop or start more abruptly than the drive can make them."""
    for r in seen.campaign.records:
        for name in ENCODERS:
            if name not in r.channels or (r.locked and name == "load_position"):
                continue
            x = r.channels[name]
            if np.ptp(x) == 0.0:
                yield _frozen(r, name, x.size * r.dt)
                continue
            within = _reach(seen, r)
            if within is not None:
                yield from _abrupt(r, name, seen.steps[name], within * (1 if name == "position" else 2))


def _abrupt(r: Record, name: str, step: float, within: np.ndarray) -> Iterator[Finding]:
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
        yield _frozen(r, name, longest.size * r.dt, float(r.time[longest.first]))
    if clipped:
        count, (low, high) = sum(run.size for run in clipped), (x.min(), x.max())
        yield Finding(
            "clipped", f"{r.name}.{name}",
            f"In record '{r.name}' {name} stands at an end of its range ({low:.4g} to {high:.4g} {r.units[name]}) for {count} "
            "samples, and stops there more abruptly than the drive can stop it.",
            {"samples": float(count), "lowest": float(low), "highest": float(high)},
            "Widen the range of this channel in the logger, or move less far.",
        )  # fmt: skip


def _frozen(r: Record, name: str, seconds: float, at: float | None = None) -> Finding:
    """Say that a channel stands: from `at` on, while other channels tell of motion, or in the whole record."""
    when = "from its first to its last sample" if at is None else f"from {at:.3f} s on, while the axis moves"
    return Finding(
        "frozen", f"{r.name}.{name}",
        f"In record '{r.name}' {name} does not change for {1e3 * seconds:.0f} ms {when}.",
        {"seconds": seconds},
        "Check the cable and the logger's buffer, and record again.",
    )  # fmt: skip


def drives(seen: Seen) -> Iterator[Finding]:
    """Say which drives are clipped or frozen."""
    limit = seen.campaign.plant.limits.drive
    for r, p in zip(seen.campaign.records, seen.passes, strict=True):
        u = r.drive
        if np.ptp(u) == 0.0:
            yield _frozen(r, seen.drive, u.size * r.dt)
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
                yield _clipped_drive(r, seen.drive, word, float(u[at[0].first]), count, len(at))
        if frozen:
            longest = max(frozen, key=lambda run: run.size)
            yield _frozen(r, seen.drive, longest.size * r.dt, float(r.time[longest.first]))


def _accelerates(motion, run: Run, value: float) -> bool:
    """Whether the axis accelerates in a run as it does elsewhere; coasting without drive is no fault."""
    inside = slice(run.first, run.last + 1)
    if value == 0.0 and abs(motion.v[run.last]) <= abs(motion.v[run.first]):
        return False
    return bool(np.std(motion.a[inside]) > 0.3 * np.std(motion.a))


def _clipped_drive(r: Record, channel: str, word: str, value: float, count: int, times: int) -> Finding:
    return Finding(
        "clipped", f"{r.name}.{channel}",
        f"In record '{r.name}' {channel} has exactly its {word} value, {value:.4g} {r.units[channel]}, for {count} samples in "
        f"{times} runs: its range ends there.",
        {"value": value, "samples": float(count), "runs": float(times)},
        "Widen the range of this channel in the logger; where this is the drive's own limit, declare actuator_limit.",
    )  # fmt: skip


def resampled(seen: Seen) -> Iterator[Finding]:
    """Say where samples are missing by the time channel; what lies between is interpolated, so that the record may serve."""
    for f in seen.campaign.findings:
        if f.kind == RESAMPLED:
            yield replace(f, kind="dropped samples")


def _dropped(seen: Seen) -> Iterator[Finding]:
    """Say where samples are missing by the motion: the time channel was made afterwards."""
    for r in seen.campaign.records:
        for name in ENCODERS:
            if name in r.channels:
                at = _leaps(r.channels[name], seen.steps[name])
                if at.size:
                    yield Finding(
                        "dropped samples", f"{r.name}.{name}",
                        f"In record '{r.name}' {name} leaps at {at.size} samples by more than its speed before and after, "
                        f"first at {r.time[at[0]]:.3f} s: samples are missing, and the time channel does not show it.",
                        {"leaps": float(at.size)},
                        "Log the time with each sample, and record again with a larger buffer.",
                    )  # fmt: skip
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

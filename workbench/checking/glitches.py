"""Glitches: single samples that an encoder or a drive cannot have had. Everything else is judged without them."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from workbench.checking.scale import pooled
from workbench.checking.seen import ENCODERS, Seen
from workbench.record import Record

BESIDE = 8  # samples on either side that a sample is compared with
OUTLIER = 8.0  # times what these show of themselves: of Gaussian noise one in 10^15 lies beyond
ALONE = (
    0.25  # of a spike that its two neighbours may be off by: else it is no spike of one sample, but a step or a burst
)
COUNTS = 4.0  # of the encoder: what reading and dither may add up to
GIVES = 4.0  # times what the drive of this record can do in a sample: its inertia is known within FACTOR of `scale`, and peaks are clipped
FOLLOWS = 0.3  # of the change of speed that a spike of the drive would make: less than that came of it
SHOWS = 3.0  # times what the encoder resolves that this change must be, to be missed
LONG = 20  # samples on either side that a speed is taken from
NEVER = 3.0  # times what a drive has anywhere else in its record, and beyond its limit: no motion need bear witness
MOST = 5  # samples of one channel that are named; more are a fault of another kind


@dataclass(frozen=True)
class Glitch:
    """Samples of one channel that cannot have been. time, value, beside: of the first of them, s and SI in `unit`; beside: what lies
    between its neighbours. drive: whether it is the drive's channel."""

    record: str
    channel: str
    unit: str
    samples: tuple[int, ...]
    time: float
    value: float
    beside: float
    drive: bool


def _apart(x: np.ndarray) -> np.ndarray:
    """Return how far each sample (n,) lies from the straight line through its neighbours, at the ends from that of the next two."""
    d = np.empty_like(x)
    d[1:-1] = x[1:-1] - 0.5 * x[:-2] - 0.5 * x[2:]
    d[0], d[-1] = x[0] - (2 * x[1] - x[2]), x[-1] - (2 * x[-2] - x[-3])
    return d


def _mended(x: np.ndarray, samples, step: float = 0.0) -> np.ndarray:
    """Return x with these samples on the straight line between those that are left, whole steps from the one beside them."""
    kept = np.setdiff1d(np.arange(x.size), samples)
    line = np.interp(np.arange(x.size), kept, x[kept])
    if step > 0.0:
        beside = x[kept[np.maximum(np.searchsorted(kept, samples) - 1, 0)]]
        line[samples] = beside + step * np.round((line[samples] - beside) / step)
    return line


def lone(x: np.ndarray, floor: float) -> np.ndarray:
    """Return the samples that stand alone, the largest first: far outside of what lies beside them, which is alike among itself.

    floor: size from which on a sample may stand out.
    """
    d = np.abs(_apart(x))
    found = []
    for k in np.argsort(d)[::-1][: 3 * MOST]:
        near = np.arange(max(k - BESIDE, 0), min(k + BESIDE + 1, x.size))
        near = near[(near != k) & ~np.isin(near, found)]
        line = np.polynomial.Polynomial.fit(near - k, x[near], 2)
        size = abs(float(x[k] - line(0.0)))
        off = np.abs(x[near] - line(near - k))
        moves = float(np.max(np.abs(np.diff(x[near])), initial=0.0))
        pair = x[near[np.abs(near - k) == 1]]
        if size <= floor or d[k] == 0.0 or size <= OUTLIER * max(float(off.max()), moves):
            continue
        if pair.size == 0 or np.ptp(pair) < ALONE * size:
            found.append(int(k))
    return np.array(found, dtype=int)


def _suspects(seen: Seen) -> Mapping[tuple[str, str], np.ndarray]:
    """Return (record, channel) -> samples that stand alone, of encoders and drives."""
    found = {}
    for r in seen.campaign.records:
        for name in (*ENCODERS, seen.drive):
            if name in r.channels and np.ptp(r.channels[name]) > 0.0:
                samples = lone(r.channels[name], COUNTS * seen.steps.get(name, 0.0))
                if 0 < samples.size <= MOST:
                    found[r.name, name] = samples
    return found


def _without(seen: Seen, found: Mapping[tuple[str, str], np.ndarray]) -> Seen:
    """Return this with such samples on the line between their neighbours."""
    made = []
    for r in seen.campaign.records:
        mine = {
            c: _mended(r.channels[c], k, seen.steps.get(c, 0.0)) for (name, c), k in found.items() if name == r.name
        }
        made.append(replace(r, channels={**r.channels, **mine}) if mine else r)
    return Seen(replace(seen.campaign, records=tuple(made))) if found else seen


def _inertia_of(seen: Seen, suspected: Collection[str]) -> float:
    """Return the inertia that the records have, 0 where none is declared; of those that nothing is suspected of where there are."""
    others = {r.name for r in seen.campaign.records} - set(suspected)
    seen = seen.only(others) if others else seen
    return abs(pooled(seen.balances).values.get(seen.inertia, 0.0)) if seen.inertia else 0.0


def impossible(seen: Seen) -> tuple[tuple[Glitch, ...], Seen]:
    """Return samples that cannot have been, and the campaign without them.

    A position is none where the drive, at its largest, could not have moved the axis there and back; a drive, where it would
    have changed the speed, and did not.
    """
    found = _suspects(seen)
    if not found:
        return (), seen
    sound = _without(seen, found)
    inertia = _inertia_of(sound, {name for name, _ in found})
    proven = {}
    for (name, channel), samples in found.items():
        r = next(r for r in seen.campaign.records if r.name == name)
        clean = next(x for x in sound.campaign.records if x.name == name)
        step = seen.steps.get("position", 0.0)
        bad = [
            k for k in samples.tolist()
            if (_no_drive(r, clean, k, inertia, seen.campaign.plant.limits.drive, step) if channel == seen.drive
                else _no_place(r, clean, channel, k, inertia))
        ]  # fmt: skip
        if bad:
            proven[name, channel] = np.array(sorted(bad))
    return tuple(_glitch(seen, *where, k) for where, k in proven.items()), _without(seen, proven)


def _no_place(r: Record, clean: Record, channel: str, k: int, inertia: float) -> bool:
    """Whether the drive could not have moved the axis to this sample and back."""
    if inertia == 0.0:
        return True
    u = clean.drive - np.mean(clean.drive)
    far = GIVES * float(np.max(np.abs(u))) / inertia * r.dt**2
    return bool(abs(r.channels[channel][k] - clean.channels[channel][k]) > (1 if channel == "position" else 2) * far)


def _no_drive(r: Record, clean: Record, k: int, inertia: float, limit: float, step: float) -> bool:
    """Whether a sample of the drive left no trace in the speed that it would have changed."""
    size = float(r.drive[k] - clean.drive[k])
    largest = float(np.max(np.abs(clean.drive)))
    if abs(r.drive[k]) > NEVER * max(largest, limit if np.isfinite(limit) else 0.0) and np.isfinite(limit):
        return True
    if inertia == 0.0 or k < LONG or k > r.drive.size - LONG:
        return abs(r.drive[k]) > 100 * NEVER * largest
    made, speeds = size * r.dt / inertia, _speeds_about(clean, k)
    resolved = step / (LONG * r.dt)
    if np.min(np.abs(speeds)) < SHOWS * resolved or np.ptp(
        np.sign(speeds)
    ):  # at rest friction takes a spike and gives it back
        return abs(r.drive[k]) > 100 * NEVER * largest
    usual = float(np.max(np.abs(np.diff(_sliding_speeds(clean, k)))))
    return bool(abs(made) * FOLLOWS > SHOWS * (resolved + usual) and (speeds[1] - speeds[0]) / made < FOLLOWS)


def _speeds_about(r: Record, k: int) -> np.ndarray:
    """Return the mean speeds (2,) before and after a sample; what lies within two samples of it is between them."""
    q = r.channels["position"]
    ends = [(k - LONG, k - 2), (k + 2, min(k + LONG, q.size - 1))]
    return np.array([(q[b] - q[a]) / ((b - a) * r.dt) for a, b in ends])


def _sliding_speeds(r: Record, k: int) -> np.ndarray:
    """Return the mean speeds of consecutive stretches about a sample, that one apart: how speed changes there anyway."""
    q, half = r.channels["position"], LONG // 2
    at = np.r_[np.arange(max(k - 2 * LONG, 0), k - 1, half), np.arange(k + 2, min(k + 2 * LONG, q.size), half)]
    speeds = np.diff(q[at]) / (np.diff(at) * r.dt)
    return speeds[np.diff(at) == half] if np.count_nonzero(np.diff(at) == half) > 1 else speeds


def _glitch(seen: Seen, name: str, channel: str, samples: np.ndarray) -> Glitch:
    """Return the samples of one channel with what is at the first of them."""
    r = next(r for r in seen.campaign.records if r.name == name)
    x, k = r.channels[channel], int(samples[0])
    beside = float(_mended(x, samples)[k])
    where = (float(r.time[k]), float(x[k]), beside)
    return Glitch(name, channel, r.units[channel], tuple(samples.tolist()), *where, channel == seen.drive)

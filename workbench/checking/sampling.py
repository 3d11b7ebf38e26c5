"""Rates and lengths: of the log against the bandwidth, of the encoder against the presliding stroke."""

from collections.abc import Iterator
from dataclasses import dataclass

from workbench.checking.seen import Seen
from workbench.definition import Effect
from workbench.motion import MOTION_BAND, trimmed

PERIODS = 20  # of the bandwidth that a record must last
SHORTEST = 0.5  # s: a record must be longer than what is trimmed and reflected at its ends
FINE = 5  # counts within the stroke over which friction builds up


@dataclass(frozen=True)
class Slow:
    """A record sampled at `rate`, where a bandwidth needs another one; that rate would do for the bandwidth `enough`. All Hz."""

    record: str
    rate: float
    bandwidth: float
    needed: float
    enough: float


@dataclass(frozen=True)
class Short:
    """A record of `seconds` at `rate` Hz, where a bandwidth in Hz needs more of them."""

    record: str
    seconds: float
    rate: float
    bandwidth: float
    needed: float


@dataclass(frozen=True, eq=False)
class Coarse:
    """Friction that builds up over `stroke`, which its encoder resolves by `resolution`, both in `unit`: too few counts."""

    effect: Effect
    channel: str
    stroke: float
    resolution: float
    unit: str


def rates(seen: Seen) -> Iterator[Slow]:
    """Yield which records are sampled too slowly for the bandwidth: the motion's low pass lies at twice of it."""
    bandwidth = seen.campaign.bandwidth
    need = 2 * MOTION_BAND * bandwidth
    for r in seen.campaign.records:
        if 1.0 / r.dt < need * (1 - 1e-9):
            yield Slow(r.name, 1.0 / r.dt, bandwidth, need, 1 / r.dt / (2 * MOTION_BAND))


def lengths(seen: Seen) -> Iterator[Short]:
    """Yield which records are too short for their bandwidth, as a clock in the wrong unit makes them."""
    need = max(SHORTEST, PERIODS / seen.campaign.bandwidth + 2 * trimmed(seen.campaign.bandwidth))
    for r in seen.campaign.records:
        lasts = float(r.time[-1] - max(r.time[0], r.counts_from))
        if lasts < need:
            yield Short(r.name, lasts, 1.0 / r.dt, seen.campaign.bandwidth, need)


def strokes(seen: Seen) -> Iterator[Coarse]:
    """Yield where an encoder is too coarse for the stroke over which declared friction builds up."""
    for e in seen.campaign.plant.effects:
        stroke = next((p for p in e.parameters.values() if p.scale == "stroke"), None)
        channel = "load_position" if e.at == "load" else "position"
        steps = [r.resolution[channel] for r in seen.campaign.records if r.resolution.get(channel)]
        if stroke is not None and steps and stroke.value < FINE * max(steps):
            yield Coarse(e, channel, stroke.value, max(steps), seen.campaign.plant.displacement)

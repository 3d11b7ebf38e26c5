"""Rates and lengths: of the log against the bandwidth, of the encoder against the presliding stroke."""

from collections.abc import Iterator

from workbench.checking.seen import Seen
from workbench.finding import ENCODER_RESOLUTION, SAMPLING_RATE, Finding
from workbench.motion import MOTION_BAND, TRIM

PERIODS = 20  # of the bandwidth that a record must last
SHORTEST = 0.5  # s: a record must be longer than what is trimmed and reflected at its ends
FINE = 5  # counts within the stroke over which friction builds up


def rates(seen: Seen) -> Iterator[Finding]:
    """Say which records are sampled too slowly for the bandwidth: the motion's low pass lies at twice of it."""
    need = 2 * MOTION_BAND * seen.campaign.bandwidth
    for r in seen.campaign.records:
        if 1.0 / r.dt < need * (1 - 1e-9):
            yield Finding(
                SAMPLING_RATE, f"{r.name}.time",
                f"Record '{r.name}' is sampled at {1 / r.dt:.4g} Hz; an evaluation bandwidth of "
                f"{seen.campaign.bandwidth:g} Hz needs {need:g} Hz, since motion is filtered at twice the bandwidth.",
                {"rate": 1.0 / r.dt, "needed": need},
                f"Log faster, or set evaluation_bandwidth to {1 / r.dt / (2 * MOTION_BAND):.3g} Hz.",
            )  # fmt: skip


def lengths(seen: Seen) -> Iterator[Finding]:
    """Say which records are too short for their bandwidth, as a clock in the wrong unit makes them."""
    need = max(SHORTEST, PERIODS / seen.campaign.bandwidth + 2 * TRIM)
    for r in seen.campaign.records:
        lasts = float(r.time[-1] - max(r.time[0], r.counts_from))
        if lasts < need:
            yield Finding(
                SAMPLING_RATE, f"{r.name}.time",
                f"Record '{r.name}' lasts {lasts:.3g} s at {1 / r.dt:.4g} Hz; {need:.3g} s are needed to see "
                f"{seen.campaign.bandwidth:g} Hz.",
                {"seconds": lasts, "rate": 1.0 / r.dt},
                "Check the unit of the time channel; else record for longer.",
            )  # fmt: skip


def strokes(seen: Seen) -> Iterator[Finding]:
    """Say where an encoder is too coarse for the stroke over which declared friction builds up."""
    for e in seen.campaign.plant.effects:
        stroke = next((p for p in e.parameters.values() if p.scale == "stroke"), None)
        channel = "load_position" if e.at == "load" else "position"
        steps = [r.resolution[channel] for r in seen.campaign.records if r.resolution.get(channel)]
        if stroke is not None and steps and stroke.value < FINE * max(steps):
            x = seen.campaign.plant.displacement
            yield Finding(
                ENCODER_RESOLUTION, e.key,
                f"{e.name} at {e.at} builds up over {stroke.value:.3g} {x}, which is {stroke.value / max(steps):.2g} counts of "
                f"{channel}; {FINE} are needed to see it.",
                {"stroke": stroke.value, "resolution": max(steps)},
                "Use the finer encoder, interpolate it, or declare coulomb_friction in its place.",
            )  # fmt: skip

"""All checks of a campaign, in stages: what a stage finds is left out of the next, which would see nonsense."""

from collections.abc import Collection, Iterable
from dataclasses import replace
from pathlib import Path

from workbench.campaign import Campaign, load
from workbench.checking import alignment, channels, clocks, excitation, modes, sampling, scale, sign
from workbench.checking.glitches import impossible
from workbench.checking.lost import losing
from workbench.checking.seen import Seen
from workbench.checking.wording import DROPPED, UNREADABLE, resampled, said
from workbench.errors import UnsoundRecord
from workbench.finding import (
    ASSUMED_SCALE,
    CUT,
    ENCODER_RESOLUTION,
    GLITCH,
    JITTER,
    OTHER_UNIT,
    RESAMPLED,
    SAMPLING_RATE,
    START_TIME,
    Finding,
)
from workbench.threads import one_thread

# What reading itself finds, and which findings leave the records fit for use.
CARRIED = (START_TIME, OTHER_UNIT, ASSUMED_SCALE)
HARMLESS = (GLITCH, JITTER, OTHER_UNIT, ASSUMED_SCALE, SAMPLING_RATE, ENCODER_RESOLUTION)
# (check, whether the records of what it yields are left out of the next): a late drive is put right instead
STAGES = (
    (scale.encoders, True),
    (channels.unsound, True),
    (alignment.apart, True),
    (clocks.skewed, True),
    (alignment.ahead, True),
    (alignment.misaligned, False),
    (sign.signs, True),
    (scale.drives, True),
)


@one_thread
def check(campaign: Campaign | Path) -> tuple[Finding, ...]:
    """Return what is wrong with the records of a campaign, or of its folder; an empty tuple where nothing is.

    Raises WorkbenchError where the campaign cannot be read; what keeps a record from being used is a finding.
    """
    try:
        seen = Seen(campaign if isinstance(campaign, Campaign) else load(campaign, resample=True))
    except UnsoundRecord as e:
        return (Finding(e.kind, e.record, str(e), {}, UNREADABLE),)
    names = {r.name for r in seen.campaign.records}
    found = [f for f in seen.campaign.findings if f.kind in CARRIED]
    if short := [said(f) for f in sampling.lengths(seen)]:
        return _gathered((*found, *short), names)  # nothing can be computed of such records
    found += [replace(f, kind=DROPPED) for f in seen.campaign.findings if f.kind == CUT]
    found += [resampled(f) for f in seen.campaign.findings if f.kind == RESAMPLED]
    found += [said(f) for f in (*sampling.rates(seen), *sampling.strokes(seen))]
    glitches, seen = impossible(seen)
    lost, seen = losing(seen)
    found += [*map(said, glitches), *([said(lost)] if lost else []), *_faults(seen)]
    if all(f.kind in HARMLESS for f in found):
        found += [said(f) for f in (*excitation.missing(seen), *modes.undeclared(seen))]
    return _gathered(found, names)


def _faults(seen: Seen) -> list[Finding]:
    """Return what is wrong with channels, time axes, signs and scales."""
    found: list[Finding] = []
    for look, leaves_out in STAGES:
        if not seen.campaign.records:
            break
        here = [said(fault) for fault in look(seen)]
        found += here
        seen = _without(seen, here) if leaves_out else seen
    return found


def _without(seen: Seen, found: Iterable[Finding]) -> Seen:
    """Return this without the records that findings are about."""
    return seen.only({r.name for r in seen.campaign.records} - {f.subject.split(".")[0] for f in found})


def _gathered(found: Iterable[Finding], records: Collection[str]) -> tuple[Finding, ...]:
    """Return one finding where several records have the same: subjects are "record.channel", or parameters."""
    same: dict[tuple[str, str], list[Finding]] = {}
    for f in found:
        record, _, channel = f.subject.partition(".")
        same.setdefault((f.kind, channel if record in records else f.subject), []).append(f)
    return tuple(_one(group) for group in same.values())


def _one(group: list[Finding]) -> Finding:
    first, *others = group
    if not others:
        return first
    names = " and ".join(f"'{f.subject.split('.')[0]}'" for f in others)
    return replace(first, sentence=f"{first.sentence} So it is in {names}.")

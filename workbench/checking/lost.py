"""Counts that an encoder loses; the other checks see the records with them put back."""

from dataclasses import replace

from workbench.checking.seen import Seen
from workbench.encoders.lost_counts import LostCounts, lost_counts


def losing(seen: Seen) -> tuple[LostCounts | None, Seen]:
    """Return the counts that an encoder lost, None where none does, and the campaign with them put back. Only samples that were logged bear witness."""
    lost = lost_counts(seen.measured)
    if lost is None:
        return None, seen
    records = tuple(lost.mended(r) for r in seen.campaign.records)
    return lost, Seen(replace(seen.campaign, records=records))

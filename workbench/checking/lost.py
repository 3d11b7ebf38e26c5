"""Counts that an encoder loses; the other checks see the records with them put back."""

from dataclasses import replace

from workbench.checking.seen import Seen
from workbench.encoders.lost_counts import lost_counts
from workbench.encoders.lost_finding import lost_finding
from workbench.finding import Finding


def losing(seen: Seen) -> tuple[tuple[Finding, ...], Seen]:
    """Return what is said of lost counts, and the campaign with them put back. Only samples that were logged bear witness."""
    lost = lost_counts(seen.measured)
    if lost is None:
        return (), seen
    records = tuple(lost.mended(r) for r in seen.campaign.records)
    return (lost_finding(lost),), Seen(replace(seen.campaign, records=records))

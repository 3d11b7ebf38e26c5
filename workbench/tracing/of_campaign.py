"""The trace of a campaign: from its records as read to what its declared plant lacks, and where the residual lives."""

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.campaign import Campaign
from workbench.finding import Finding
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.residual.residual_maps import ResidualMaps, map_residual
from workbench.tracing.judge import Progress
from workbench.tracing.result import Trace
from workbench.tracing.tracing import trace


@dataclass(frozen=True, eq=False)
class CampaignTrace:
    """campaign: as read. trace: of its declared plant. residual_maps: what is left before and after, against all that it may follow."""

    campaign: Campaign
    trace: Trace
    residual_maps: tuple[ResidualMaps, ...]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Of the records, of the search, and of the last fit."""
        return (*self.campaign.findings, *self.trace.findings, *self.trace.after.findings)


def trace_campaign(campaign: Campaign, progress: Progress = lambda _: None) -> Trace:
    """Trace what the declared plant of a campaign lacks."""
    return trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth), progress)


def trace_and_map(
    campaign: Campaign, progress: Progress = lambda _: None, inverses: Sequence[InverseDynamics] | None = None
) -> CampaignTrace:
    """Trace what the declared plant of a campaign lacks, and map what is left. inverses: of its records, where they are there already."""
    if inverses is None:
        inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    found = trace(campaign.plant, inverses, progress)
    return CampaignTrace(campaign, found, map_residual(inverses, found.before, found.extended))

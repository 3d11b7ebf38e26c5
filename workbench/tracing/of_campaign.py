"""The trace of a campaign: from its records as read to what its declared plant lacks."""

from workbench.campaign import Campaign
from workbench.inverse.dynamics import inverse_dynamics
from workbench.tracing.judge import Progress
from workbench.tracing.result import Trace
from workbench.tracing.tracing import trace


def trace_campaign(campaign: Campaign, progress: Progress = lambda _: None) -> Trace:
    """Trace what the declared plant of a campaign lacks."""
    return trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth), progress)

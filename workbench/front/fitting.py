"""From records to a model: check, identify, trace, diff."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path

from workbench import difference
from workbench.campaign import Campaign
from workbench.checking import checking
from workbench.definition import Effect
from workbench.finding import Finding
from workbench.front.given import Measured, campaign_of, plant_of
from workbench.identification import fit as fitting
from workbench.identification.result import Fit
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import freed
from workbench.record import Record
from workbench.tracing import tracing
from workbench.tracing.budget import BUDGET, Budget
from workbench.tracing.criteria import Criteria
from workbench.tracing.result import Trace

Say = Callable[[str], None]


def check(campaign: Campaign | str | Path) -> tuple[Finding, ...]:
    """Return what is wrong with the records of a campaign, or of its folder; an empty tuple where nothing is.

    Signs, scales, rates, clipped and frozen channels, shifted time axes, missing excitation; each a Finding with a sentence
    and a remedy. Raises WorkbenchError where a folder cannot be read.
    """
    return checking.check(Path(campaign) if isinstance(campaign, str) else campaign)


def identify(
    model: Measured, records: Record | Sequence[Record] | None = None, *, bandwidth: float | None = None
) -> Fit:
    """Fit a plant's free parameters to records by its inverse dynamics, with 95 % intervals.

        min over c, theta of |F(u - Phi(theta) c)|^2,   F: zero-phase low pass 1/(1 + (f/bandwidth)^8)

    model: a campaign or its folder; or a Plant (a Fit, a Trace), with `records` and `bandwidth` in Hz. Records of role
    "identification" are fitted, all are predicted. Of the Fit, errors are rms of the residual over rms of the drive.
    Raises WorkbenchError for records that are not sound, and where the model has no value on them.
    """
    campaign = campaign_of(model, records, bandwidth)
    found = fitting.identify(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth))
    return replace(found, records=campaign.records, bandwidth=campaign.bandwidth)


def trace(
    model: Measured,
    records: Record | Sequence[Record] | None = None,
    *,
    bandwidth: float | None = None,
    most: int | None = None,
    only: Collection[str] | None = None,
    own: Collection[Effect] = (),
    criteria: Criteria | None = None,
    budget: Budget | None = None,
    progress: Say | None = None,
) -> Trace:
    """Find what a model lacks: every effect of the catalogue is tried jointly with it on what it leaves of the records.

    model, records, bandwidth: as of `identify`; a Fit has its records with it. most: effects added at most. only: names of
    the effects that are tried. own: effects that are tried beside those of the catalogue. criteria: what decides
    (workbench.tracing.criteria). budget: of the search (workbench.tracing.budget). progress: called with a line now and then.

    Of the Trace: `verdict` is "cause", "nothing_missing" or "unknown", `sentence` says it, `causes` and `findings` hold it
    with numbers, `plant` is the extended one. Validation records choose no effect; they bear it out. Errors as of `identify`.
    """
    campaign = campaign_of(model, records, bandwidth)
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    say = progress or (lambda _: None)
    found = tracing.trace(campaign.plant, inverses, say, most, only, own, criteria or Criteria(), budget or BUDGET)
    measured = {"records": campaign.records, "bandwidth": campaign.bandwidth}
    return replace(found, before=replace(found.before, **measured), after=replace(found.after, **measured))


def diff(before: Measured, after: Measured) -> difference.Difference:
    """Return which parameters moved between two campaigns of one axis (folders, campaigns or fits) beyond their intervals.

    The model of `before` is fitted to both with every value free. A parameter moved where |b - a|/sqrt(s_a^2 + s_b^2) is
    beyond Student's quantile, corrected for the number of parameters (Holm). `findings` say where the records are not alike.
    Raises WorkbenchError for campaigns that declare different models.
    """
    first, second = campaign_of(before), campaign_of(after)
    difference.check_models(first, second)
    bandwidth = min(first.bandwidth, second.bandwidth)
    inverses = [inverse_dynamics(c.records, bandwidth) for c in (first, second)]
    found = difference.compare(freed(plant_of(first)), *inverses)
    return replace(found, findings=difference.doubts(first, second, *inverses))

"""The steps that every study of a campaign takes: read, trace, describe."""

from collections.abc import Callable

import numpy as np

from workbench.campaign import Campaign, load
from workbench.description import described
from workbench.errors import WorkbenchError
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.residual.residual_maps import map_residual
from workbench.study.configuration import Study
from workbench.study.outcome import Outcome
from workbench.tracing.result import Trace
from workbench.tracing.tracing import trace

Say = Callable[[str], None]


def trace_campaign(campaign: Campaign, say: Say = lambda _: None) -> Trace:
    """Trace what the declared plant of a campaign lacks."""
    return trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth), say)


def trace_figures(found: Trace) -> dict[str, float | str]:
    """Return the figures of a trace by which a study is judged."""
    return {
        "verdict": found.verdict,
        "first_cause": found.ranked[0].effect if found.causes else "none",
        "added": ", ".join(sorted(found.added)) or "none",  # which was found first says nothing
        "identification_error_before": found.before.identification,
        "identification_error_after": found.after.identification,
        "identification_floor": found.floor[IDENTIFICATION],
        "validation_error_before": found.before.validation,
        "validation_error_after": found.after.validation,
        "validation_floor": found.floor[VALIDATION],
    }


def amplitudes(study: Study) -> np.ndarray:
    """Return the amplitudes of a study, even in the logarithm; WorkbenchError where it states none."""
    if study.describe is None:
        raise WorkbenchError(f"{study.table.path('describe')}: state lowest, highest and count of the amplitudes.")
    lowest, highest, count = study.describe
    return np.geomspace(lowest, highest, count)


def early(check: Callable[[Plant], None], plant: Plant, say: Say) -> None:
    """Say at the start what a run will not come to; it is a finding of the outcome, too."""
    try:
        check(plant)
    except WorkbenchError as e:
        getattr(say, "plainly", say)(f"No gains will be tuned: {e}")


def run(study: Study, say: Say) -> Outcome:
    """Read the campaign, trace its residual, and describe the extended plant over amplitude."""
    if study.campaign is None:
        raise WorkbenchError(
            f"{study.table.path('campaign')}: name the campaign's folder, or add a study.py with steps."
        )
    say("reading the campaign")
    campaign = load(study.campaign)
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    shown = None
    if "task" in study.table:
        from workbench.design.possible import check_plant
        from workbench.study.control import control_of
        from workbench.study.gains import with_control
        from workbench.verification.assumed import shown_by

        shown = shown_by(campaign.plant, inverses)
        early(check_plant, campaign.plant, say)
        asked = control_of(study.table, campaign.plant, shown)  # what is misspelt is said before anything long starts
        if "drive" in study.table:
            from workbench.study.drive import stated

            stated(study.table, campaign.plant, asked.loop.count)
    found = trace(campaign.plant, inverses, say)
    say("describing the plant over amplitude")
    equivalents = described(found.after.plant, amplitudes(study)) if study.describe else ()
    outcome = Outcome(
        plant=campaign.plant,
        campaign=campaign.title,
        bandwidth=campaign.bandwidth,
        trace=found,
        records=campaign.records,
        equivalents=equivalents,
        residual_maps=map_residual(inverses, found.before, found.extended),
        figures=trace_figures(found),
        findings=(*campaign.findings, *found.findings, *found.after.findings),
    )
    return with_control(outcome, study, shown, say) if shown else outcome

"""The steps that every study of a campaign takes: read, trace, describe, and, where it has a [task], tune."""

from collections.abc import Callable

import numpy as np

from workbench.campaign import load
from workbench.description import described
from workbench.errors import WorkbenchError
from workbench.inverse.dynamics import inverse_dynamics
from workbench.residual.residual_maps import map_residual
from workbench.study.configuration import Study
from workbench.study.outcome import Outcome
from workbench.tracing.tracing import trace


def amplitudes(study: Study) -> np.ndarray:
    """Return the amplitudes of a study, even in the logarithm; WorkbenchError where it states none."""
    if study.describe is None:
        raise WorkbenchError(f"{study.table.path('describe')}: state lowest, highest and count of the amplitudes.")
    lowest, highest, count = study.describe
    return np.geomspace(lowest, highest, count)


def run(study: Study, say: Callable[[str], None]) -> Outcome:
    """Read the campaign, trace its residual, describe the extended plant over amplitude, and tune where a [task] says for what."""
    if study.campaign is None:
        raise WorkbenchError(
            f"{study.table.path('campaign')}: name the campaign's folder, or add a study.py with steps."
        )
    say("reading the campaign")
    campaign = load(study.campaign)
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    shown = None
    if "task" in study.table:
        from workbench.study.gains import asked_first, with_control

        shown = asked_first(study, campaign.plant, inverses, say)
    found = trace(campaign.plant, inverses, say)
    maps = map_residual(inverses, found.before, found.extended)
    say("describing the plant over amplitude")
    outcome = Outcome(
        plant=campaign.plant,
        campaign=campaign.title,
        bandwidth=campaign.bandwidth,
        trace=found,
        records=campaign.records,
        equivalents=described(found.plant, amplitudes(study)) if study.describe else (),
        residual_maps=maps,
        figures=found.figures,
        findings=(*campaign.findings, *found.every_finding),
    )
    return with_control(outcome, study, shown, say) if shown else outcome

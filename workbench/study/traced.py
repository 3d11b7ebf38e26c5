"""`workbench trace`: a campaign's trace with its page, written whole."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from workbench.campaign import FILE as CAMPAIGN
from workbench.campaign import Campaign
from workbench.errors import WorkbenchError
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.outputs import replaceable, whole
from workbench.report import write as write_page
from workbench.report.closed_loop import absent, heading
from workbench.report.closed_loop import closing as closing_chapter
from workbench.report.contents import Recorded, StudyResult
from workbench.residual.residual_maps import as_list, load_as_dict, map_residual
from workbench.tracing.calibration import as_dict, calibrations, finding
from workbench.tracing.output import write
from workbench.tracing.result import Trace
from workbench.tracing.tracing import trace
from workbench.verification.closed_loop import ClosedLoop
from workbench.verification.closed_loop import as_dict as loop_as_dict
from workbench.verification.closing import closed_loop

Say = Callable[[str], None]

FILE = "trace.json"
FOLDER = "campaign"  # a study's records, by whose name nobody knows them: the study's stands for it
QUESTION = "Does the declared model lack an effect, and if so, which, where does it show, and what is it worth?"


def run(campaign: Campaign, out: Path, say: Say = lambda _: None, closing: bool = True) -> Trace:
    """Trace a campaign and write trace.json, predictions, trace.html and trace.pdf into `out`, whole or not at all.

    closing: whether the loop is closed with what was found, in simulation.
    """
    if (out / CAMPAIGN).exists():
        raise WorkbenchError(
            f"{out} holds a {CAMPAIGN}; name another folder to write into, a campaign is not replaced."
        )
    replaceable(out, FILE)
    passes = inverse_dynamics(campaign.records, campaign.bandwidth)
    found = trace(campaign.plant, passes, say)
    phases = calibrations(passes, found)
    found = replace(found, findings=(*found.findings, *map(finding, phases)))
    closed = closed_loop(campaign, found, say) if closing and found.causes else None
    say("writing the page")
    result = _page(campaign, passes, found, closed)
    more = {
        "nrmse_load": load_as_dict(result.residual_maps),
        "where": as_list(result.residual_maps),
        "calibrations": [as_dict(c) for c in phases],
        "closed_loop": {"missing": closed} if isinstance(closed, str) else closed and loop_as_dict(closed),
    }
    with whole(out, FILE) as beside:
        write(found, beside, more)
        write_page(result, beside, "trace")
    return found


def _page(
    campaign: Campaign, passes: Sequence[InverseDynamics], found: Trace, closed: ClosedLoop | str | None = None
) -> StudyResult:
    """Return what the page of a trace is made of. closed: the loop, a sentence why there is none, or None."""
    chapters = ()
    if closed is not None:
        chapters = (absent(closed) if isinstance(closed, str) else closing_chapter(found, closed),)
    folder = campaign.folder.resolve()
    return StudyResult(
        name=folder.parent.name if folder.name == FOLDER else folder.name,
        title=campaign.title,
        question=QUESTION,
        campaign=campaign.title,
        records=tuple(map(Recorded.of, campaign.records)),
        plant=campaign.plant,
        bandwidth=campaign.bandwidth,
        trace=found,
        findings=(*campaign.findings, *found.findings, *found.after.findings),
        chapters=chapters,
        residual_maps=map_residual(passes, found.before, found.extended),
        kind="Trace of campaign",
        command=f"workbench trace {f'{folder.parent.name}/{FOLDER}' if folder.name == FOLDER else folder.name}",
        answer=f"{heading(found, closed)}." if isinstance(closed, ClosedLoop) else "",
    )

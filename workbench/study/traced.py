"""`workbench trace`: a campaign's trace with its page, written whole."""

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path

from workbench.campaign import FILE as CAMPAIGN
from workbench.campaign import Campaign, load
from workbench.errors import WorkbenchError
from workbench.inverse.dynamics import inverse_dynamics
from workbench.outputs import replaceable, whole
from workbench.processes import begun
from workbench.report import drawn
from workbench.report import write as write_page
from workbench.report.contents import Recorded, StudyResult
from workbench.residual.residual_maps import ResidualMaps, map_residual
from workbench.study.configuration import campaign_of
from workbench.tracing.output import write
from workbench.tracing.result import Trace
from workbench.tracing.tracing import trace
from workbench.verification.closed_loop import ClosedLoop
from workbench.verification.closing import as_dict as loop_as_dict
from workbench.verification.closing import closed_loop, lacking, record_of

Say = Callable[[str], None]

FILE = "trace.json"
FOLDER = "campaign"  # a study's records, by whose name nobody knows them: the study's stands for it
QUESTION = "Does the declared model lack an effect, and if so, which, where does it show, and what is it worth?"


def run(
    campaign: Campaign | str, out: Path, say: Say = lambda _: None, *, closing: bool = True, resample: bool = False
) -> tuple[Campaign, Trace]:
    """Trace a campaign and write trace.json, predictions, trace.html and trace.pdf into `out`, whole or not at all.

    campaign: or its folder, or a study of one by path or name. closing: whether the loop is closed with what was found, in
    simulation. resample: as of `load`. Returns the campaign as read, and its trace.
    """
    folder = campaign_of(campaign) if isinstance(campaign, str) else None
    if (out / CAMPAIGN).exists():
        raise WorkbenchError(
            f"{out} holds a {CAMPAIGN}; name another folder to write into, a campaign is not replaced."
        )
    replaceable(out, FILE)
    campaign = load(folder, resample=resample) if folder else campaign
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    found = trace(campaign.plant, inverses, say)
    page = _page(campaign, found, map_residual(inverses, found.before, found.extended))
    loop = nullcontext(lambda: (None, {}))
    if closing and found.causes:
        if not lacking(campaign.plant, record_of(campaign)):
            say("closing the loop")
        loop = begun(partial(_closed, campaign, page))
    with loop as closed, whole(out, FILE) as beside:
        say("writing the page")
        figures = drawn(page)  # while the loop is closed
        of_page, of_loop = closed()
        write(found, beside, page.residual_maps, {"closed_loop": loop_as_dict(of_page)})
        write_page(replace(page, closed=of_page), beside, "trace", figures | of_loop)  # which carries trace.json
    return campaign, found


def _closed(campaign: Campaign, page: StudyResult) -> tuple[ClosedLoop | str, dict[str, bytes]]:
    """Return the loop closed with what a page's trace found, and what is drawn of it."""
    closed = closed_loop(campaign, page.trace)
    return closed, drawn(replace(page, closed=closed), beside=page)


def _page(campaign: Campaign, found: Trace, maps: tuple[ResidualMaps, ...]) -> StudyResult:
    """Return what the page of a trace is made of, the loop aside."""
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
        findings=(*campaign.findings, *found.every_finding),
        residual_maps=maps,
        kind="Trace of campaign",
        command=f"workbench trace {f'{folder.parent.name}/{FOLDER}' if folder.name == FOLDER else folder.name}",
    )

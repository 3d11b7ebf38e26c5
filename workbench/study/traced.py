"""`workbench trace`: a campaign's trace with its page, written whole."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from workbench.campaign import Campaign
from workbench.identify.fit import passes_of
from workbench.identify.passes import Passes
from workbench.outputs import whole
from workbench.report import write as write_page
from workbench.report.contents import Recorded, StudyResult
from workbench.trace.calibration import as_dict, calibrations, finding
from workbench.trace.output import write
from workbench.trace.result import Trace
from workbench.trace.tracing import trace
from workbench.trace.where import as_list, where

QUESTION = "Does the declared model lack an effect, and if so, which, where does it show, and what is it worth?"


def run(campaign: Campaign, out: Path, say: Callable[[str], None] = lambda _: None) -> Trace:
    """Trace a campaign and write trace.json, predictions, trace.html and trace.pdf into `out`, whole or not at all."""
    passes = passes_of(campaign.records, campaign.bandwidth)
    found = trace(campaign.plant, passes, say)
    phases = calibrations(passes, found)
    found = replace(found, findings=(*found.findings, *map(finding, phases)))
    say("writing the page")
    result = page(campaign, passes, found)
    more = {"where": as_list(result.where), "calibrations": [as_dict(c) for c in phases]}
    with whole(out, "trace.json") as beside:
        write(found, beside, more)
        write_page(result, beside, "trace")
    return found


def page(campaign: Campaign, passes: Sequence[Passes], found: Trace) -> StudyResult:
    """Return what the page of a trace is made of."""
    return StudyResult(
        name=campaign.folder.resolve().name,
        title=campaign.title,
        question=QUESTION,
        campaign=campaign.title,
        records=tuple(map(Recorded.of, campaign.records)),
        plant=campaign.plant,
        bandwidth=campaign.bandwidth,
        trace=found,
        findings=(*campaign.findings, *found.findings, *found.after.findings),
        where=where(passes, found),
        kind="Trace of campaign",
    )

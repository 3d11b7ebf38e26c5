"""`workbench trace`: find what the declared model of a campaign lacks."""

import argparse
from pathlib import Path

from workbench.verbs.progress import Progress


def declare(verbs) -> None:
    trace = verbs.add_parser(
        "trace",
        help="find what a campaign's declared model lacks",
        description="Find what the declared model of a campaign lacks, and write trace.json and predictions.",
    )
    trace.add_argument("folder", type=Path, help="the campaign: a folder with campaign.toml and its records")
    trace.add_argument("--out", type=Path, required=True, help="folder to write into")
    trace.add_argument("--resample", action="store_true", help="interpolate records whose time steps are uneven")


def do(given: argparse.Namespace) -> int:
    from workbench.campaign import load
    from workbench.outputs import whole
    from workbench.study.standard import trace_campaign
    from workbench.trace.output import write

    campaign = load(given.folder, resample=given.resample)
    found = trace_campaign(campaign, Progress())
    with whole(given.out, "trace.json") as beside:
        write(found, beside)
    print(found.sentence)
    for finding in (*campaign.findings, *found.findings):
        print(f"- {finding.sentence}")
    print(f"\n{given.out / 'trace.json'}")
    return 0

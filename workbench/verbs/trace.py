"""`workbench trace`: find what the declared model of a campaign lacks."""

import argparse
from pathlib import Path

from workbench.verbs.progress import Progress


def declare(verbs) -> None:
    trace = verbs.add_parser(
        "trace",
        help="find what a campaign's declared model lacks",
        description="Find what the declared model of a campaign lacks, and write trace.json, predictions, trace.html and trace.pdf.",
    )
    trace.add_argument("campaign", help="a folder with campaign.toml and its records, or a study of one")
    trace.add_argument("--out", type=Path, required=True, help="folder to write into")
    trace.add_argument(
        "--no-close", action="store_true", help="do not tune and simulate a loop without and with what was found"
    )
    trace.add_argument("--resample", action="store_true", help="interpolate records whose time steps are uneven")


def do(given: argparse.Namespace) -> int:
    from workbench.study.traced import run

    with Progress("trace", given.campaign) as say:
        campaign, found = run(given.campaign, given.out, say, closing=not given.no_close, resample=given.resample)
    print(found.sentence)
    for finding in (*campaign.findings, *found.findings):
        print(f"- {finding.sentence}")
    print()
    for name in ("trace.json", "trace.html", "trace.pdf"):
        print(given.out / name)
    return 0

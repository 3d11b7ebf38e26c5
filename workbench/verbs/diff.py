"""`workbench diff`: what changed between two campaigns of one axis."""

import argparse
from pathlib import Path

from workbench.verbs.progress import Progress


def declare(verbs) -> None:
    diff = verbs.add_parser(
        "diff",
        help="say what changed between two campaigns of one axis",
        description="Fit the same model to two campaigns of one axis (before and after a repair, cold and warm), and say "
        "which parameters moved beyond their intervals.",
    )
    diff.add_argument("before", help="a campaign (a folder with campaign.toml and its records), or a study of one")
    diff.add_argument("after", help="the campaign to compare it with")
    diff.add_argument("--out", type=Path, help="folder to write diff.json into")


def do(given: argparse.Namespace) -> int:
    from workbench.campaign import load
    from workbench.difference.output import JSON, write
    from workbench.front.fitting import diff
    from workbench.outputs import replaceable, whole
    from workbench.study.configuration import campaign_of

    if given.out:
        replaceable(given.out, JSON)
    before, after = (load(campaign_of(name)) for name in (given.before, given.after))
    with Progress() as say:
        say("fitting both campaigns")
        found = diff(before, after)
    if given.out:
        with whole(given.out, JSON) as beside:
            write(beside, before.title, after.title, found)
    print(found.sentence)
    for c in sorted(found.changes, key=lambda c: not c.moved):
        print(f"- {c.sentence}")
    for name in found.undetermined:
        print(f"- {name} is not determined by one of the campaigns, and not compared.")
    for f in found.findings:
        print(f"- {f.sentence}")
    return 0

"""`workbench check`: what is wrong with the records of a study or campaign, before anything long starts."""

import argparse

from workbench.verbs import NOT_MET
from workbench.verbs.progress import Progress


def declare(verbs) -> None:
    check = verbs.add_parser(
        "check",
        help="find wrong signs, scales and missing excitation",
        description="Find what is wrong with records before anything long starts: signs, scales, rates, clipped and frozen "
        "channels, dropped samples, shifted channels, missing excitation. The exit code is 1 where something is found.",
    )
    check.add_argument("study", help="a study's folder or name, or the folder of a campaign")


def do(given: argparse.Namespace) -> int:
    from workbench.checking.checking import check
    from workbench.study.configuration import campaign_of

    folder = campaign_of(given.study)
    with Progress() as say:
        say("looking at the records")
        found = check(folder)
    for finding in found:
        print(f"{finding.kind}: {finding.sentence}\n    {finding.remedy}")
    things = "Nothing was found" if not found else f"{len(found)} finding{'s' if len(found) > 1 else ''}"
    print(f"{things} in the records of {folder}.")
    return NOT_MET if found else 0

"""`workbench response`: the frequency response of a campaign's record, its modes, and a notch for each."""

import argparse
from pathlib import Path

from workbench.verbs.progress import Progress


def declare(verbs) -> None:
    response = verbs.add_parser(
        "response",
        help="find the modes of an axis from its frequency response",
        description="Estimate the frequency response, drive to acceleration, from a record of a multisine or of noise; fit "
        "its modes and propose notches; write response.csv, response.json and response.svg.",
    )
    response.add_argument("campaign", help="a folder with campaign.toml and its records, or a study of one")
    response.add_argument("--out", type=Path, required=True, help="folder to write into")
    response.add_argument(
        "--record", metavar="NAME", help="which record; the one whose drive shakes most evenly where absent"
    )
    response.add_argument(
        "--channel", default="position", help="whose motion: position (where absent) or load_position"
    )


def do(given: argparse.Namespace) -> int:
    from workbench.campaign import load
    from workbench.frequency.output import JSON, write
    from workbench.frequency.wording import findings
    from workbench.front.motions import response as response_of
    from workbench.outputs import replaceable, whole
    from workbench.report.response import figure
    from workbench.study.configuration import campaign_of

    replaceable(given.out, JSON)
    campaign = load(campaign_of(given.campaign))
    with Progress() as say:
        say("fitting the modes")
        response = response_of(campaign, given.record, channel=given.channel)
        modes = response.modes
    found = findings(response, modes)
    unit = "rad/s²/(N·m)" if campaign.plant.rotary else "m/s²/N"
    with whole(given.out, JSON) as beside:
        write(beside, response, modes, campaign.plant.rotary)
        (beside / "response.svg").write_bytes(figure(found[0].sentence, response, modes, unit))
    averages = f"{response.averages:.0f} {'periods' if response.method == 'periods' else 'averages (Welch)'}"
    print(f"Frequency response of record '{response.record}', {averages}.")
    for f in found:
        print(f"- {f.sentence}")
    print(f"\n{given.out / JSON}")
    return 0

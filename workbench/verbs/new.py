"""`workbench new`: a study from somebody's log files."""

import argparse
import shlex
from pathlib import Path

from workbench.errors import WorkbenchError, nearest

TWO = "Two encoders are two masses: no gains are tuned for them; `workbench trace` closes the loop of a cascade around them."
CHANNELS = ("time", "drive", "position", "reference", "load_position")


def declare(verbs) -> None:
    new = verbs.add_parser(
        "new",
        help="make a study from log files",
        description="Read log files of any supported format, guess channels, units, rate and roles, say why, and write a "
        "study that runs.",
    )
    new.add_argument("name", help="of the study: a folder of this name is made under studies/")
    new.add_argument("--records", type=Path, nargs="+", required=True, metavar="FILE", help="log files of one axis")
    new.add_argument(
        "--channel", action="append", default=[], metavar="CHANNEL=COLUMN",
        help=f"what the data cannot say; channels: {', '.join(CHANNELS)}",
    )  # fmt: skip


def do(given: argparse.Namespace) -> int:
    from workbench.intake.new import new

    place = Path(given.name) if "/" in given.name else Path("studies") / given.name
    made = new(place, given.records, told(given.channel))
    print("\n".join(made.lines))
    print(f"\nWritten: {made.folder}/study.toml and {made.folder}/campaign/campaign.toml")
    if made.edit:
        print(f"To be edited in campaign.toml, from the data sheet: {', '.join(made.edit)}")
    two = any(line.startswith("load_position:") for line in made.lines)
    print(
        TWO
        if two
        else "With actuator_limit stated in campaign.toml, gains are tuned too, for a loop as the records show it."
    )
    name = shlex.quote(given.name)
    print(f"Next: workbench check {name}, then workbench run {name}")
    return 0


def told(pairs: list[str]) -> dict[str, str]:
    """Return channel -> column of "CHANNEL=COLUMN" texts."""
    found = {}
    for pair in pairs:
        channel, equals, column = pair.partition("=")
        if not (equals and column):
            raise WorkbenchError(f"--channel {pair}: name the column, too: --channel {channel}=COLUMN.")
        if channel not in CHANNELS:
            raise WorkbenchError(f"--channel {pair}: there is no channel '{channel}'; {nearest(channel, CHANNELS)}")
        found[channel] = column
    return found

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
    new.add_argument("name", help="of the study, made as studies/NAME; with a '/' in it, the folder itself")
    new.add_argument("--records", type=Path, nargs="+", required=True, metavar="FILE", help="log files of one axis")
    new.add_argument(
        "--channel", action="append", default=[], metavar="CHANNEL=COLUMN",
        help=f"what the data cannot say; channels: {', '.join(CHANNELS)}",
    )  # fmt: skip
    new.add_argument(
        "--axis", default="", metavar="AXIS", help="which one is meant, where the logs hold several: --axis q7"
    )
    new.add_argument("--rate", type=float, metavar="HZ", help="samples a second, where no column is the time")
    new.add_argument(
        "--unit", action="append", default=[], metavar="COLUMN=UNIT", help="of a column whose name does not say it"
    )


def do(given: argparse.Namespace) -> int:
    from workbench.intake.new import new

    if given.name in (".", "..", ""):
        raise WorkbenchError(f"new '{given.name}': name the study, as `workbench new axis --records log.csv`.")
    place = Path(given.name) if "/" in given.name else Path("studies") / given.name
    if given.rate is not None and not 0.0 < given.rate < 1e9:
        raise WorkbenchError(f"--rate {given.rate:g}: samples a second are needed, as 1000 for one each millisecond.")
    units = dict(_pair("unit", "COLUMN", "UNIT", text) for text in given.unit)
    made = new(place, given.records, _told(given.channel), units=units, axis=given.axis, rate=given.rate)
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


def _told(pairs: list[str]) -> dict[str, str]:
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


def _pair(option: str, left: str, right: str, text: str) -> tuple[str, str]:
    column, equals, unit = text.rpartition("=")
    if not (column and unit):
        raise WorkbenchError(f"--{option} {text}: write --{option} {left}={right}.")
    return column, unit

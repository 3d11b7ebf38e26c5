"""[drive] of study.toml: gains for a drive that takes no code, tuned as every other controller, and written as its files.

    [drive]
    formats = ["elmo", "linuxcnc"]                   # sdo, twincat, elmo, odrive, moteus, ros2, linuxcnc
    current_lag = { value = 0.1, unit = "ms" }       # time constant of its current loop
    notches = 2                                      # how many it has, up to 4; 0 where absent
    sets = 16                                        # of gains, up to 16, one a size of move; 1 where absent
    speed_feed_forward = true
    acceleration_feed_forward = true
    counts = 1296000                                 # encoder counts of a turn or a metre
    amps = 4.0                                       # A that one N*m or N takes, where the drive counts current
    integral = "1/s"                                 # unit of Elmo's integral gain
    ranges = { kv = { at_most = 500.0 } }            # what the drive takes, SI

    [[drive.objects]]                                # of sdo and twincat, from the drive's manual
    quantity = "kv"
    index = 0x3000
    subindex = 1
    type = "REAL32"
    per_si = 1.0

Further keys: seed, channel (LinuxCNC), joint (ros2_control).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, pi
from pathlib import Path

from workbench.control.drive import MOST
from workbench.design.design import Designed
from workbench.drive_tuning.comparison import compared_drive
from workbench.drive_tuning.gains import NUMBERS, ClosedDrive
from workbench.drive_tuning.search import STRATEGY, Strategy
from workbench.drives import Units
from workbench.drives.elmo import SETS
from workbench.drives.files import FormatOptions, writer
from workbench.drives.objects import Object
from workbench.drives.tuned import files_of
from workbench.errors import WorkbenchError
from workbench.plant import Plant
from workbench.readers.declaration import Table
from workbench.record import Record
from workbench.report.drive import drive_chapter
from workbench.study import wording
from workbench.study.configuration import Study
from workbench.study.outcome import Part
from workbench.task.task import Task
from workbench.together import write_together

OPTIONAL = (
    "current_lag", "notches", "sets", "speed_feed_forward", "acceleration_feed_forward", "counts", "amps", "integral",
    "ranges", "objects", "seed", "channel", "joint",
)  # fmt: skip
FOLDER = "drive"


@dataclass(frozen=True)
class Stated:
    """What [drive] says. formats: to be written. options: what they need besides the gains."""

    closed: ClosedDrive
    formats: tuple[str, ...]
    options: FormatOptions
    seed: int


def stated(top: Table, plant: Plant, count: float) -> Stated:
    """Return what study.toml says of its drive; WorkbenchError names file and key. count: of the loop's encoder, rad or m."""
    one = top.table("drive", ("formats",), OPTIONAL)
    formats = one.values["formats"]
    if not (isinstance(formats, list) and formats and all(isinstance(f, str) for f in formats)):
        raise WorkbenchError(f'{one.path("formats")} must be a list of formats in quotes, such as ["elmo"].')
    low, high = _ranges(one)
    closed = ClosedDrive(
        lag=one.quantity("current_lag", "s", above=0.0) if "current_lag" in one else 0.0,
        notches=_whole(one, "notches", 0, MOST),
        sets=_whole(one, "sets", 1, SETS),
        speed=one.flag("speed_feed_forward"),
        acceleration=one.flag("acceleration_feed_forward"),
        low=low,
        high=high,
    )
    turn = 2.0 * pi if plant.rotary else 1.0
    units = Units(one.number("counts", turn / count if count else 0.0), one.number("amps", 0.0, above=-1e-300))
    options = FormatOptions(units, _objects(one), one.text("integral", "1/s"), one.text("channel", "pid.x"), one.text("joint", "axis"))  # fmt: skip
    for name in formats:
        try:
            writer(name, (None,), options)
        except WorkbenchError as error:
            raise WorkbenchError(f"{one.path('formats')}: {error}") from error
    return Stated(closed, tuple(dict.fromkeys(formats)), options, int(one.number("seed", 1, above=-1)))


def _whole(one: Table, key: str, default: int, most: int) -> int:
    """Return a whole number from `default` to `most`."""
    value = one.number(key, default)
    if not (default <= value <= most and value == int(value)):
        raise WorkbenchError(f"{one.path(key)} is {value:g}; a whole number from {default} to {most} is needed.")
    return int(value)


def _ranges(one: Table) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return (lowest, highest) of kv, kvp and ki that the drive takes, SI."""
    inner = one.table("ranges", optional=NUMBERS)
    pairs = [inner.table(n, optional=("at_least", "at_most")) for n in NUMBERS]
    low, high = (tuple(p.number(key, other) if key in p else other for p in pairs) for key, other in (("at_least", 0.0), ("at_most", inf)))  # fmt: skip
    for n, least, most in zip(NUMBERS, low, high, strict=True):
        if not 0.0 <= least <= most:
            raise WorkbenchError(f"{inner.path(n)} runs from {least:g} to {most:g}; it has to rise, from 0 or above.")
    return low, high


def _objects(one: Table) -> tuple[Object, ...]:
    """Return [[drive.objects]]."""
    found = []
    for inner in one.tables("objects", "quantity", ("quantity", "index", "subindex", "type"), ("per_si",)):
        try:
            found.append(
                Object(
                    inner.text("quantity"), int(inner.number("index")), int(inner.number("subindex")), inner.text("type"),
                    inner.number("per_si", 1.0),
                )
            )  # fmt: skip
        except WorkbenchError as error:
            raise error if inner.file in str(error) else WorkbenchError(f"{inner.where} {error}") from error
    return tuple(found)


def driven(study: Study, task: Task, made: Designed, records: Sequence[Record], bandwidth: float, rule: str, say, budget: Strategy = STRATEGY) -> Part:  # fmt: skip
    """Tune the drive that a study states, hold it beside the scheduled PD, and write its files."""
    plant, name = task.plant, f"scheduled PD ({rule})"
    given = stated(study.table, plant, task.loop.count)
    say("tuning the closed drive's gains")
    found = compared_drive(
        given.closed, task, made.equivalent, made.gains, made.tuned[name].controller,
        records=records, bandwidth=bandwidth, seed=given.seed, budget=budget,
    )  # fmt: skip
    kept, refused = files_of(found.gains, plant, given.formats, given.options)
    chapter = drive_chapter(found, plant, name, tuple(kept), refused)
    units = dict.fromkeys(("drive_final_error", "drive_following_error"), plant.displacement) | {"drive_step_time": "s"}
    table = found.as_dict | {"files": list(kept), "refused": dict(refused)}

    def write(folder: Path) -> None:
        write_together(folder / FOLDER, {n: t.encode() for n, t in kept.items()})

    return Part(found.figures, units, (chapter,), wording.refused_formats(refused), {"drive": table}, (write,))

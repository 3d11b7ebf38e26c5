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

from workbench.checking.modes import resonances
from workbench.control.drive import MOST
from workbench.design.design import Designed
from workbench.drive_tuning.beside import beside, following
from workbench.drive_tuning.search import NUMBERS, STRATEGY, ClosedDrive, DriveGains, Strategy, tune_drive
from workbench.drives import Cascade, Units
from workbench.drives.elmo import SETS
from workbench.drives.files import Told, files, writer
from workbench.drives.objects import Object
from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.frequency import Response
from workbench.frequency.notch import Notch, notch_for
from workbench.plant import Plant
from workbench.readers.declaration import Table
from workbench.record import Record
from workbench.report.drive import drive_chapter
from workbench.study.configuration import Study
from workbench.study.outcome import Part
from workbench.task.task import Task
from workbench.together import write_together

OPTIONAL = (
    "current_lag", "notches", "sets", "speed_feed_forward", "acceleration_feed_forward", "counts", "amps", "integral",
    "ranges", "objects", "seed", "channel", "joint",
)  # fmt: skip
FOLDER = "drive"
REFUSED = "drive refuses"


@dataclass(frozen=True)
class Stated:
    """What [drive] says. formats: to be written. told: what they need besides the gains."""

    closed: ClosedDrive
    formats: tuple[str, ...]
    told: Told
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
    told = Told(units, _objects(one), one.text("integral", "1/s"), one.text("channel", "pid.x"), one.text("joint", "axis"))  # fmt: skip
    for name in formats:
        try:
            writer(name, (None,), told)
        except WorkbenchError as error:
            raise WorkbenchError(f"{one.path('formats')}: {error}") from error
    return Stated(closed, tuple(dict.fromkeys(formats)), told, int(one.number("seed", 1, above=-1)))


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


def _notches_for(
    records: Sequence[Record], plant: Plant, bandwidth: float, most: int
) -> tuple[Response | None, tuple[Notch, ...]]:
    """Return (measured response where it shows a mode, a notch for each of the modes that rise most)."""
    rigid = plant
    for e in plant.effects:
        rigid = rigid.without(e.key) if e.name == "flexible_mode" else rigid
    response, modes = resonances(records, rigid, bandwidth) if records else (None, [])
    if not modes:
        return None, ()
    highest = sorted(modes, key=lambda m: -m.rise)[:most]
    return response, tuple(notch_for(m) for m in sorted(highest, key=lambda m: m.frequency))


def cascades(gains: DriveGains, plant: Plant) -> tuple[Cascade, ...]:
    """Return the sets as a closed drive is told them."""
    limits = plant.limits
    return tuple(
        Cascade(
            *map(float, point), limits.speed, limits.drive, gains.mass, 0.0, gains.forward, plant.rotary, gains.notches
        )
        for point in gains.points
    )


def driven(study: Study, task: Task, made: Designed, records: Sequence[Record], bandwidth: float, rule: str, say, budget: Strategy = STRATEGY) -> Part:  # fmt: skip
    """Tune the drive that a study states, hold it beside the scheduled PD, and write its files."""
    plant = task.plant
    given = stated(study.table, plant, task.loop.count)
    say("tuning the closed drive's gains")
    response, notches = _notches_for(records, plant, bandwidth, given.closed.notches)
    g = made.gains
    gains = tune_drive(
        given.closed, task, made.equivalent, (g.amplitude, g.kp, g.kd), notches=notches, measured=response, seed=given.seed,
        budget=budget,
    )  # fmt: skip
    name = f"scheduled PD ({rule})"
    rows = beside(gains, made.tuned[name].controller)
    kept, refused = files(given.formats, cascades(gains, plant), plant, given.told)
    findings = tuple(Finding(REFUSED, format, sentence, {}, "") for format, sentence in refused.items())
    smooth = following(gains)
    figures, units = _figures_of(gains, rows, smooth, plant)
    chapter = drive_chapter(gains, rows, smooth, plant, name, tuple(kept), refused)

    def write(folder: Path) -> None:
        write_together(folder / FOLDER, {n: t.encode() for n, t in kept.items()})

    return Part(figures, units, (chapter,), findings, {"drive": _table(gains, rows, kept, refused)}, (write,))


def _figures_of(gains: DriveGains, rows, smooth: tuple[float, float], plant: Plant) -> tuple[dict, dict]:
    """Return (figures, units) by which a study may be judged."""
    figures = {
        "drive_sensitivity_peak": float(gains.sensitivity.max()),
        "drive_final_error": rows[-1].sets.error,
        "drive_following_error": smooth[1],
        "drive_step_time": rows[-1].sets.time,
    }
    return figures, {
        "drive_final_error": plant.displacement,
        "drive_following_error": plant.displacement,
        "drive_step_time": "s",
    }


def _table(gains: DriveGains, rows, kept, refused) -> dict:
    """What results.json holds of the drive."""
    return {
        "sets": [dict(zip(NUMBERS, map(float, p), strict=True)) | {"move": float(s), "sensitivity": float(m)} for s, p, m in zip(gains.sizes, gains.points, gains.sensitivity, strict=True)],
        "notches": [vars(n) for n in gains.notches],
        "forward": gains.forward, "mass": gains.mass, "points_tried": gains.tried,
        "beside": [{"size": r.size} | {k: vars(getattr(r, k)) for k in ("scheduled", "single", "sets")} for r in rows],
        "files": list(kept), "refused": dict(refused),
    }  # fmt: skip

"""Every file that a study leaves for its drive: each format that was asked for, and a compensation table for each effect that has one.

What is written is read again before it is kept; what a format cannot hold is refused in a sentence, and the others are written.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from workbench.drives import cogging, elmo, friction, kinematic, linuxcnc, moteus, odrive, ros2, sdo, twincat
from workbench.drives.gains import Cascade, Units
from workbench.drives.objects import Object
from workbench.errors import WorkbenchError, nearest
from workbench.plant import Plant
from workbench.simulation.dynamics import is_friction

NAMES = {
    "sdo": "sdo.csv", "twincat": "twincat.xml", "elmo": "elmo.txt", "odrive": "odrive.json", "moteus": "moteus.cfg",
    "ros2": "ros2.yaml", "linuxcnc": "linuxcnc.hal",
}  # fmt: skip


@dataclass(frozen=True)
class FormatOptions:
    """What the formats need besides the gains. integral: unit of Elmo's. channel: of LinuxCNC. joint: of ros2_control."""

    units: Units = Units()
    objects: tuple[Object, ...] = ()
    integral: str = "1/s"
    channel: str = "pid.x"
    joint: str = "axis"


def writer(
    name: str, sets: Sequence[Cascade], options: FormatOptions
) -> tuple[Callable[[], str], Callable[[str], object]]:
    """Return (write, read) of a format; the last set is the one of a drive that holds one. WorkbenchError for no format."""
    one = sets[-1]
    known = {
        "sdo": (lambda: sdo.write(one, options.objects), sdo.read),
        "twincat": (lambda: twincat.write(one, options.objects), twincat.read),
        "elmo": (lambda: elmo.write(sets, options.units, options.integral), elmo.read),
        "odrive": (lambda: odrive.write(one), odrive.read),
        "moteus": (lambda: moteus.write(one), moteus.read),
        "ros2": (lambda: ros2.write(one, options.joint), ros2.read),
        "linuxcnc": (lambda: linuxcnc.write(one, options.units, options.channel), linuxcnc.read),
    }
    if name not in known:
        raise WorkbenchError(f"there is no format '{name}' of a drive; {nearest(name, known)}")
    return known[name]


def _maps(plant: Plant) -> dict[str, tuple[Callable[[], str], Callable[[str], object]]]:
    """Return file name -> (write, read) of the compensation tables that a plant has effects for."""
    found = {}
    if any(e.name == cogging.WHAT for e in plant.effects):
        found["cogging.csv"] = (lambda: cogging.write(plant), cogging.load)
    if any(e.name == kinematic.NAME for e in plant.effects):
        found["kinematic_error.csv"] = (lambda: kinematic.write(plant), kinematic.load)
    if any(is_friction(e) and e.at == "axis" for e in plant.effects):
        found["friction.csv"] = (lambda: friction.write(plant, plant.limits.speed), friction.load)
    return found


def files(
    formats: Sequence[str], sets: Sequence[Cascade], plant: Plant, options: FormatOptions
) -> tuple[Mapping[str, str], Mapping[str, str]]:
    """Return (file name -> text, format or file -> the sentence by which it was refused)."""
    wanted = {NAMES.get(n, n): (n, *writer(n, sets, options)) for n in formats}
    wanted |= {n: (n, *both) for n, both in _maps(plant).items()}
    kept, refused = {}, {}
    for name, (asked, write, read) in wanted.items():
        try:
            text = write()
            read(text)
            kept[name] = text
        except WorkbenchError as error:
            refused[asked] = str(error)
    return kept, refused

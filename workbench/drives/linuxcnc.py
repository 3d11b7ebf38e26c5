"""LinuxCNC HAL: `setp` lines of one pid component that commands torque, in machine units (mm or degrees) and drive units.

    output = P e + I integral of e + D de/dt + FF0 r + FF1 dr/dt + FF2 d2r/dt2

D acts on the error's rate, and the cascade on the measured speed, so FF1 takes D dr/dt away again where the speed loop is
given none of the reference's speed: FF1 = (forward - 1) kvp + viscous, FF2 = mass, FF0 = 0.
"""

import re
from math import pi

from workbench.drives.fields import LICENCE, Range, number, text
from workbench.drives.gains import Cascade, Units
from workbench.errors import WorkbenchError

PINS = ("Pgain", "Igain", "Dgain", "FF0", "FF1", "FF2", "maxoutput", "deadband", "bias")
RANGES = {n: Range(n, -1e9 if n.startswith("FF") else 0.0, 1e9) for n in PINS}
CHANNEL = re.compile(r"[a-z][a-z0-9.-]*")


def write(gains: Cascade, units: Units, channel: str = "pid.x") -> str:
    """Return the lines. The output is in A where `units.amps` is stated, else in N*m or N.

    WorkbenchError for a channel's name, or a number that is no finite one.
    """
    if not CHANNEL.fullmatch(channel):
        raise WorkbenchError(f"LinuxCNC: '{channel}' is no pid channel; such as pid.x or pid.0.")
    gains.without_notches("LinuxCNC")
    machine = pi / 180.0 if gains.rotary else 1e-3  # SI of one degree or millimetre
    drive = units.amps or 1.0
    p, i, d = gains.pid
    values = {
        "Pgain": p, "Igain": i, "Dgain": d, "FF0": 0.0, "FF1": (gains.forward - 1.0) * gains.kvp + gains.viscous,
        "FF2": gains.mass,
    }  # fmt: skip
    held = {n: RANGES[n].hold(v * machine * drive, "LinuxCNC") for n, v in values.items()}
    held |= {"maxoutput": RANGES["maxoutput"].hold(gains.limit * drive, "LinuxCNC"), "deadband": 0.0, "bias": 0.0}
    what = "degrees" if gains.rotary else "mm"
    unit = "A" if units.amps else "N*m" if gains.rotary else "N"
    lines = [f"setp {channel}.{n} {text(v)}" for n, v in held.items()]
    return "\n".join([f"# {what} to {unit}. {LICENCE}", *lines]) + "\n"


def read(content: str) -> dict[str, float]:
    """Return pin -> value of the lines of one channel; WorkbenchError, naming the line, for anything else."""
    found, channels = {}, set()
    for n, line in enumerate(content.splitlines(), 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        channel, _, pin = words[1].rpartition(".") if len(words) == 3 else ("", "", "")
        if words[0] != "setp" or pin not in PINS or pin in found:
            raise WorkbenchError(f"LinuxCNC, line {n}: '{line}' is no setp of a pid component, or said twice.")
        channels.add(channel)
        found[pin] = RANGES[pin].hold(number(words[2], f"LinuxCNC, line {n}"), f"LinuxCNC, line {n}")
    if set(found) != set(PINS) or len(channels) != 1:
        raise WorkbenchError(f"LinuxCNC: {sorted(set(PINS) - set(found)) or 'one channel'} is missing.")
    return found

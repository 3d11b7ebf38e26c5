"""moteus: `conf set` lines for its console. One PID on the position, in turns and N*m: the cascade written as one.

servo.pid_position.kp is in N*m/turn, ki in N*m/(turn s), kd in N*m/(turn/s), of the commanded less the measured speed;
ilimit and servo.max_position_slip do not change the law below its limits.
"""

from workbench.drives.fields import LICENCE, Range, number, text
from workbench.drives.gains import TURN, Cascade
from workbench.errors import WorkbenchError

RANGES = {
    "servo.pid_position.kp": Range("kp", 0.0, 1e6),
    "servo.pid_position.ki": Range("ki", 0.0, 1e6),
    "servo.pid_position.kd": Range("kd", 0.0, 1e6),
    "servo.pid_position.ilimit": Range("ilimit", 0.0, 1e4),
}


def write(gains: Cascade) -> str:
    """Return the lines; WorkbenchError for a linear axis, feed-forward, or a number beyond the range."""
    gains.without_notches("moteus")
    if not gains.rotary:
        raise WorkbenchError(
            "moteus turns: it takes gains of a rotary axis; state the screw's pitch as a gear and tune again."
        )
    if gains.mass or gains.viscous or gains.forward:
        raise WorkbenchError("moteus takes feed-forward with each command and not as a gain; leave it out here.")
    p, i, d = gains.pid
    values = dict(zip(RANGES, (p * TURN, i * TURN, d * TURN, gains.limit), strict=True))
    lines = [f"conf set {name} {text(RANGES[name].hold(v, 'moteus'))}" for name, v in values.items()]
    return "\n".join([f"# {LICENCE}", *lines, "conf write"]) + "\n"


def read(content: str) -> dict[str, float]:
    """Return name -> value of the lines; WorkbenchError, naming the line, for anything else."""
    found, written = {}, False
    for n, line in enumerate(content.splitlines(), 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        if words == ["conf", "write"]:
            written = True
        elif len(words) == 4 and words[:2] == ["conf", "set"] and words[2] in RANGES and words[2] not in found:
            found[words[2]] = RANGES[words[2]].hold(number(words[3], f"moteus, line {n}"), f"moteus, line {n}")
        else:
            raise WorkbenchError(f"moteus, line {n}: '{line}' is not understood, or said twice.")
    if set(found) != set(RANGES) or not written:
        raise WorkbenchError(f"moteus: {sorted(set(RANGES) - set(found)) or 'conf write'} is missing.")
    return found

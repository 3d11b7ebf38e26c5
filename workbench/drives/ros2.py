"""ros2_control: parameters of a pid_controller that reads position and speed and commands effort, in SI, as YAML."""

import re

from workbench.drives.fields import LICENCE, Range, number, text
from workbench.drives.gains import Cascade
from workbench.errors import WorkbenchError

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
RANGE = Range("gain", 0.0, 1e9)
TEXT = """# {licence}
{name}:
  ros__parameters:
    type: pid_controller/PidController
    dof_names: [{joint}]
    command_interface: effort
    reference_and_state_interfaces: [position, velocity]
    gains:
      {joint}:
        p: {p}
        i: {i}
        d: {d}
        u_clamp_max: {limit}
        u_clamp_min: -{limit}
"""


def write(gains: Cascade, joint: str = "axis", name: str = "pid_controller") -> str:
    """Return the parameters; WorkbenchError for feed-forward other than none, a name, or a number beyond the range."""
    for word in (joint, name):
        if not NAME.fullmatch(word):
            raise WorkbenchError(f"ros2_control: '{word}' is no name of a joint or a node; letters, digits and _ are.")
    gains.without_notches("ros2_control")
    if gains.mass or gains.viscous or gains.forward:
        raise WorkbenchError(
            "ros2_control: a pid_controller has no feed-forward of speed and acceleration; leave it out here."
        )
    p, i, d = (text(RANGE.hold(v, f"ros2_control, {n}")) for n, v in zip("pid", gains.pid, strict=True))
    limit = text(RANGE.hold(gains.limit, "ros2_control, limit"))
    numbers = {k: v if "." in v or "e" in v else f"{v}.0" for k, v in {"p": p, "i": i, "d": d, "limit": limit}.items()}
    return TEXT.format(licence=LICENCE, name=name, joint=joint, **numbers)  # ROS tells 1 from 1.0


def read(content: str) -> dict[str, float]:
    """Return p, i, d and the two clamps of parameters as `write` lays them out; WorkbenchError for anything else."""
    pattern = re.escape(TEXT).replace(r"\{", "{").replace(r"\}", "}")
    fields = {"licence": ".*", "name": r"(\w+)", "joint": r"\w+", **dict.fromkeys(("p", "i", "d", "limit"), r"(\S+)")}
    match = re.fullmatch(pattern.format(**fields), content)
    if match is None:
        raise WorkbenchError("ros2_control: these are not the parameters of a pid_controller with p, i, d and clamps.")
    _, p, i, d, high, low = match.groups()
    found = {"p": p, "i": i, "d": d, "u_clamp_max": high, "u_clamp_min": f"-{low}"}
    return {n: number(v, f"ros2_control, {n}") for n, v in found.items()}

"""ODrive: the configuration that odrivetool restores, JSON of paths. Units are turns and N*m, of a rotary axis.

pos_gain is in (turn/s)/turn, vel_gain in N*m/(turn/s), vel_integrator_gain in N*m/turn, vel_limit in turn/s, inertia in
N*m/(turn/s^2); the controller's inertia is what its acceleration feed-forward uses.
"""

import json

from workbench.drives.fields import Range
from workbench.drives.gains import TURN, Cascade
from workbench.errors import WorkbenchError

PLACE = "axis0.controller.config."
RANGES = {
    "pos_gain": Range("pos_gain", 0.0, 1e6),
    "vel_gain": Range("vel_gain", 0.0, 1e6),
    "vel_integrator_gain": Range("vel_integrator_gain", 0.0, 1e6),
    "vel_limit": Range("vel_limit", 1e-6, 1e6),
    "inertia": Range("inertia", 0.0, 1e6),
}


def write(gains: Cascade) -> str:
    """Return the configuration; WorkbenchError for a linear axis, speed feed-forward that is no whole share, or a range."""
    gains.without_notches("ODrive")
    if not gains.rotary:
        raise WorkbenchError(
            "ODrive turns: it takes gains of a rotary axis; state the screw's pitch as a gear and tune again."
        )
    if gains.viscous:
        raise WorkbenchError("ODrive has no viscous feed-forward; leave it out, or send it as torque feed-forward.")
    if gains.forward not in (0.0, 1.0):
        raise WorkbenchError(
            f"ODrive adds the reference's whole speed or none of it; a share of {gains.forward:g} cannot be written."
        )
    values = {
        "pos_gain": gains.kv,
        "vel_gain": gains.kvp * TURN,
        "vel_integrator_gain": gains.ki * TURN,
        "vel_limit": gains.speed_limit / TURN,
        "inertia": gains.mass * TURN,
    }
    held = {PLACE + n: RANGES[n].hold(v, "ODrive") for n, v in values.items()}
    return json.dumps(held, indent=2) + "\n"


def read(content: str) -> Cascade:
    """Return the gains of a configuration, its limit of torque left at zero; WorkbenchError for anything else."""
    try:
        found = json.loads(content)
    except ValueError as error:
        raise WorkbenchError(f"the ODrive configuration is no JSON ({error}).") from error
    if not isinstance(found, dict) or set(found) != {PLACE + n for n in RANGES}:
        raise WorkbenchError(f"the ODrive configuration holds other keys than {', '.join(RANGES)}.")
    v = {n: found[PLACE + n] for n in RANGES}
    for n, value in v.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise WorkbenchError(f"ODrive: {n} is {value!r}; a number is needed.")
        RANGES[n].hold(float(value), "ODrive")
    return Cascade(
        v["pos_gain"],
        v["vel_gain"] / TURN,
        v["vel_integrator_gain"] / TURN,
        v["vel_limit"] * TURN,
        0.0,
        v["inertia"] / TURN,
    )

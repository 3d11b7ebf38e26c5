"""A position that is logged in per cent of its stroke, with a model that is written in it too: an inertia in N*s^2/%, a viscous friction in N*s/%.

So do valves, dampers and hatches, whose positioner knows its two ends and no length. One per cent then stands for one millimetre, or one
milliradian where the drive is a torque: on the way in it is written so in every quantity that holds it, and a finding says so.
"""

import re
from collections.abc import Sequence
from copy import deepcopy

from workbench.definition import catalogue
from workbench.errors import WorkbenchError
from workbench.finding import OTHER_UNIT, Finding
from workbench.readers.declaration import Table
from workbench.units.registry import DERIVED, tidy

OWN = "percent"
PLACES = ("position", "load_position", "reference", "velocity")
DRIVES = ("torque", "force", "injected")
STANDS = {"torque": "mrad", "force": "mm"}
BESIDE = {"torque": "rad", "force": "m"}  # whose units do not go with it
NAME = re.compile(r"[A-Za-z]+")
PLACE = re.compile(r"\bx\b")  # of a parameter's unit: it holds a displacement


def in_length(top: Table) -> tuple[Table, tuple[Finding, ...]]:
    """Return a campaign's table with per cent of a stroke turned into mm or mrad, one for one, and what is said of it.

    The table itself where the position is in something else, or has a scale. Raises WorkbenchError where the drive is in per cent, too, of
    which a unit then does not say which is meant, and where other channels or parameters are in a length, an angle or kg.
    """
    values = deepcopy(dict(top.values))
    channels = values.get("channels")
    one = channels.get("position") if isinstance(channels, dict) else None
    drive = next((name for name in STANDS if isinstance(channels, dict) and name in channels), "")
    if not drive or not _holds(one) or "scale" in one:
        return top, ()
    unit, stands = one["unit"], STANDS[drive]
    scale = f'channels.position.scale, such as {{ value = 1.0, unit = "{stands}/{unit}" }}'
    if any(_holds(channels.get(name)) for name in DRIVES):
        both = f"channels.position.unit: position and drive are both logged in '{unit}', and a unit of a parameter does not say which it means"
        raise WorkbenchError(f"{top.file}: {both}; give {scale}, and parameters in SI.")
    others = {*DERIVED[BESIDE[drive]], BESIDE[drive], *DERIVED["kg"], "kg"}
    for name in PLACES:
        channel = channels.get(name)
        if isinstance(channel, dict) and "scale" not in channel:
            if not _holds(channel):
                raise _mixed(top, f"channels.{name}", channel, unit, scale)
            channel["scale"] = {"value": 1.0, "unit": f"{stands}/{unit}"}
    for path, q, displaced in _quantities(values):
        if not displaced or not isinstance(q, dict) or not isinstance(q.get("unit"), str):
            continue
        if others & {*NAME.findall(tidy(q["unit"]))}:
            raise _mixed(top, path, q, unit, scale)
        q["unit"] = NAME.sub(lambda n: f"({stands})" if n[0] == OWN else n[0], tidy(q["unit"]))
    sentence = f"The position is logged in '{unit}', and no scale says how long that is: 1 {unit} stands for 1 {stands} in every number that follows."
    mend = (
        f"Give {scale}, and parameters in SI, to have a length."
        if drive == "force"
        else f"Give {scale}, and parameters in SI, to have an angle."
    )
    return Table(values, top.file, optional=tuple(values)), (Finding(OTHER_UNIT, "position", sentence, {}, mend),)


def _holds(channel: object) -> bool:
    """Whether a channel is logged in per cent."""
    return (
        isinstance(channel, dict)
        and isinstance(channel.get("unit"), str)
        and OWN in NAME.findall(tidy(channel["unit"]))
    )


def _mixed(top: Table, path: str, given: dict, unit: str, scale: str) -> WorkbenchError:
    return WorkbenchError(
        f"{top.file}: {path}.unit: '{given.get('unit')}' does not go with a position that is logged in '{unit}'; write all that holds a "
        f"displacement in it, an inertia in 'N*s^2/{unit}', or give {scale}."
    )


def _quantities(values: dict) -> Sequence[tuple[str, object, bool]]:
    """Return (key path, quantity, whether it holds a displacement) of the speed limit and of every effect's parameters."""
    found = [("speed_limit", values.get("speed_limit"), True)]
    effects = values.get("effects")
    for k, effect in enumerate(effects if isinstance(effects, list) else (), 1):
        name, given = (effect.get("effect"), effect.get("parameters")) if isinstance(effect, dict) else (None, None)
        law = catalogue().get(name) if isinstance(name, str) else None
        for key, q in given.items() if law and isinstance(given, dict) else ():
            template = law.outside[key].unit if key in law.outside else ""
            found.append((f"effect {k} '{name}', parameters.{key}", q, bool(PLACE.search(template))))
    return found

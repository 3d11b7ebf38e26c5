"""A drive that is logged in a unit of its own, with a model that is written in it too: friction in A, an inertia in A*s^2/rad.

Where nobody knows the torque constant, or it does not matter, that is what an engineer has. One ampere then stands for one N*m: on the way
in it is written so in every quantity that holds it, and a finding says so. So does a count of a PWM, or a number without any unit ("1"):
of that it is the effect's parameter that says what holds a torque. An ampere is as much a force's as a torque's: where the position is a
length, a drive that is called a torque is the force of a slide.
"""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from copy import deepcopy

from workbench.definition import catalogue
from workbench.errors import WorkbenchError
from workbench.finding import OTHER_UNIT, Finding
from workbench.readers.declaration import Table
from workbench.units import holds_mass, to_si
from workbench.units.registry import tidy

NONE = "1"  # a number without unit, as of a PWM's register
DRIVE = "drive"  # the name that it has on the way to N*m or N
# what drives log: a unit, and of some its thousandth, of which a model may be written in either
OWN = (("A", "mA"), ("V", "mV"), ("count",), ("percent",), ("permille",))
EFFORT = {"torque": ("kN*m", "N*m", "mN*m"), "force": ("kN", "N", "mN")}
NAME = re.compile(r"[A-Za-z]+")
QUOTED = re.compile(r"'[^' ]*\b[km]?N\b[^' ]*'")  # a unit with a force in it, within a sentence


def in_effort(top: Table) -> tuple[Table, tuple[Finding, ...]]:
    """Return a campaign's table with the drive's own unit turned into N*m or N, one for one, and what is said of it.

    The table itself where the drive has a torque or a force, a scale, or no parameter in its unit. Raises WorkbenchError where some
    parameters are in that unit and others in N*m or kg.
    """
    values = deepcopy(dict(top.values))
    drive, unit = _own(values.get("channels"))
    bare = unit != "" and tidy(unit) == NONE
    own = DRIVE if bare else tidy(unit)
    row = (DRIVE,) if bare else next((r for r in OWN if own in r), ())
    if bare:
        _named(values)
    told = [q for key in ("actuator_limit", "effects", "records") for q in _quantities(values.get(key), key)]
    if not any(_holds(q["unit"], row) for path, q in told if path.startswith("effect ")):
        return top, ()
    if drive == "torque" and _straight(values["channels"]):
        drive = "force"
        values["channels"] = {drive if name == "torque" else name: one for name, one in values["channels"].items()}
    efforts = EFFORT[drive]
    effort, first = efforts[1], 1 - row.index(own)
    scale = effort if bare else f"{effort}/{unit}"
    written = dict(zip(row, efforts[first:], strict=False))
    for path, q in told:
        if not _holds(q["unit"], row) and holds_mass(q["unit"]):
            raise WorkbenchError(
                f"{top.file}: {path}.unit: '{q['unit']}' does not go with a drive that is logged in '{unit}'; write all "
                f'parameters in it, or give channels.{drive}.scale, such as {{ value = 1.0, unit = "{scale}" }}.'
            )
        q["unit"] = NAME.sub(lambda n: f"({written[n[0]]})" if n[0] in written else n[0], tidy(q["unit"]))
    for name in (drive, "injected"):
        channel = values["channels"].get(name, {})
        if isinstance(channel, dict) and channel:
            if "scale" in channel or tidy(str(channel.get("unit"))) != tidy(unit):
                raise WorkbenchError(
                    f"{top.file}: channels.{name}.unit: '{channel.get('unit', '')}' does not go with a drive that is logged in '{unit}' "
                    f"and has no scale; log both in '{unit}', or give both a scale."
                )
            channel["scale"] = {"value": 1.0, "unit": scale}
    sentence = f"The drive is logged in '{unit}', and no scale turns it into '{effort}': {_stands(unit, effort)} in every number that follows."
    mend = f'Give channels.{drive}.scale, such as {{ value = 1.0, unit = "{scale}" }}, and parameters in SI, to have a {drive}.'
    return Table(values, top.file, optional=tuple(values)), (Finding(OTHER_UNIT, drive, sentence, {}, mend),)


@contextmanager
def in_own_words(top: Table, told: Sequence[Finding]) -> Iterator[None]:
    """While it lasts an error that quotes a unit as `in_effort` wrote it says what stands for what. top, told: as that returned them."""
    try:
        yield
    except WorkbenchError as wrong:
        if not told or not QUOTED.search(str(wrong)):
            raise
        effort, _, unit = top.values["channels"][told[0].subject]["scale"]["unit"].partition("/")
        raise WorkbenchError(f"{wrong} {_stands(unit, effort)} here.") from None


def _stands(unit: str, effort: str) -> str:
    return f"1 {unit if tidy(unit) != NONE else 'of it'} stands for 1 {effort}"


def _named(values: dict) -> None:
    """Write the name of a drive without unit into what holds it: the limit, and of each effect what its parameter says has a torque in it, an
    inertia of 's^2/rad' as '(s^2/rad)*drive'."""
    limit = values.get("actuator_limit")
    if isinstance(limit, dict) and isinstance(limit.get("unit"), str) and tidy(limit["unit"]) == NONE:
        limit["unit"] = DRIVE
    effects = values.get("effects")
    for one in effects if isinstance(effects, list) else ():
        known, given = (one.get("effect"), one.get("parameters")) if isinstance(one, dict) else ("", None)
        law = catalogue().get(known) if isinstance(known, str) else None
        for name, q in given.items() if law and isinstance(given, dict) else ():
            template = law.outside[name].unit if name in law.outside else ""
            if "F" in template and isinstance(q, dict) and isinstance(q.get("unit"), str) and not holds_mass(q["unit"]):
                q["unit"] = _with_drive(tidy(q["unit"]), template.count("/F"))


def _with_drive(unit: str, below: int) -> str:
    """Return a unit with the drive in it: once above, or so often below."""
    if below:
        return "/".join((f"({unit})", *[DRIVE] * below))
    return DRIVE if unit == NONE else f"({unit})*{DRIVE}"


def _own(channels: object) -> tuple[str, str]:
    """Return (channel, unit) of a drive that has no scale, empty where there is none."""
    for name in EFFORT:
        one = channels.get(name) if isinstance(channels, dict) else None
        if isinstance(one, dict) and "scale" not in one and isinstance(one.get("unit"), str):
            return name, one["unit"]
    return "", ""


def _straight(channels: dict) -> bool:
    """Return whether the position is a length, by its unit; of one with a scale that says nothing."""
    one = channels.get("position")
    if not isinstance(one, dict) or "scale" in one or not isinstance(one.get("unit"), str):
        return False
    try:
        to_si(1.0, one["unit"], "m", "")
    except WorkbenchError:
        return False
    return True


def _holds(unit: str, names: tuple[str, ...]) -> bool:
    return any(n in names for n in NAME.findall(tidy(unit)))


def _quantities(value: object, path: str) -> Iterator[tuple[str, dict]]:
    """Yield (key path, quantity) of every { value, unit } within what is declared."""
    if isinstance(value, dict) and isinstance(value.get("unit"), str):
        yield path, value
    elif isinstance(value, dict):
        joint = " " if path.endswith(",") else "."
        for key, inner in value.items():
            yield from _quantities(inner, f"{path}{joint}{key}")
    elif isinstance(value, list):
        for k, item in enumerate(value, 1):
            name = (item.get("effect") or item.get("file")) if isinstance(item, dict) else None
            yield from _quantities(item, f"{path.removesuffix('s')} {k}" + (f" '{name}'," if name else ","))

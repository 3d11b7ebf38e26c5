"""A drive that is logged in a unit of its own, with a model that is written in it too: friction in A, an inertia in A*s^2/rad.

Where nobody knows the torque constant, or it does not matter, that is what an engineer has. One ampere then stands for one N*m: every
quantity that holds the unit is multiplied by 1 N*m/A on the way in, and a finding says so.
"""

from collections.abc import Iterator
from copy import deepcopy

from workbench.errors import WorkbenchError
from workbench.finding import OTHER_UNIT, Finding
from workbench.readers.declaration import Table
from workbench.units import holds_mass, power_of

OWN = (("A", "mA"), ("V", "mV"))  # what drives log; of one row any may be written
EFFORT = {"torque": "N*m", "force": "N"}


def in_effort(top: Table) -> tuple[Table, tuple[Finding, ...]]:
    """Return a campaign's table with the drive's own unit turned into N*m or N, one for one, and what is said of it.

    The table itself where the drive has a torque or a force, a scale, or no parameter in its unit. Raises WorkbenchError where some
    parameters are in that unit and others in N*m or kg.
    """
    values = deepcopy(dict(top.values))
    drive, unit = _own(values.get("channels"))
    row = next((r for r in OWN if power_of(unit, r)), None)
    if row is None or power_of(unit, row) != 1.0:
        return top, ()
    effort = EFFORT[drive]
    told = [(path, q) for path, q in _quantities(values) if isinstance(q.get("unit"), str)]
    if not any(power_of(q["unit"], row) for path, q in told if path.startswith("effect ")):
        return top, ()
    for path, q in told:
        power = power_of(q["unit"], row)
        if not power and holds_mass(q["unit"]):
            raise WorkbenchError(
                f"{top.file}: {path}.unit: '{q['unit']}' does not go with a drive that is logged in '{unit}'; write all "
                f'parameters in it, or give channels.{drive}.scale, such as {{ value = 1.0, unit = "{effort}/{unit}" }}.'
            )
        by = f"*({effort})/({unit})" if power > 0.0 else f"*({unit})/({effort})"
        q["unit"] = f"({q['unit']})" + by * round(abs(power)) if power else q["unit"]
    for name in (drive, "injected"):
        channel = values["channels"].get(name)
        if not isinstance(channel, dict):
            continue
        if "scale" in channel or power_of(channel.get("unit", ""), row) != 1.0:
            raise WorkbenchError(
                f"{top.file}: channels.{name}.unit: '{channel.get('unit', '')}' does not go with a drive that is logged in '{unit}' and "
                f"has no scale; log both in '{unit}', or give both a scale."
            )
        channel["scale"] = {"value": 1.0, "unit": f"{effort}/{unit}"}
    sentence = f"The drive is logged in '{unit}', and no scale turns it into '{effort}': 1 {unit} stands for 1 {effort} in every number that follows."
    mend = f'Give channels.{drive}.scale, such as {{ value = 1.0, unit = "{effort}/{unit}" }}, and parameters in SI, to have a {drive}.'
    return Table(values, top.file, optional=tuple(values)), (Finding(OTHER_UNIT, drive, sentence, {}, mend),)


def _own(channels: object) -> tuple[str, str]:
    """Return (channel, unit) of a drive that has no scale, empty where there is none."""
    for name in EFFORT:
        one = channels.get(name) if isinstance(channels, dict) else None
        if isinstance(one, dict) and "scale" not in one and isinstance(one.get("unit"), str):
            return name, one["unit"]
    return "", ""


def _quantities(values: dict) -> Iterator[tuple[str, dict]]:
    """Yield (key path, quantity) of every { value, unit } that may hold the drive's unit."""
    if isinstance(limit := values.get("actuator_limit"), dict):
        yield "actuator_limit", limit
    effects = values.get("effects")
    for k, effect in enumerate(effects if isinstance(effects, list) else [], 1):
        given = effect.get("parameters") if isinstance(effect, dict) else None
        for name, q in (given if isinstance(given, dict) else {}).items():
            if isinstance(q, dict):
                yield f"effect {k} '{effect.get('effect', '')}', parameters.{name}", q
    records = values.get("records")
    for k, record in enumerate(records if isinstance(records, list) else [], 1):
        given = record.get("payload") if isinstance(record, dict) else None
        for name, q in (given if isinstance(given, dict) else {}).items():
            if isinstance(q, dict):
                yield f"record {k}, payload.{name}", q

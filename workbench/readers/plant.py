"""The plant that a campaign declares: its tables of effects and limits, checked, in SI."""

from workbench import definition as fx
from workbench.errors import WorkbenchError
from workbench.plant import Geometry, Limits, Plant
from workbench.readers.declaration import Table
from workbench.units import effect_unit


def declared_plant(top: Table, kind: str, rotary: bool, notes: dict[str, str]) -> Plant:
    """Return the plant as declared, values in SI."""
    given = top.table("geometry", optional=("gear_ratio", "pole_pairs"))
    geometry = Geometry(**{key: given.number(key, above=0.0) for key in given.values})
    stated = (("drive", "actuator_limit", "F"), ("speed", "speed_limit", "x/s"))
    limits = {name: top.quantity(key, effect_unit(unit, rotary), above=0.0) for name, key, unit in stated if key in top}
    plant = Plant(kind, (), rotary, geometry, Limits(**limits))
    for one in top.tables("effects", "effect", ("effect", "at"), ("law", "parameters", "label")):
        effect = _declared(one, rotary)
        try:
            plant = plant + effect(label=one.text("label"))
        except WorkbenchError as e:
            raise WorkbenchError(f"{one.path('at')}: {e}") from e
        notes[f"effects.{plant.effects[-1].key}.law"] = one.text("law")
    return plant


def _declared(one: Table, rotary: bool) -> fx.Effect:
    """Return the effect that a table names, with the values of its parameters table."""
    effect = fx.find(one.text("effect"), one.path("effect"))(at=one.text("at"))
    known = effect.outside
    given = one.table("parameters", optional=tuple(known))
    values, fixed = {}, {}
    # Numbers without unit first: they may be the exponent in the unit of another ("1/x^d").
    for name in sorted(given.values, key=lambda n: known[n].unit != "1"):
        powers = {n: values.get(n, p.value) for n, p in known.items() if p.unit == "1"}
        values[name] = given.quantity(name, _unit(given, name, known[name].unit, rotary, powers), optional=("fixed",))
        known[name].at(values[name], where=given.path(name))
        if "fixed" in (table := given.table(name, optional=("value", "unit", "fixed"))):
            fixed[name] = table.flag("fixed")
    try:
        return effect.declared(values, fixed, given.where)
    except ArithmeticError as e:
        raise WorkbenchError(f"{given.where}: these values cannot be held together ({e}); check their sizes.") from e


def _unit(given: Table, name: str, unit: str, rotary: bool, powers: dict[str, float]) -> str:
    """Return the SI unit of a parameter; of a value that is said to be free, and only where a search starts, also that without the exponent: a rate
    of x^0.8 is written 1/rad by who counts x in rad. A fixed one has to say which of h0 (1 - exp(-a x^d)) and h0 (1 - exp(-(a x)^d)) it is of."""
    plain = effect_unit(unit, rotary, dict.fromkeys(powers, 1.0))
    table = given.values[name] if isinstance(given.values[name], dict) else {}
    if table.get("fixed") is False and table.get("unit") == plain:
        return plain
    return effect_unit(unit, rotary, powers)

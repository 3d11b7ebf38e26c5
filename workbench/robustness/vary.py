"""From a drawn number to the axis that has it: a field of the scenario, or a parameter of one of the plant's effects.

Names are those of Scenario ("inertia" and "friction", factors; "delay"; "phase"; ...) or "effect.parameter", with the
place where it matters ("encoder_eccentricity@sensor.position.amplitude"). An effect that the plant has not is added to it
with its neutral values, at the first place where it can act: a gear's error varies between axes whose mean has none.
Parameters go by their names in the catalogue (h0, x0, d), or by those of a campaign (amplitude and phase).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.definition import Effect, catalogue, find
from workbench.errors import WorkbenchError, nearest
from workbench.parameter import Parameter
from workbench.plant import Plant, places
from workbench.robustness.cases import Varied
from workbench.units import effect_unit

LEAST = 1e-6  # of a factor on a mass, which must stay positive
FIELDS = {  # of Scenario: (unit, lowest)
    "inertia": ("1", LEAST),
    "friction": ("1", 0.0),
    "load_inertia": ("F*s^2/x", 0.0),
    "load": ("F", -np.inf),
    "delay": ("s", 0.0),
    "noise": ("F", 0.0),
    "phase": ("1", -np.inf),
    "temperature": ("K", 0.0),
}


@dataclass(frozen=True)
class Target:
    """What one name means on a plant. key: of the effect, "" for a field of the scenario. nominal: what a factor is on."""

    name: str
    key: str
    parameter: str
    unit: str
    lower: float
    upper: float
    nominal: float


def _parted(name: str) -> tuple[str, str | None, str]:
    """Return (effect, place or None, parameter) of "effect@place.parameter"."""
    head, _, parameter = name.rpartition(".")
    effect, at, place = head.partition("@")
    return effect, (place if at else None), parameter


def _found(plant: Plant, name: str, where: str) -> Effect:
    """Return the effect that a name is about, of the plant or else of the catalogue; WorkbenchError with nearest names."""
    effect, place, _ = _parted(name)
    there = [e for e in plant.effects if e.name == effect and place in (None, e.at)]
    if len(there) > 1:
        raise WorkbenchError(f"{where}: '{effect}' acts at {', '.join(e.at for e in there)}; write '{effect}@place.'.")
    if there:
        return there[0]
    if effect not in catalogue():
        known = (*FIELDS, *(f"{e.name}.{p}" for e in plant.effects for p in e.parameters))
        raise WorkbenchError(f"{where}: there is no '{name}' that could vary; {nearest(name, known)}")
    new = find(effect)
    return new(at=place or (places(plant.kind, new) or (new.at,))[0])


def target(plant: Plant, name: str, where: str = "what varies") -> Target:
    """Return what a name means on this plant; WorkbenchError says what is unknown, with the nearest names."""
    if name in FIELDS:
        unit, lowest = FIELDS[name]
        return Target(name, "", name, effect_unit(unit, plant.rotary), lowest, np.inf, 1.0)
    effect, parameter = _found(plant, name, where), _parted(name)[2]
    known: dict[str, Parameter] = {**effect.outside, **effect.parameters}
    if parameter not in known:
        raise WorkbenchError(
            f"{where}: effect '{effect.name}' has no parameter '{parameter}'; {nearest(parameter, known)}"
        )
    p = known[parameter]
    return Target(name, effect.key, parameter, effect_unit(p.unit, plant.rotary), p.lower, p.upper, p.value)


def checked(plant: Plant, varied: Sequence[Varied], where: str = "what varies") -> tuple[Target, ...]:
    """Return the targets; WorkbenchError where a distribution leaves what is physically possible."""
    targets = tuple(target(plant, v.name, where) for v in varied)
    for v, t in zip(varied, targets, strict=True):
        d = v.distribution.scaled(t.nominal) if v.relative else v.distribution
        if v.relative and not t.nominal > 0.0:
            raise WorkbenchError(f"{where}: '{v.name}' is {t.nominal:g}, of which there is no factor; state values.")
        if not (t.lower <= d.low and d.high <= t.upper):
            raise WorkbenchError(
                f"{where}: '{v.name}' is drawn from {d.low:g} to {d.high:g} {t.unit}, beyond its physical bounds "
                f"{t.lower:g} to {t.upper:g}; narrow its distribution."
            )
    return targets


def extended(plant: Plant, varied: Sequence[Varied]) -> Plant:
    """Return the plant with each effect that varies; those that it has not yet, at their neutral values."""
    for v in varied:
        if v.name not in FIELDS:
            e = _found(plant, v.name, "what varies")
            plant = plant if e.key in plant else plant + e
    return plant


def applied(plant: Plant, varied: Sequence[Varied], values: np.ndarray) -> tuple[Plant | list[Plant], dict]:
    """Return (the plant, or one a case, and name -> (n,) of the scenario's fields) of values (n, k).

    The plant must hold every effect that varies (`extended`), and the distributions be `checked`.
    """
    targets = [target(plant, v.name) for v in varied]
    columns = {
        t: values[:, i] * t.nominal if v.relative else values[:, i]
        for i, (v, t) in enumerate(zip(varied, targets, strict=True))
    }
    fields = {t.name: x for t, x in columns.items() if not t.key}
    setters = [(k, *_setter(e, {t.parameter: x for t, x in columns.items() if t.key == e.key}))
               for k, e in enumerate(plant.effects) if any(t.key == e.key for t in columns)]  # fmt: skip
    if not setters:
        return plant, fields
    return [_moved(plant, setters, i) for i in range(len(values))], fields


def _setter(effect: Effect, columns: dict[str, np.ndarray]) -> tuple[Callable[..., Effect], list[dict[str, float]]]:
    """Return (function of named values that gives the effect, those values of each case)."""
    names, rows = list(columns), np.stack(list(columns.values()), axis=1).tolist()
    each = [dict(zip(names, row, strict=True)) for row in rows]
    if all(n in effect.parameters for n in names):
        return effect.__call__, each
    outside = {n: p.value for n, p in effect.outside.items()}
    strange = [n for n in names if n not in outside]
    if strange:
        raise WorkbenchError(
            f"effect '{effect.name}': '{strange[0]}' is a name of the catalogue and {', '.join(n for n in names if n in outside)} "
            "of a campaign; let those vary that are named alike."
        )
    inward = effect.border.inward
    return (lambda **v: effect(**inward(outside | v))), each


def _moved(plant: Plant, setters, i: int) -> Plant:
    """Return the plant of case i."""
    effects = list(plant.effects)
    for k, make, each in setters:
        effects[k] = make(**each[i])
    return Plant(plant.kind, tuple(effects), plant.rotary, plant.geometry, plant.limits)

"""Parameters that enter as one of another effect does: beside that one they are held, for two columns that are the same have no values."""

from dataclasses import replace

from workbench.definition import Effect
from workbench.plant import Plant

ZERO = "zero"  # parameter of a map of the angle between two encoders, of which the plant has one


def once(effect: Effect, plant: Plant) -> Effect:
    """Return an effect with those parameters held that a plant has free already: the zero of two encoders, and what is `same_as` another's
    parameter at its place (the stiffness about zero of a joint whose stiffness is declared)."""
    held = {n: 0.0 for n, other in effect.same_as.items() if (p := _at(other, effect.at, plant)) and not p.fixed}
    if ZERO in effect.parameters and any(ZERO in e.parameters and not e.parameters[ZERO].fixed for e in plant.effects):
        held[ZERO] = effect.parameters[ZERO].value
    fixed = {n: replace(effect.parameters[n], value=value, fixed=True) for n, value in held.items()}
    return replace(effect, parameters={**effect.parameters, **fixed}) if fixed else effect


def in_all(effect: Effect, name: str, plant: Plant) -> float:
    """Return the value of an effect's parameter and of what is the same of another effect in a plant."""
    other = _at(effect.same_as.get(name, ""), effect.at, plant)
    return effect.parameters[name].value + (other.value if other else 0.0)


def _at(name: str, place: str, plant: Plant):
    """Return the one linear parameter of an effect of this name at a place, None where none is there."""
    found = next((e for e in plant.effects if e.key == f"{name}@{place}"), None)
    return found.parameters[found.linear[0]] if found else None

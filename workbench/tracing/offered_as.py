"""An effect as it is offered beside what is declared: without what something else says, or would say alone."""

from dataclasses import replace

from workbench.definition import Effect
from workbench.plant import Plant

ZERO = "zero"  # parameter of a map of the angle between two encoders, which have one zero: a second would be the same column
CURVE = "force_over_position"  # free form of the springs to ground, which has a bumper's place, too


def as_offered(effect: Effect, plant: Plant, zeroed: bool = False) -> Effect | None:
    """Return an effect with the parameters held that another one has, or that it has beside another one alone; None where that is all of it.

    zeroed: whether the encoders' zeros were found, record by record, so that the joint's mean torque is no reading (`inverse/zeros`). A wave's own zero
    could be any then: at 0.7 rad a wave of nothing in the angle drew a motor's cogging by what the gear's ratio does to a preload that is
    not there, and at 0.8 rad a joint lay so far beside its gap that this did nothing.
    """
    known = zeroed or any(ZERO in e.parameters and not e.parameters[ZERO].fixed for e in plant.effects)
    if ZERO in effect.parameters and known:
        effect = _held(effect, ZERO)
    other, name = effect.beside.get(effect.at, ("", ""))
    here = {e.name for e in plant.effects if e.at == effect.at}
    if not other or other in here:
        return effect
    return _held(effect, name) if name and CURVE not in here else None


def counted_from(effect: Effect, begin: float) -> Effect:
    """Return an effect of the bench clock that counts from an instant, s: where the first record begins."""
    return effect(**{n: begin for n, p in effect.parameters.items() if p.scale == "begin"})


def bare(effect: Effect) -> bool:
    """Whether an effect is without the parameter that it has beside another one alone."""
    name = effect.beside.get(effect.at, ("", ""))[1]
    return bool(name) and effect.parameters[name].fixed


def _held(effect: Effect, name: str) -> Effect:
    return replace(effect, parameters={**effect.parameters, name: replace(effect.parameters[name], fixed=True)})

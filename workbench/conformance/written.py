"""Checks of what is written down: names, sentences, units, bounds, and the claim to be linear."""

import sys

from workbench.definition import PLACES, Effect
from workbench.kernel.step import check_linear
from workbench.units import effect_unit, to_si

CLAIMS = ("passive", "rate independent", "odd", "even", "conservative", "masing")


def described(effect: Effect) -> tuple[bool, str]:
    """Everything that a report, a trace and an engineer read is there."""
    faults = [f"has no {n}" for n in ("name", "cause", "formula", "source") if not getattr(effect, n).strip()]
    if not effect.name.isidentifier():
        faults.append(f"is named '{effect.name}', which is no name of a function")
    faults += [f"claims to be '{h}', which is not checked" for h in effect.holds if h not in CLAIMS]
    faults += [f"acts at '{p}', which is no place" for p in effect.places if p not in PLACES]
    if effect.at.split(".")[0] not in effect.places:
        faults.append(f"stands at '{effect.at}', which is none of its places")
    for n, p in effect.parameters.items():
        if not p.meaning.strip():
            faults.append(f"does not say what '{n}' means")
        if not p.lower <= p.value <= p.upper:
            faults.append(f"has '{n}' = {p.value:g} outside its bounds")
    make = getattr(sys.modules.get(effect.step.__module__), effect.name, None)
    if callable(make) and not (make.__doc__ or "").strip():
        faults.append("has no docstring")
    if faults:
        return False, f"It {', and '.join(faults)}."
    return True, f"Its cause, formula, source and {len(effect.parameters)} parameters are stated."


def units(effect: Effect) -> tuple[bool, str]:
    """Every unit means something on the axes on which the effect exists, inside and as a campaign writes it."""
    read = []
    for motion in effect.motions:
        for known in (effect.parameters, effect.outside):
            powers = {n: p.value for n, p in known.items() if p.unit == "1"}
            for n, p in known.items():
                unit = effect_unit(p.unit, motion == "rotary", powers)
                to_si(1.0, unit, unit, f"effect '{effect.name}', {n}")  # WorkbenchError where it cannot be read
                read.append(unit)
    return True, f"{len(set(read))} units are read: {', '.join(sorted(set(read))) or 'none'}."


def linear(effect: Effect) -> tuple[bool, str]:
    """Linear parameters enter the output linearly and homogeneously, and no state."""
    check_linear(effect)  # WorkbenchError where they do not
    return True, f"Linear in {', '.join(effect.linear)}, and no state depends on them."

"""Values of a declared plant that are a data sheet's: which they are, and how far from them a search may go."""

from dataclasses import replace

from workbench.definition import FORCE, Effect, catalogue
from workbench.parameter import Parameter
from workbench.plant import Plant


def from_data_sheet(e: Effect) -> list[str]:
    """Return the fixed parameters of an effect that are values from a data sheet.

    A parameter held by definition (the exponent of a virgin curve) is none, nor is a knot of a free form.
    """
    default = catalogue()[e.name](at=e.at) if e.name in catalogue() else None
    by_definition = {n for n, p in default.parameters.items() if p.fixed} if default else set()
    return [n for n, p in e.parameters.items() if p.fixed and n not in by_definition and n not in e.knots]


def within_tolerance(plant: Plant, tolerance: float) -> tuple[Plant, dict[str, Effect]]:
    """Return the plant whose linear data-sheet values are free within their tolerance, and what was declared, by key.

    A mass that is half a per cent off would else be dressed by a lag or a flexible mode. It is searched with, and never reported.
    """
    declared = {}
    for e in plant.effects:
        loose = {
            n: _around(e.parameters[n], tolerance)
            for n in from_data_sheet(e)
            if n in e.linear and e.parameters[n].value != 0.0
        }
        if loose and e.port == FORCE:
            declared[e.key] = e
            plant = plant.swap(replace(e, parameters={**e.parameters, **loose}))
    return plant, declared


def _around(p: Parameter, tolerance: float) -> Parameter:
    """Return a parameter that is free within a relative tolerance of its value."""
    ends = sorted((p.value * (1.0 - tolerance), p.value * (1.0 + tolerance)))
    return replace(p, fixed=False, lower=max(p.lower, ends[0]), upper=min(p.upper, ends[1]))

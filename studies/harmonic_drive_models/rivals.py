"""What the review offers for each effect, fitted to the records of the axis that holds it: without it, with part of it, with it."""

from collections.abc import Callable
from dataclasses import dataclass

from workbench.definition import Effect, find
from workbench.identification.fit import identify
from workbench.identification.result import Fit
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.plant import Plant

from .axes import CYCLIC, LOADED, RATIO, SERIES, STRIBECK, Axis

BAND = 150.0  # Hz, as of the carried records
OFF = 0.8  # of what was simulated: where every fit begins
JOINT, MOTOR = "presliding_hysteresis@joint", "presliding_hysteresis@motor"
GEAR, SERIES_KEY = "waves_under_load@joint", "compliances_in_series@joint"


@dataclass(frozen=True)
class Judged:
    """fits: model -> fit. floor: what the simulated plant itself leaves on validation: noise and counts. inverses: of the axis."""

    axis: Axis
    fits: dict[str, Fit]
    floor: float
    inverses: tuple[InverseDynamics, ...]

    def error(self, model: str) -> float:
        return self.fits[model].validation


def judged(axis: str, made: Axis, say: Callable[[str], None]) -> Judged:
    """Fit every model that is asked about on an axis's records."""
    inverses = tuple(inverse_dynamics(made.records, BAND))
    fits = {}
    for model, plant in MODELS[axis](_declared(made.known)).items():
        say(f"fitting {axis}: {model}")
        fits[model] = identify(plant, inverses)
    return Judged(made, fits, left(made.known, inverses), inverses)


def left(plant: Plant, inverses) -> float:
    """Return the error of a plant as it stands on the validation records."""
    held = plant
    for e in plant.effects:
        held = held.swap(e(fixed=True, **{n: p.value for n, p in e.parameters.items()}))
    return identify(held, inverses).validation


def _declared(known: Plant) -> Plant:
    """Return what is known at values that are off, and a gear of one wave."""
    for e in known.effects:
        off = {n: OFF * p.value for n, p in e.parameters.items() if not p.fixed and n not in ("order", "speed")}
        known = known.swap(e(**off))
    for e in known.effects:
        if "order" in e.parameters:
            known = known.swap(e(fixed=True, order=e.parameters["order"].value))
    return known.swap(_waves(known[GEAR], ("sine_1", "cosine_1")))


def _waves(gear: Effect, free: tuple[str, ...]) -> Effect:
    """Return the gear's error with these amplitudes free, from next to nothing, and none of the others."""
    kept = {n: 1e-5 if n in free else 0.0 for n in gear.parameters}
    return gear(fixed=True, **kept).free(*free)


def _friction_models(p: Plant) -> dict[str, Plant]:
    motor, bare = p[MOTOR].parameters, p.without("stribeck_friction")
    level, x0 = motor["h0"].value, motor["x0"].value
    lugre = find("lugre_friction")(at="motor", sigma0=level / x0, x0=x0, ratio=0.1, speed=0.5)
    return {
        "Coulomb and viscous": bare.without(MOTOR) + find("coulomb_friction")(at="motor"),
        "presliding": bare,
        "presliding and Stribeck": p.swap(p["stribeck_friction"](speed=0.5)),
        "LuGre": bare.without(MOTOR) + lugre,
    }


def _cyclic_models(p: Plant) -> dict[str, Plant]:
    once, twice = "cyclic_friction once@motor", "cyclic_friction twice@motor"
    bare = p.without(once).without(twice)
    printed = bare + find("cogging")(at="motor").free("s1")(fixed=True, order=float(RATIO))
    for key in (once, twice):
        printed += p[key](fixed=True, cosine=0.0, sine=0.0)
    return {
        "presliding": bare,
        "one order": p.without(twice),
        "two orders": p,
        "two orders, as printed": printed,
    }


def _gear_models(p: Plant) -> dict[str, Plant]:
    gear = p[GEAR]
    waves = tuple(n for n in gear.parameters if n != "fading")
    return {
        "no wave": p.swap(_waves(gear, ())),
        "one wave": p,
        "three waves": p.swap(_waves(gear, waves)),
        "three waves that fade under load": p.swap(_waves(gear, waves)(fading=0.05).free("fading")),
    }


def _joint_models(p: Plant) -> dict[str, Plant]:
    both, rest = p[SERIES_KEY], p.without(SERIES_KEY)
    stiffness = both.parameters["torque"].value / both.parameters["x0"].value
    linear = find("linear_stiffness")(at="joint", stiffness=stiffness)
    rubs = both(share=0.3)
    smooth = both(fixed=True, friction=0.0)(share=0.3)
    return {
        "linear": rest + linear,
        "piecewise linear": rest + find("piecewise_stiffness")(k1=stiffness, k2=0.5 * stiffness, threshold=1e-3),
        "linear and cubic": rest + linear + find("cubic_stiffness")(at="joint", k3=1e6),
        "two compliances": rest + smooth,
        "two compliances and T_fr, no hysteresis": p.without(JOINT).swap(rubs),
        "two compliances, T_fr and hysteresis": p.swap(rubs),
    }


MODELS: dict[str, Callable[[Plant], dict[str, Plant]]] = {
    STRIBECK: _friction_models,
    CYCLIC: _cyclic_models,
    LOADED: _gear_models,
    SERIES: _joint_models,
}

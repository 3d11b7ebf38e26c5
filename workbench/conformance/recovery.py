"""Are the parameters of an effect told apart by a motion? Recovered from a synthetic record without noise."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from workbench.conformance.result import within
from workbench.conformance.scene import drawn, output, scene
from workbench.definition import CHANNELS, FORCE, Effect, find
from workbench.identification.fit import identify
from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import motion
from workbench.parameter import Parameter
from workbench.plant import ONE_MASS, Plant, reads_load
from workbench.record import IDENTIFICATION, Record, Source

SAMPLES = 3000
BAND = 0.08  # evaluation bandwidth over the sampling rate
OFF = {"order": 1.01, "number": 1.1, "time": 0.7, "": 1.2}  # factor on the truth at which a search starts; else 1.3
RECOVERED = 1e-3  # relative error


def _start(p: Parameter) -> Parameter:
    return p if p.fixed else replace(p, value=float(np.clip(p.value * OFF.get(p.scale, 1.3), p.lower, p.upper)))


def _errors(truth: Mapping[str, Parameter], found: Mapping[str, Parameter]) -> dict[str, float]:
    """Relative error of every parameter that is not held."""
    return {n: abs(found[n].value - p.value) / abs(p.value) for n, p in truth.items() if not p.fixed and p.value}


def recovered(effect: Effect) -> tuple[bool, str]:
    """A fit that starts elsewhere finds the parameters again."""
    effect = drawn(effect)
    found = _errors(effect.parameters, (_on_axis(effect) if _on_drive(effect) else _by_itself(effect)).parameters)
    if not found:
        return True, "There is no parameter to recover."
    worst = max(found, key=found.get)
    return within(
        found[worst], RECOVERED, f"Of {len(found)} parameters, '{worst}' is recovered worst; its relative error is"
    )


def _on_drive(effect: Effect) -> bool:
    """Whether identification runs this effect: a force, or a map of the command."""
    return effect.port == FORCE or effect.at == "command"


def record(effect: Effect, drive: np.ndarray | None = None) -> Record:
    there = scene(effect, SAMPLES)
    q = there.signals["q"].copy()
    channels = {"position": q, "torque": np.zeros(SAMPLES) if drive is None else drive}
    channels |= {n: there.signals[n].copy() for n in CHANNELS if n in effect.reads}
    source = Source(Path("synthetic"), "", "synthetic", {})
    return Record("synthetic", IDENTIFICATION, there.signals["t"].copy(), channels, {}, source)


def _passes(effect: Effect, drive: np.ndarray | None = None) -> InverseDynamics:
    return InverseDynamics(motion(record(effect, drive), BAND / scene(effect).dt))


def _on_axis(effect: Effect) -> Effect:
    """Return the effect as identified on an axis with a known inertia; forces of a joint act at the axis here."""
    here = _passes(effect)
    if effect.port == FORCE:
        effect = replace(effect, places=("axis",), at="axis")
    if effect.name == "inertia":
        plant = Plant(ONE_MASS, (effect,))
    else:
        size = 1.0 / float(np.sqrt(np.mean(here.motion.a**2)))
        plant = Plant(ONE_MASS, (find("inertia")(inertia=size, fixed=True), effect))
        if "dir" in effect.provides and not effect.linear:  # a direction without a force shows in what reads it
            plant += find("coulomb_friction")(coulomb=1.0, fixed=True)
    if reads_load(effect):  # the load is not of motion alone
        plant += find("cable_spring")(fixed=True, stiffness=1.0 / float(np.sqrt(np.mean(here.motion.q**2))))
    drive = predicted(here, plant)
    begun = {
        n: replace(_start(p), value=0.0) if n in effect.linear else _start(p) for n, p in effect.parameters.items()
    }
    begun = {n: replace(p, value=float(np.clip(p.value, p.lower, p.upper))) for n, p in begun.items()}
    return identify(plant.swap(replace(effect, parameters=begun)), [_passes(effect, drive)]).plant[effect.key]


def _by_itself(effect: Effect) -> Effect:
    """Return the effect as fitted to its own output by least squares."""
    from scipy.optimize import least_squares

    signals = scene(effect, SAMPLES).signals
    aim = output(effect, signals)
    begun = {n: _start(p) for n, p in effect.parameters.items() if not p.fixed}
    scale = np.array([abs(p.value) for p in begun.values()])

    def left(x: np.ndarray) -> np.ndarray:
        return output(effect(**dict(zip(begun, x * scale, strict=True))), signals) - aim

    bounds = np.array([[p.lower, p.upper] for p in begun.values()]).T / scale
    solved = least_squares(
        left, np.sign([p.value for p in begun.values()]), bounds=bounds, xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    return effect(**dict(zip(begun, solved.x * scale, strict=True)))

"""Is a prediction one? What a plant with the effect asks of its drive must not depend on the drive that was measured."""

from dataclasses import replace

import numpy as np

from workbench.conformance.recovery import BAND, SAMPLES, record
from workbench.conformance.scene import drawn, scene
from workbench.definition import ANGLE, CHANNELS, FORCE, Effect, find
from workbench.inverse.balances import balances, predicted
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import motion
from workbench.plant import ONE_MASS, TWO_MASS, Plant, places

BODY = ("inertia", "cable_spring")  # what the plant has beside the effect: a force that moves, and one that stands


def _around(effect: Effect) -> Plant:
    """Return a plant with the effect where it can act; forces of a joint that can act nowhere else act in the joint."""
    two = effect.port == ANGLE or not places(ONE_MASS, effect) or effect.at in ("load", "sensor.load_position")
    kind = TWO_MASS if two else ONE_MASS
    rotary = "rotary" in effect.motions
    at = effect.at if effect.at in places(kind, effect, rotary) else places(kind, effect, rotary)[0]
    plant = Plant(kind, rotary=rotary) + effect(at=at)
    beside = [find(n)(at="load" if two else "axis") for n in BODY]
    if two:
        beside += [find("inertia")(at="motor"), find("linear_stiffness")(at="joint")]
    for e in beside:
        if e.key not in (o.key for o in plant.effects):
            plant += e(**dict.fromkeys(e.linear, 1.0))
    return plant


def _asked(effect: Effect, plant: Plant, drive: np.ndarray) -> np.ndarray:
    """Return what the plant asks of its drive, and every balance, (1 + rows, n), on a record with this measured drive."""
    there = scene(effect, SAMPLES).signals
    made = record(effect, drive)
    channels = {"force" if n == "torque" and not plant.rotary else n: x for n, x in made.channels.items()}
    channels |= {n: there[n].copy() for n in CHANNELS}
    if plant.kind == TWO_MASS:
        channels |= {"position": there["motor_q"].copy(), "load_position": there["load_q"].copy()}
    inverse = InverseDynamics(motion(replace(made, channels=channels), BAND / scene(effect).dt))
    return np.vstack([predicted(inverse, plant), balances(inverse, plant)])


def sees_no_drive(effect: Effect) -> tuple[bool, str]:
    """Under two measured drives, as large as each other, the same motion asks for the same drive, to the last bit."""
    effect = drawn(effect)
    plant = _around(effect)
    one = scene(effect, SAMPLES).signals["u"].copy()
    first, other = (_asked(effect, plant, drive) for drive in (one, one[::-1].copy()))
    if np.array_equal(first, other, equal_nan=True):
        return True, "The same motion asks for the same drive, whatever drive was measured."
    what = "a force" if effect.port == FORCE else "a map"
    return (
        False,
        f"It is {what} that sees the measured drive: under another one the same motion asks for another drive.",
    )

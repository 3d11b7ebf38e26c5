"""Compensation of identified effects on a machine that shares no code with the package: a slow ramp, there and back.

What the machine's own cascade still gives against an effect, beside what is added, over its drive, is compared with how well
the fit predicts the drive on a record that it was not fitted to.
"""

import numpy as np
import pytest
import rig
from rig.machine import Machine
from rig.motions import CONTROL
from rig.signals import low_pass

from workbench.campaign import load
from workbench.compensation import Compensator, agreement, predicted
from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.record import IDENTIFICATION
from workbench.simulation.recorded import record_of

SPEED, WAY, SMOOTH = 0.15, 2.0, 0.3  # rad/s, s each way, s of a turn
ENDS = 0.2  # s at both ends that do not count
AGAIN = 6  # what is added changes the motion, on which it hangs: until both stay

CASES = {  # effect -> (base, what is missing of it, what of the machine it is, start of the fit from what was drawn)
    "presliding_hysteresis": ("presliding", (), lambda m: Machine(m.axis._replace(h0=0.0, h1=0.0), m.laws), None),
    "gravity": ("gravity", (), lambda m: without(m, "weight"), None),
    "cogging": ("presliding", ("cogging",), lambda m: without(m, "cogging"), lambda p: {"order": p["order"]}),
    "load_dependent_friction": (
        "gravity", ("load_dependent_friction",), lambda m: without(m, "loaded"), lambda p: {"mu": p["mu"]},
    ),
    "kinematic_error": (
        "presliding", ("kinematic_error",), lambda m: Machine(m.axis._replace(error=0.0), m.laws), lambda p: {"order": p["order"]},
    ),
}  # fmt: skip


def without(machine: Machine, law: str) -> Machine:
    return Machine(machine.axis, {n: v for n, v in machine.laws.items() if n != law})


def ramp() -> np.ndarray:
    """There and back, twice, with corners that are round; rad at 4 kHz."""
    n = round(WAY * CONTROL)
    speed = SPEED * np.tile(np.concatenate([np.ones(n), -np.ones(n)]), 2)
    k = round(SMOOTH * CONTROL)
    rounded = np.convolve(np.concatenate([np.zeros(k), speed, np.zeros(k)]), np.ones(k) / k, mode="same")
    return np.cumsum(rounded) / CONTROL


def driven(machine: Machine, reference: np.ndarray, added: np.ndarray, count: float):
    """Return (drive of the cascade alone, position in counts) along a reference, with a torque added to its command."""
    motion = rig.Motion(reference, np.gradient(reference, 1.0 / CONTROL), added)
    r = rig.run(machine, 0.0, motion, round(CONTROL))
    return r.u - added, r.counted(count, 0.0).q


@pytest.mark.parametrize("name", CASES)
def test_the_cascade_is_left_with_no_more_than_the_fit_does_not_explain(name, tmp_path):
    base, missing, bare, start = CASES[name]
    truth = rig.campaign(tmp_path, 7, missing, 4.0, base=base, short=True)
    machine, seen = truth["rig"], load(tmp_path)
    plant = seen.plant
    if missing:
        at = "sensor.position" if name == "kinematic_error" else "axis"
        e = find(name)
        outside = {n: v for n, v in start(truth["parameters"][name]).items() if n in e.parameters}
        plant = plant + e(at=at, **outside)
    inverses = inverse_dynamics(seen.records, seen.bandwidth)
    fit = identify(plant, inverses)
    count = seen.records[0].resolution["position"]
    reference = ramp()
    named = Compensator.of(fit.plant, (name,))
    asked, added = reference, np.zeros(reference.size)
    before, y = driven(machine, asked, added, count)
    alone, _ = driven(bare(machine), reference, added, count)
    for _ in range(AGAIN):
        if name == "kinematic_error":
            e = fit.plant[name].parameters
            wave = e["order"].value * reference
            asked = reference + e["sine"].value * np.sin(wave) + e["cosine"].value * (np.cos(wave) - 1.0)
        else:
            t = np.arange(y.size) / CONTROL
            record = record_of(
                "ramp", IDENTIFICATION, fit.plant, t, {"torque": before, "position": y}, {"position": count}, ""
            )
            added = predicted(named, record, velocity_filter=1e-3)
        after, y = driven(machine, asked, added, count)
    keep = slice(round(ENDS * CONTROL), -round(ENDS * CONTROL))
    left, effort, drive = (
        float(np.sqrt(np.mean(low_pass(u, CONTROL, seen.bandwidth)[keep] ** 2)))
        for u in (after - alone, before - alone, before)
    )
    print(
        f"{name}: of {effort / drive:.3f} of the drive {left / drive:.4f} are left; the fit leaves {fit.validation:.4f}"
    )
    assert left / drive <= 1.5 * fit.validation
    assert left < 0.5 * effort or effort / drive < fit.validation  # an encoder's error asks for little on a slow ramp


def test_what_is_added_along_a_record_is_what_identification_says_of_the_effect(tmp_path):
    rig.campaign(tmp_path, 7, (), base="gravity", short=True)
    seen = load(tmp_path)
    inverses = inverse_dynamics(seen.records, seen.bandwidth)
    plant = identify(seen.plant, inverses).plant
    slow = next(p for p in inverses if "slow" in p.motion.record.name)
    for name in ("gravity", "presliding_hysteresis"):
        assert agreement(Compensator.of(plant, (name,)), plant, slow) < 0.02

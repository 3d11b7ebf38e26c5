"""A joint between encoders that were set to zero under a weight is deflected by what it carries in the mean."""

import numpy as np
import pytest

from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.carrying import wound_up
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import TWO_MASS, Plant
from workbench.record import IDENTIFICATION, Record

DT, COUNT = 1e-3, 1e-7
MOTOR, LOAD, WEIGHT, STIFFNESS = 0.02, 0.3, 5.0, 800.0


def recorded(name: str, start: float, zero: float) -> tuple[Record, np.ndarray]:
    """Return a record whose load encoder was set to zero elsewhere, and the load's position from where the joint is relaxed."""
    t = DT * np.arange(6000)
    load = start + 0.4 * np.sin(3.1 * t) + 0.1 * np.sin(11.0 * t)
    torque = LOAD * (-0.4 * 3.1**2 * np.sin(3.1 * t) - 0.1 * 11.0**2 * np.sin(11.0 * t)) + WEIGHT * np.sin(load)
    deflection = torque / STIFFNESS
    motor = load + deflection
    a = np.gradient(np.gradient(motor, DT), DT)
    channels = {"torque": MOTOR * a + torque, "position": motor, "load_position": load + zero}
    read = {n: COUNT * np.round(x / COUNT) if "position" in n else x for n, x in channels.items()}
    steps = {"position": COUNT, "load_position": COUNT}
    return Record(name, IDENTIFICATION, t, read, {}, resolution=steps), load


def declared() -> Plant:
    plant = Plant(TWO_MASS) + find("inertia")(at="motor", inertia=MOTOR) + find("inertia")(at="load", inertia=LOAD)
    return plant + find("gravity")(at="load", sine=WEIGHT) + find("linear_stiffness")(at="joint", stiffness=STIFFNESS)


def test_what_the_load_asks_for_in_the_mean_says_where_a_joint_is_relaxed():
    made = [recorded("a", 0.3, 0.05), recorded("b", -0.9, -0.03)]
    inverses = inverse_dynamics([r for r, _ in made], 40.0)
    fit = identify(declared(), inverses)
    wound = wound_up(inverses, fit.plant)
    for p, before, (_, load) in zip(wound, inverses, made, strict=True):
        off, left = (x.motion.record.channels["load_position"] - load for x in (before, p))
        assert np.abs(left).max() < 0.02 * np.abs(off).max()
        assert p.motion.record.zero - before.motion.record.zero == pytest.approx(np.mean(left - off), abs=1e-12)
    # its mean torque closed the balance before, too; the weight is read a little elsewhere
    assert identify(declared(), wound).identification < fit.identification < 1e-3


@pytest.mark.parametrize(("held", "wound"), [(4.0, True), (0.05, False)])
def test_a_locked_load_may_hold_its_joint_wound_up(held, wound):
    """What the drive gives in the mean and the motor does not take says so, where that is most of what is left."""
    free, _ = recorded("a", 0.3, 0.05)
    t = DT * np.arange(6000)
    turned = 0.01 * np.sin(9.0 * t)
    torque = STIFFNESS * turned + held + MOTOR * -0.01 * 81.0 * np.sin(9.0 * t) + 0.5 * np.sin(5.0 * t)
    channels = {"torque": torque, "position": COUNT * np.round(turned / COUNT), "load_position": 0.0 * t}
    steps = {"position": COUNT, "load_position": COUNT}
    locked = Record("b", IDENTIFICATION, t, channels, {}, resolution=steps, locked=True)
    inverses = inverse_dynamics([free, locked], 40.0)
    plant = identify(declared(), inverses).plant
    p = wound_up(inverses, plant)[1]
    assert (p is not inverses[1]) is wound
    moved = p.motion.record.channels["load_position"] - inverses[1].motion.record.channels["load_position"]
    assert moved == pytest.approx(-held / STIFFNESS if wound else 0.0, rel=0.05)
    if wound:
        assert (
            identify(declared(), [inverses[0], p]).identification < 0.5 * identify(declared(), inverses).identification
        )


def test_a_joint_without_a_straight_spring_stays_as_it_is():
    record, _ = recorded("a", 0.3, 0.05)
    inverses = inverse_dynamics([record], 40.0)
    cubic = declared().without("linear_stiffness@joint") + find("cubic_stiffness")(at="joint", k3=1e6)
    assert inverses[0].motion.record.zero is not None and wound_up(inverses, cubic) == tuple(inverses)

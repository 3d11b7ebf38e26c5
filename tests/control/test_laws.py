"""Laws that use a profile, feed-forward, or both encoders: against NumPy, closed forms, and their own definitions."""

from math import pi
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control import FeedForward, fixed_pd, grid, pi_cascade, profile_pi, scheduled_pd
from workbench.control.law import Law
from workbench.definition import find
from workbench.effects.stiffness import linear_stiffness
from workbench.errors import WorkbenchError
from workbench.plant import ONE_MASS, TWO_MASS, Limits, Plant
from workbench.simulation import Loop, Scenario, simulate
from workbench.simulation.binding import bind
from workbench.simulation.criteria import Criteria
from workbench.simulation.oracle import run_arrays
from workbench.simulation.run import run_lanes
from workbench.simulation.scenario import arrays_of

COUNT = 2.0 * pi / 2**20
KNOTS = grid(2e-5, 2e-3)
SCHEDULE = SimpleNamespace(knots=KNOTS, kp=80.0 * (KNOTS / KNOTS[0]) ** -0.2, kd=0.8 * (KNOTS / KNOTS[0]) ** -0.1)
SPEEDS = grid(0.05, 20.0, 1)
FED = FeedForward(0.01, SPEEDS, 0.1 + 0.01 * SPEEDS)
ONE = Plant(
    ONE_MASS,
    (find("inertia")(inertia=0.01), find("presliding_hysteresis")(h0=0.1, x0=1e-3), find("viscous_friction")(viscous=0.01)),
    limits=Limits(4.0, 15.0),
)  # fmt: skip
TWO = Plant(
    TWO_MASS,
    (
        find("inertia")(inertia=0.008, at="motor"), find("inertia")(inertia=0.002, at="load"),
        find("presliding_hysteresis")(h0=0.1, x0=1e-3, at="motor"), linear_stiffness()(stiffness=400.0),
    ),
    limits=Limits(4.0, 15.0),
)  # fmt: skip
LOOP = Loop(2.5e-4, 2, 2.5e-4, 2.5e-4, COUNT)
BOTH = Loop(2.5e-4, 2, 2.5e-4, 2.5e-4, 4.0 * COUNT, COUNT, "load_position")
LAWS = {
    "profile": (ONE, LOOP, profile_pi(60.0, 0.9, 20.0, 150.0, 0.02, 12.0)),
    "fed forward": (ONE, LOOP, profile_pi(60.0, 0.9, 20.0, 150.0, 0.02, 12.0, feed_forward=FED)),
    "scheduled, profile": (ONE, LOOP, scheduled_pd(SCHEDULE, "error", deceleration=200.0, speed_limit=12.0)),
    "joint": (TWO, BOTH, scheduled_pd(SCHEDULE, "following", follows="joint")),
    "speed of the motor": (TWO, BOTH, pi_cascade(40.0, 0.6, 10.0, 12.0, motor_speed=True)),
}
STEPS = [Scenario(target=0.3 * (i + 1), friction=0.5 + 0.3 * i, phase=i / 5) for i in range(5)]


@pytest.mark.parametrize("name", LAWS)
def test_lanes_have_the_bits_of_numpy_under_every_law(name):
    plant, loop, controller = LAWS[name]
    bound = bind(plant, loop, controller, arrays_of(STEPS), 600, Criteria())
    lanes, arrays = run_lanes(bound)[0], run_arrays(bound)[0]
    for row, value in arrays.items():
        np.testing.assert_array_equal(lanes[row], value, err_msg=row)
    assert np.ptp(lanes["load.q" if plant is TWO else "q"]) > 0.1


def test_a_profile_with_feed_forward_comes_down_along_its_parabola():
    """On a bare mass that the feed-forward knows, and with no sampling to speak of, v^2 = 2 a e - (a/kv)^2."""
    mass, a, kv = 0.01, 120.0, 80.0
    bare = Plant(ONE_MASS, (find("inertia")(inertia=mass),), limits=Limits(3.0, 20.0))
    none = FeedForward(mass, SPEEDS, 0.0 * SPEEDS)
    fed, plain = (
        simulate(
            bare, Loop(2e-5, 1), profile_pi(kv, 2.0, 0.0, a, 0.1, 10.0, feed_forward=f), [Scenario(target=1.0)], 0.4,
            ("q", "v"),
        ).trajectories
        for f in (none, None)
    )  # fmt: skip

    def off(t):
        e, v = 1.0 - t["q"][:, 0], t["v"][:, 0]
        on = (t.time > 0.08) & (e > 2.0 * a / kv**2) & (e < 0.3)
        assert on.sum() > 500
        return float(np.abs(v[on] / np.sqrt(2 * a * e[on] - (a / kv) ** 2) - 1.0).max())

    assert off(fed) < 2e-3 < 0.05 < off(plain)
    assert fed["q"].max() <= 1.0 + 1e-9


def test_friction_fed_forward_leaves_the_integral_nothing_to_do():
    steps = [Scenario(target=3.0)]
    known = FeedForward(0.01, SPEEDS, 0.1 + 0.01 * SPEEDS)
    both = [
        simulate(ONE, Loop(2.5e-4, 4), profile_pi(30.0, 0.4, 0.0, 100.0, 0.1, 5.0, feed_forward=f), steps, 0.4, ("v",))
        for f in (known, None)
    ]
    at = int(0.35 / 2.5e-4)  # at the speed limit, no deceleration yet
    fed, plain = (m.trajectories["v"][at, 0] for m in both)
    assert fed == pytest.approx(5.0, abs=2e-3)
    assert plain == pytest.approx((0.4 * 5.0 - 0.1) / 0.41, rel=2e-3)  # kvp (v_r - v) = h0 + b v


def test_gains_that_follow_the_joint_are_those_of_the_relative_displacement_since_its_reversal():
    plant, loop, controller = LAWS["joint"]
    run = simulate(plant, loop, controller, STEPS[:2], 0.3, ("motor.y", "load.y", "kp", "amplitude")).trajectories
    back = 2.5 * max(loop.resolution, loop.load_resolution)
    for lane in range(2):
        x = run["motor.y"][:, lane] - run["load.y"][:, lane]
        expected = np.clip(amplitudes(x, back), KNOTS[0], KNOTS[-1])
        np.testing.assert_allclose(run["amplitude"][:, lane], expected, rtol=1e-12)
        np.testing.assert_allclose(run["kp"][:, lane], np.interp(expected, KNOTS, SCHEDULE.kp), rtol=1e-9)
        assert np.ptp(expected) > 1e-4


def amplitudes(x, back):
    """Stroke since the last turning point that was left by more than `back`; halved after the first such reversal."""
    far = turned = x[0]
    way, share, out = 0, 1.0, []
    for value in x:
        if abs(value - far) > back and way * (value - far) <= 0:
            share = 0.5 if way else share
            turned, far, way = far, value, int(np.sign(value - far))
        elif way * (value - far) > 0:
            far = value
        out.append(share * abs(value - turned))
    return np.array(out)


def test_the_speed_of_the_motor_is_not_that_of_the_load():
    plant, loop, _ = LAWS["speed of the motor"]
    steps = [Scenario(target=0.5)]
    runs = [
        simulate(plant, loop, pi_cascade(40.0, 0.6, 10.0, 12.0, motor_speed=m), steps, 0.3, ("u", "motor.y"))
        for m in (True, False)
    ]
    y, u = (runs[0].trajectories[n][:, 0] for n in ("motor.y", "u"))
    assert not np.array_equal(u, runs[1].trajectories["u"][:, 0])
    vh, alpha = (
        0.0,
        loop.smoothing,
    )  # the filtered difference of what the motor's encoder read, as a law without integral
    plain = simulate(
        plant, loop, pi_cascade(40.0, 0.6, 0.0, 12.0, motor_speed=True), steps, 0.02, ("u", "motor.y", "load.y")
    )
    t = plain.trajectories
    before = t["motor.y"][0, 0]
    for k, y in enumerate(t["motor.y"][:, 0]):
        vh += alpha * ((y - before) / loop.sample_time - vh)
        before = y
        wanted = np.clip(40.0 * (0.5 - t["load.y"][k, 0]), -12.0, 12.0)
        assert t["u"][k, 0] == pytest.approx(np.clip(0.6 * (wanted - vh), -4.0, 4.0), abs=1e-9)


def test_a_law_that_asks_for_two_encoders_is_refused_where_there_is_one():
    for controller in (LAWS["joint"][2], LAWS["speed of the motor"][2]):
        with pytest.raises(WorkbenchError, match="two encoders, but a plant of one mass"):
            simulate(ONE, LOOP, controller, STEPS, 0.01)


def test_what_is_wrong_with_a_law_is_a_sentence():
    with pytest.raises(WorkbenchError, match="did you mean 'motor_vh'"):
        Law("own", (), lambda s, z, p: ({}, s.e), reads=("motor_v",))
    with pytest.raises(WorkbenchError, match="relative displacement has the rule 'following'"):
        scheduled_pd(SCHEDULE, "error", follows="joint")
    with pytest.raises(WorkbenchError, match="both a deceleration and a speed_limit"):
        scheduled_pd(SCHEDULE, "error", deceleration=100.0)
    with pytest.raises(WorkbenchError, match="mass is -1"):
        FeedForward(-1.0, SPEEDS, SPEEDS)
    assert fixed_pd(1.0, 1.0).law.both is False

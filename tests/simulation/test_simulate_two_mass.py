"""Two masses, LuGre friction and resonances in the loop: against NumPy, closed forms, limits, and identification."""

from math import pi
from pathlib import Path
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from workbench.control import fixed_pd
from workbench.definition import Effect, find
from workbench.effects.stiffness import linear_stiffness
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.bodies import Bodies
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import Limits, Plant
from workbench.record import Record, Source
from workbench.simulation import Loop, Scenario, ScenarioArrays, open_loop, simulate
from workbench.simulation.binding import bind
from workbench.simulation.bodies import joint
from workbench.simulation.criteria import Criteria
from workbench.simulation.dynamics import Symbols, constants_of, fixed_signals
from workbench.simulation.oracle import run_arrays
from workbench.simulation.run import run_lanes
from workbench.simulation.scenario import arrays_of

COUNT = 2.0 * pi / 2**20
MOTOR, LOAD, STIFFNESS = 0.008, 0.002, 400.0
SCENARIOS = [
    Scenario(
        target=0.02 * (i - 6),
        inertia=1.0 + 0.05 * i,
        friction=1.5 - 0.1 * i,
        load=0.01 * (i % 3),
        noise=0.01 * (i % 2),
        phase=i / 13,
        seed=i,
        start=0.003 * (i % 4),
        load_inertia=0.001 * (i % 5),
        delay=2e-4 * (i % 3),
        locked=float(i == 7),
    )
    for i in range(13)
]


def bodies(motor: float = MOTOR, load: float = LOAD) -> tuple[Effect, ...]:
    return find("inertia")(inertia=motor, at="motor"), find("inertia")(inertia=load, at="load")


def elastic(stiffness: float = STIFFNESS, **limits) -> Plant:
    return Plant("two mass", (*bodies(), linear_stiffness()(stiffness=stiffness)), limits=Limits(**limits))


def gear(amplitude: float = 1e-4) -> Effect:
    return find("kinematic_error")(sine=amplitude, order=100.0)


def full() -> Plant:
    """Every port: friction with and without memory at each body, all of a joint, both sensors, command and delay."""
    return (
        elastic(drive=2.0, speed=2.0)
        + find("coulomb_friction")(coulomb=0.05, at="motor")
        + find("viscous_friction")(viscous=0.01, at="motor")
        + find("lugre_friction")(sigma0=20.0, sigma1=0.05, x0=2e-3, at="load")
        + find("coulomb_friction")(coulomb=0.01, at="load")
        + find("presliding_hysteresis")(h0=0.02, x0=3e-4, at="joint")
        + find("cubic_stiffness")(k3=1e7)
        + gear()
        + find("backlash")(half_width=5e-5)
        + find("encoder_eccentricity")(sine=1e-5, at="sensor.position")
        + find("encoder_eccentricity")(sine=2e-5, turns=3.0, at="sensor.load_position")
        + find("actuator_lag")(time_constant=2e-4)
        + find("transport_delay")(delay=3e-4)
    )


@pytest.mark.parametrize("feedback, plant", [("load_position", full()), ("position", elastic() + gear())])
def test_lanes_have_the_bits_of_numpy_over_scenarios(feedback, plant):
    loop = Loop(2.5e-4, 2, velocity_filter=1e-3, resolution=COUNT, load_resolution=4.0 * COUNT, feedback=feedback)
    bound = bind(plant, loop, fixed_pd(40.0, 0.5), arrays_of(SCENARIOS), 500, Criteria())
    lanes, _ = run_lanes(bound)
    arrays, _ = run_arrays(bound)
    for name, value in arrays.items():
        assert np.isfinite(value).all(), name
        np.testing.assert_array_equal(lanes[name], value, err_msg=name)
    assert (lanes["y"] == lanes["motor.y" if feedback == "position" else "load.y"]).all()
    assert (lanes["motor.y"] != lanes["load.y"]).any()
    assert lanes["load.q"][7] == SCENARIOS[7].start and abs(lanes["q"][7]) > 0.0


@pytest.mark.parametrize("places", [("axis",), ("motor", "load")])
def test_bristles_give_the_bits_of_numpy_and_a_direction(places):
    kind = "one mass" if places == ("axis",) else "two mass"
    plant = Plant(kind, tuple(find("inertia")(inertia=0.01, at=p) for p in places))
    plant += find("lugre_friction")(sigma0=100.0, sigma1=0.3, x0=1e-3, ratio=0.5, speed=0.05, at=places[-1])
    plant += find("stribeck_friction")(drop=0.05, speed=0.02, at=places[-1])
    plant = plant + linear_stiffness()(stiffness=300.0) if kind == "two mass" else plant
    assert not any("direction" in n for n in simulated(plant)[0]), "bristles say the direction themselves"
    lanes, arrays = simulated(plant)
    for name, value in arrays.items():
        np.testing.assert_array_equal(lanes[name], value, err_msg=name)
    assert abs(lanes[f"lugre_friction@{places[-1]}.z"]).max() > 1e-4


def simulated(plant: Plant):
    given = [Scenario(target=0.05 * (i + 1), friction=0.5 + 0.3 * i) for i in range(5)]
    bound = bind(plant, Loop(2.5e-4, 2, resolution=COUNT), fixed_pd(30.0, 0.6), arrays_of(given), 400, Criteria())
    return run_lanes(bound)[0], run_arrays(bound)[0]


def test_bristles_hold_below_static_friction_and_slide_at_coulomb_friction():
    coulomb, ratio = 0.1, 0.5
    plant = Plant("one mass", (find("inertia")(inertia=0.01),))
    plant += find("lugre_friction")(sigma0=100.0, sigma1=0.5, x0=coulomb / 100.0, ratio=ratio, speed=0.01)
    n, dt = 8000, 2.5e-4
    drive = np.tile([0.7 * coulomb * (1 + ratio), 1.1 * coulomb * (1 + ratio), 1.2 * coulomb], (n, 1))
    drive[: n // 2, :2] *= np.linspace(0.0, 1.0, n // 2)[:, None]  # slowly: a step would break the bristles loose
    drive[: n // 8, 2] = 2.0 * coulomb  # already sliding
    run = open_loop(plant, drive, dt, 2)
    v = run["v"]
    assert abs(v[-1, 0]) < 1e-6 and v[-1, 1] > 1.0
    rate = (v[-1] - v[-2001]) / (2000 * dt)
    np.testing.assert_allclose(rate[1:] * 0.01, drive[-1, 1:] - coulomb, rtol=1e-6)


def test_the_friction_of_a_scenario_is_that_of_its_bristles():
    mass, lugre = find("inertia")(inertia=0.01), find("lugre_friction")(x0=1e-3, speed=0.05)
    drive = np.tile(0.4 * np.sin(np.arange(600) * 0.02), (2, 1)).T
    plain, twice = (
        open_loop(Plant("one mass", (mass, lugre(sigma0=50.0 * k, sigma1=0.1 * k))), drive, 5e-4, 2, scenarios=given)
        for k, given in ((1.0, ScenarioArrays(2, friction=np.array([2.0, 1.0]))), (2.0, ScenarioArrays(2)))
    )
    assert (plain["q"][:, 0] == twice["q"][:, 0]).all() and (plain["q"][1:, 1] != twice["q"][1:, 1]).any()


def test_deflection_and_levers_are_those_of_identification():
    plant = elastic() + gear()(cosine=2e-4) + find("backlash")(half_width=1e-3)
    rng = np.random.default_rng(3)
    motor = rng.uniform(-0.1, 0.1, 40)
    load = motor + rng.uniform(-5e-3, 5e-3, 40)
    x, by_motor, by_load = Bodies(SimpleNamespace(t=0.0, dt=1e-4), None).mapped(plant, motor - load, motor, load)
    symbols = Symbols()
    _, torque, _, lever = joint(plant.effects, fixed_signals(symbols), symbols)
    rows = [symbols.state("q"), symbols.state("load.q")]
    values = constants_of(plant, symbols, {})
    given = ca.Function("f", [*rows, *symbols.constants.values()], [torque, lever["motor"], lever["load"]])
    rest = [values.get(n, 0.0) for n in symbols.constants]
    found = np.array([[float(v) for v in given(m, q, *rest)] for m, q in zip(motor, load, strict=True)])
    np.testing.assert_allclose(
        found, np.stack(np.broadcast_arrays(STIFFNESS * x, by_motor, by_load), axis=1), rtol=1e-12, atol=1e-12
    )
    assert (x == 0.0).any() and (x != 0.0).any()


def test_in_a_gap_an_elastic_joint_carries_no_torque_and_a_hysteretic_one_what_it_holds():
    """A gap is in series with the joint: what the joint holds, both bodies feel, also while the gap is crossed."""
    plant = elastic() + find("backlash")(half_width=1e-3)
    motor, load = np.array([0.0, 5e-4, 2e-3]), np.zeros(3)
    x, by_motor, by_load = Bodies(SimpleNamespace(t=0.0, dt=1e-4), None).mapped(plant, motor - load, motor, load)
    np.testing.assert_allclose(STIFFNESS * x * by_motor, STIFFNESS * np.array([0.0, 0.0, 1e-3]), rtol=1e-12)
    assert (by_motor, by_load) == (1.0, -1.0)


def crossings(x: np.ndarray, dt: float) -> np.ndarray:
    """Times at which x rises through zero, linear between samples."""
    at = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    return (at - x[at] / (x[at + 1] - x[at])) * dt


def test_two_free_masses_swing_at_their_own_frequency():
    n, dt = 4000, 1e-4
    drive = np.zeros(n)
    drive[:5] = 1.0
    run = open_loop(elastic(), drive, dt, 4)
    times = crossings((run["q"] - run["load.q"])[10:, 0], dt)
    frequency = (times.size - 1) / (times[-1] - times[0])
    exact = np.sqrt(STIFFNESS * (1 / MOTOR + 1 / LOAD)) / (2 * pi)
    assert times.size > 20 and frequency == pytest.approx(exact, rel=1e-3)
    momentum = MOTOR * run["v"][10:, 0] + LOAD * run["load.v"][10:, 0]
    np.testing.assert_allclose(momentum, 5 * dt * 1.0, rtol=1e-9)


def energy(run, stiffness: float, deflection: np.ndarray) -> np.ndarray:
    return 0.5 * MOTOR * run["v"] ** 2 + 0.5 * LOAD * run["load.v"] ** 2 + 0.5 * stiffness * deflection**2


def test_a_joint_gives_no_energy():
    n, dt = 8000, 1e-4
    t = np.arange(n) * dt
    drive = np.where(t < 0.3, 0.4 * np.sin(2 * pi * 6.0 * t), 0.0)
    error = gear(3e-4)
    gap = elastic() + error + find("backlash")(half_width=2e-4)
    lossy = elastic() + error + find("presliding_hysteresis")(h0=0.05, x0=2e-4, at="joint")
    left = {}
    for name, plant in (("gap", gap), ("lossy", lossy)):
        run = open_loop(plant, drive, dt, 8)
        q, load = run["q"][:, 0], run["load.q"][:, 0]
        x = q - load + 3e-4 * np.sin(100.0 * q)
        if name == "gap":
            x = x - np.clip(x, -2e-4, 2e-4)
        left[name] = energy({k: run[k][:, 0] for k in ("v", "load.v")}, STIFFNESS, x)
    free = t > 0.3
    # what is left swings about what it was, and neither grows nor fades
    np.testing.assert_allclose(left["gap"][free], left["gap"][free][0], rtol=0.02)
    lossy = left["lossy"][free]
    assert lossy[-1] < 0.999 * lossy[0] and lossy.max() < 1.02 * lossy[0]


def test_a_load_that_is_held_stays_and_the_motor_swings_on_the_joint():
    n, dt = 3000, 1e-4
    drive = np.zeros((n, 2))
    drive[:5] = 1.0
    arrays = ScenarioArrays(2, locked=np.array([1.0, 0.0]), start=np.array([0.4, 0.4]))
    run = open_loop(elastic(), drive, dt, 4, scenarios=arrays)
    assert (run["load.q"][:, 0] == 0.4).all() and (run["load.v"][:, 0] == 0.0).all()
    assert (run["load.q"][10:, 1] > 0.4).all()
    times = crossings(run["q"][10:, 0] - 0.4, dt)
    frequency = (times.size - 1) / (times[-1] - times[0])
    assert frequency == pytest.approx(np.sqrt(STIFFNESS / MOTOR) / (2 * pi), rel=1e-3)


def test_a_stiff_joint_is_one_mass():
    friction = find("viscous_friction")(viscous=0.05)
    one = Plant("one mass", (find("inertia")(inertia=MOTOR + LOAD), friction))
    two = elastic(2e6) + friction(at="motor")
    loop, law = Loop(2.5e-4, 40, velocity_filter=5e-4), fixed_pd(20.0, 0.6)
    many = [Scenario(target=0.3, load_inertia=0.002), Scenario(target=-0.1, inertia=1.2, friction=2.0)]
    a, b = (simulate(p, loop, law, many, 0.4, record=("v",)) for p in (one, two))
    np.testing.assert_allclose(b.time_1pct, a.time_1pct, rtol=2e-3)
    np.testing.assert_allclose(b.overshoot, a.overshoot, atol=2e-4)
    np.testing.assert_allclose(b.final_position, a.final_position, rtol=1e-3)


def test_the_load_encoder_sees_what_the_gear_hides_from_the_motor():
    plant = elastic() + gear(3e-4) + find("viscous_friction")(viscous=0.3, at="motor")
    plant += find("viscous_friction")(viscous=0.05, at="load")
    many = [Scenario(target=t) for t in (0.1, 0.157, 0.21)]
    law = fixed_pd(15.0, 0.1)
    error = {
        f: simulate(plant, Loop(2.5e-4, 4, feedback=f, velocity_filter=1e-3), law, many, 1.5).final_error
        for f in ("position", "load_position")
    }
    angle = 100.0 * np.array([s.target for s in many])
    hidden = abs(3e-4 * np.sin(angle))
    np.testing.assert_allclose(error["position"], hidden, rtol=1e-3)
    assert (error["load_position"] < 1e-6).all()


def test_a_start_away_from_zero_does_not_wind_up_the_joint():
    arrays = ScenarioArrays(4, start=np.array([0.0, 0.013, -0.4, 2.0]))
    run = open_loop(elastic() + gear(1e-3), np.zeros((50, 4)), 2.5e-4, 2, scenarios=arrays)
    np.testing.assert_array_equal(run["load.q"][0], arrays.start)
    assert abs(run["load.q"] - arrays.start).max() < 1e-12
    assert abs(run["q"][0, 1:] - arrays.start[1:]).min() > 1e-5


def expm(a: np.ndarray) -> np.ndarray:
    """Matrix exponential by scaling and squaring of its series."""
    squarings = max(0, int(np.ceil(np.log2(max(np.abs(a).sum(axis=1).max(), 1e-9)))) + 4)
    scaled, term, total = a / 2.0**squarings, np.eye(len(a)), np.eye(len(a))
    for i in range(1, 15):
        term = term @ scaled / i
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return total


def test_a_resonance_in_closed_loop_has_the_frequency_of_the_matrix_exponential():
    rigid, part, w, zeta, kp, kd = 0.008, 0.004, 2 * pi * 60.0, 0.01, 60.0, 0.05
    plant = Plant("one mass", (find("inertia")(inertia=rigid),))
    plant += find("flexible_mode")(mass=part, frequency=w / (2 * pi), damping=zeta)
    loop, target = Loop(1e-4, 4), 0.01
    run = simulate(plant, loop, fixed_pd(kp, kd), [Scenario(target=target)], 0.6, record=("q", "flexible_mode@axis.y"))
    # q, v, y, dy: J a - m (w^2 y + 2 zeta w dy) = u; ddy + 2 zeta w dy + w^2 y = -a
    swing = np.array([0.0, 0.0, w * w, 2 * zeta * w])
    a = swing * part / rigid
    free = np.array([[0, 1, 0, 0], a, [0, 0, 0, 1], -swing - a])
    force = np.array([0.0, 1.0, 0.0, -1.0])[:, None] / rigid
    whole = expm(np.block([[free, force], [np.zeros((1, 5))]]) * loop.sample_time)
    ad, bd = whole[:4, :4], whole[:4, 4]
    # the law reads the position now and one sample ago: u = kp (r - q) - kd (q - before)/Ts
    rate = kd / loop.sample_time
    closed = np.zeros((5, 5))
    closed[:4, :4], closed[4, 0] = ad, 1.0
    closed[:4, 0] -= bd * (kp + rate)
    closed[:4, 4] += bd * rate
    x, states = np.zeros(5), []
    for _ in range(6000):
        states.append(x)
        x = closed @ x + np.append(bd, 0.0) * kp * target
    states = np.array(states)
    y, exact = run.trajectories["flexible_mode@axis.y"][:, 0], states[:, 2]
    ours, theirs = (len(c) - 1 for c in (crossings(y, 1e-4), crossings(exact, 1e-4)))
    found, expected = crossings(y, 1e-4), crossings(exact, 1e-4)
    n = min(ours, theirs, 12)
    assert n > 5
    assert (found[n] - found[0]) == pytest.approx(expected[n] - expected[0], rel=0.01)


def test_identification_recovers_the_joint_that_was_simulated():
    dt, n = 2.5e-4, 12000
    plant = elastic(150.0)
    plant += find("viscous_friction")(viscous=0.03, at="motor")
    plant += find("viscous_friction")(viscous=0.02, at="load")
    t = np.arange(n) * dt
    drive = np.stack(
        [sum(a * np.sin(2 * pi * f * s * t + i) for a, f in ((0.3, 0.9), (0.3, 7.3), (0.3, 17.1), (0.3, 27.0)))
         for i, s in enumerate((1.0, 1.13))], axis=1)  # fmt: skip
    run = open_loop(plant, drive, dt, 4, resolution=COUNT / 16, load_resolution=COUNT / 16)
    acting = 0.5 * (
        drive + np.vstack([drive[:1], drive[:-1]])
    )  # held over each sample, so its mean about the sample's instant
    records = [
        Record(
            name=f"run_{i}",
            role="identification",
            time=t.copy(),
            channels={
                "torque": acting[:, i].copy(),
                "position": run["y"][:, i].copy(),
                "load_position": run["load.y"][:, i].copy(),
            },
            units={"torque": "N*m", "position": "rad", "load_position": "rad"},
            source=Source(Path("simulated"), "", "", {}),
            resolution={"position": COUNT / 16, "load_position": COUNT / 16},
        )
        for i in range(2)
    ]
    guess = plant.swap(plant["linear_stiffness"](stiffness=300.0)).swap(find("inertia")(inertia=0.004, at="load"))
    fit = identify(guess, inverse_dynamics(records, 60.0))
    for key, name in (("linear_stiffness", "stiffness"), ("inertia@motor", "inertia"), ("inertia@load", "inertia")):
        assert fit.plant[key].parameters[name].value == pytest.approx(plant[key].parameters[name].value, rel=0.03), key


def test_what_two_masses_cannot_do_is_a_sentence():
    law, loop, one = fixed_pd(1.0, 0.1), Loop(1e-4), [Scenario(target=1.0)]
    with pytest.raises(WorkbenchError, match="the load has no inertia.*at the load"):
        simulate(Plant("two mass", bodies()[:1]), loop, law, one, 0.1)
    with pytest.raises(WorkbenchError, match="mass of the motor is 0"):
        simulate(Plant("two mass", bodies(motor=0.0)), loop, law, one, 0.1)
    with pytest.raises(WorkbenchError, match="'load_position', but a plant of one mass"):
        simulate(Plant("one mass"), Loop(1e-4, feedback="load_position"), law, one, 0.1)
    with pytest.raises(WorkbenchError, match="no load of its own"):
        simulate(Plant("one mass"), loop, law, [Scenario(locked=1.0)], 0.1)
    with pytest.raises(WorkbenchError, match="locked is 1"):
        ScenarioArrays(1, locked=0.5)
    with pytest.raises(WorkbenchError, match="feedback 'load' is no reading"):
        Loop(1e-4, feedback="load")
    with pytest.raises(WorkbenchError, match="slope of its angle maps"):
        simulate(elastic() + gear(0.05), loop, law, [Scenario(start=0.3)], 0.1)

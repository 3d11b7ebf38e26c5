"""The sampled loop in lanes, held against NumPy, single lanes, closed forms and its own limits."""

from math import pi
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control import Table, fixed_pd, gains_at, grid, pi_cascade, scheduled_pd
from workbench.definition import FORCE, Effect, find
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.parameter import Parameter
from workbench.plant import Limits, Plant
from workbench.record import Record, Source
from workbench.simulation import Loop, Scenario, ScenarioArrays, open_loop, simulate
from workbench.simulation.binding import bind
from workbench.simulation.criteria import Criteria
from workbench.simulation.metrics import entry_time
from workbench.simulation.oracle import run_arrays
from workbench.simulation.run import run_lanes
from workbench.simulation.scenario import arrays_of

COUNT = 2.0 * pi / 2**20
KNOTS = grid(4.0 * COUNT, 2e-3)
SCHEDULE = SimpleNamespace(knots=KNOTS, kp=200.0 * (KNOTS / KNOTS[0]) ** -0.2, kd=2.0 * (KNOTS / KNOTS[0]) ** -0.1)
INERTIA, VISCOUS = 0.01, 0.02


def plain(viscous: float = VISCOUS, **limits) -> Plant:
    effects = (find("inertia")(inertia=INERTIA), find("viscous_friction")(viscous=viscous))
    return Plant("one mass", effects, limits=Limits(**limits))


def rich(seed: int) -> Plant:
    """Friction without memory of its own (so with the stop operator), a map of the command, a delay and all limits."""
    rng = np.random.default_rng(seed)
    return (
        plain(rng.uniform(0.01, 0.05), drive=2.0, speed=1.0)
        + find("coulomb_friction")(coulomb=rng.uniform(0.05, 0.2))
        + find("cogging")(s1=0.02, c1=0.01, order=rng.uniform(20.0, 60.0))
        + find("actuator_lag")(time_constant=2e-4)
        + find("transport_delay")(delay=3e-4)
    )


def scenarios(n: int, seed: int = 0, noise: float = 0.01) -> list[Scenario]:
    rng = np.random.default_rng(seed)
    return [
        Scenario(
            target=rng.uniform(-0.05, 0.05),
            inertia=rng.uniform(0.8, 1.3),
            friction=rng.uniform(0.5, 1.5),
            load=rng.uniform(-0.02, 0.02),
            noise=noise * (i % 3),
            phase=rng.uniform(),
            delay=7e-5 * (i % 5),
            start=rng.uniform(-0.01, 0.01),
            seed=i,
        )
        for i in range(n)
    ]


LIVELY = SimpleNamespace(knots=KNOTS, kp=SCHEDULE.kp, kd=0.05 * SCHEDULE.kd)  # too little damping: it overshoots
LOOP = Loop(1e-4, 2, velocity_filter=5e-4, resolution=COUNT)
CONTROLLERS = [
    scheduled_pd([SCHEDULE, LIVELY], "following", table=np.arange(37) % 2),
    scheduled_pd(SCHEDULE, "frozen", scale=np.linspace(0.5, 1.0, 37)),
    pi_cascade(30.0, 1.0, 20.0, np.linspace(0.5, 2.0, 37)),
    scheduled_pd(SCHEDULE, "closing"),
]


@pytest.mark.parametrize("which", [0, 1, 2, 3])
def test_lanes_have_the_bits_of_numpy_over_scenarios(which):
    bound = bind(rich(which), LOOP, CONTROLLERS[which], arrays_of(scenarios(37, which)), 700, Criteria())
    lanes, _ = run_lanes(bound)
    arrays, _ = run_arrays(bound)
    assert set(lanes) <= set(arrays) | {"u"}
    for name, value in arrays.items():
        np.testing.assert_array_equal(lanes[name], value, err_msg=name)


def test_a_lane_alone_and_any_number_of_threads_give_the_same_bits():
    given = rich(0), LOOP, CONTROLLERS[0], scenarios(37, 0), 0.07
    base = simulate(*given, threads=1)
    for other in (simulate(*given, threads=2), simulate(*given, lanes=1)):
        for name in ("time_1pct", "overshoot", "final_error", "settling", "ripple", "reversals", "final_position"):
            np.testing.assert_array_equal(getattr(other, name), getattr(base, name), err_msg=name)


def hysteretic() -> Plant:
    return plain(0.05) + find("presliding_hysteresis")(h0=0.15, x0=2e-3, d=1.0)


def excitation(n: int, dt: float, lanes: int = 3) -> np.ndarray:
    """Torque (n, lanes) of three sines a lane, from presliding to gross motion."""
    t = np.arange(n) * dt
    lane = np.arange(lanes)
    return sum(
        a * np.sin(2.0 * pi * f * (1.0 + 0.17 * lane) * t[:, None] + lane)
        for a, f in ((0.3, 0.7), (0.15, 3.1), (0.1, 11.0))
    )


def test_a_neutral_effect_changes_no_result():
    drive = excitation(400, 1e-3)
    base = open_loop(plain() + find("coulomb_friction")(coulomb=0.05), drive, 1e-3)
    spring = find("cable_spring")(stiffness=0.0, preload=0.0)
    more = open_loop(plain() + find("coulomb_friction")(coulomb=0.05) + spring, drive, 1e-3)
    assert (base["q"] == more["q"]).all() and (base["v"] == more["v"]).all()


def test_friction_takes_energy_and_never_gives_it():
    drive = excitation(3000, 1e-3)
    run = open_loop(hysteretic(), drive, 1e-3, substeps=4)
    work = np.cumsum(drive[:-1] * np.diff(run["q"], axis=0), axis=0)
    kinetic = 0.5 * INERTIA * run["v"][1:] ** 2
    assert (work - kinetic > -1e-6 * work.max()).all()
    assert (work[-1] > kinetic[-1]).all()


def logged(plant: Plant, drive: np.ndarray, dt: float) -> list[Record]:
    """Records of the open loop of a plant under drives (n, lanes)."""
    run = open_loop(plant, drive, dt, substeps=4, resolution=COUNT)
    return [
        Record(
            name=f"run_{i}",
            role="identification",
            time=np.arange(len(drive)) * dt,
            channels={"torque": drive[:, i].copy(), "position": run["y"][:, i].copy()},
            units={"torque": "N*m", "position": "rad"},
            source=Source(Path("simulated"), "", "", {}),
            resolution={"position": COUNT},
        )
        for i in range(drive.shape[1])
    ]


def test_identification_recovers_what_was_simulated():
    plant = hysteretic()
    records = logged(plant, excitation(8000, 5e-4), 5e-4)
    guess = plant.swap(plant["presliding_hysteresis"](h0=0.3, x0=5e-3)).swap(plant["inertia"](inertia=0.02))
    fit = identify(guess, inverse_dynamics(records, 40.0))
    for key, name in (
        ("inertia", "inertia"),
        ("viscous_friction", "viscous"),
        ("presliding_hysteresis", "h0"),
        ("presliding_hysteresis", "x0"),
    ):
        assert fit.plant[key].parameters[name].value == pytest.approx(plant[key].parameters[name].value, rel=0.03), name
    assert fit.identification < 0.02


def test_coulomb_friction_beside_hysteresis_is_another_contact():
    """With the hysteresis' own direction it would be the same force twice, and neither would be determined."""
    plant = hysteretic() + find("coulomb_friction")(coulomb=0.05)
    records = logged(plant, excitation(8000, 5e-4), 5e-4)
    guess = plant.swap(plant["presliding_hysteresis"](h0=0.3, x0=5e-3)).swap(plant["coulomb_friction"](coulomb=0.01))
    fit = identify(guess, inverse_dynamics(records, 40.0))
    assert fit.plant["coulomb_friction"].parameters["coulomb"].value == pytest.approx(0.05, rel=0.05)
    assert fit.plant["presliding_hysteresis"].parameters["h0"].value == pytest.approx(0.15, rel=0.03)
    assert fit.identification < 0.02


def test_a_free_mass_under_constant_torque_has_its_closed_form():
    n, dt, substeps, torque = 500, 1e-3, 2, 0.1
    run = open_loop(plain(viscous=0.0), np.full((n, 1), torque), dt, substeps)
    h, k = dt / substeps, np.arange(n) * substeps
    np.testing.assert_allclose(run["v"][:, 0], torque / INERTIA * h * k, rtol=1e-12, atol=1e-15)
    # Semi-implicit Euler: q = a h^2 (1 + 2 + ... + k).
    np.testing.assert_allclose(run["q"][:, 0], torque / INERTIA * h * h * k * (k + 1) / 2, rtol=1e-11, atol=1e-15)


def test_a_delay_shifts_the_response_by_whole_substeps():
    drive, dt, substeps = excitation(300, 1e-3), 1e-3, 1
    prompt = open_loop(plain(), drive, dt, substeps)
    late = open_loop(plain() + find("transport_delay")(delay=7e-3), drive, dt, substeps)
    assert (late["q"][7:] == prompt["q"][:-7]).all()
    assert (late["q"][:8] == 0.0).all()


def test_the_delay_of_each_scenario_is_its_own():
    drive, dt = excitation(300, 1e-3, 1).repeat(4, axis=1), 1e-3
    arrays = ScenarioArrays(4, delay=np.array([0.0, 0.5e-3, 1e-3, 5e-3]))
    q = open_loop(plain(), drive, dt, 2, scenarios=arrays)["q"]
    assert (q[1:, 2] == q[:-1, 0]).all() and (q[5:, 3] == q[:-5, 0]).all()
    assert ((q[3:, 1] - q[3:, 0]) != 0.0).all()


def test_the_time_to_one_percent_is_that_of_the_second_order_response():
    w, dt = 20.0, 2e-5
    plant = plain(2.0 * INERTIA * w)  # critically damped: e = (1 + w t) exp(-w t)
    loop = Loop(dt, 8)
    m = simulate(
        plant, loop, fixed_pd(INERTIA * w * w, 0.0), [Scenario(target=0.3), Scenario(target=-2.0)], 0.6, own=True
    )
    exact = 6.638352067993812 / w
    # The command is held for a sample: half a sample late, which takes kp dt/2 from the damping.
    assert abs(m.time_1pct - exact).max() < 4.0 * dt
    assert abs(m.time_1pct[0] - m.time_1pct[1]) < 1e-3 * dt
    assert abs(m.time_own - m.time_1pct).max() < 1e-3
    assert (m.overshoot == 0.0).all() and m.finite.all()


def test_the_time_of_entry_is_linear_between_samples():
    rows = {"k_outside": np.array([4.0, -1.0, 9.0]), "e_outside": np.array([0.03, 0.0, 1.0])}
    rows |= {"e_inside": np.array([-0.01, 0.0, 0.5]), "outside": np.array([0.0, 0.0, 1.0])}
    time = entry_time(rows, 1.0, 0.01, 0.1)
    np.testing.assert_allclose(time, [0.45, 0.0, np.inf])


def test_torque_and_speed_limits_are_obeyed():
    plant = plain(drive=0.5, speed=0.8)
    many = [Scenario(target=t, inertia=factor) for t in (0.1, 2.0, -2.0) for factor in (0.5, 1.0, 2.0)]
    m = simulate(plant, LOOP, fixed_pd(50.0, 0.5), many, 1.0, record=("v", "u"))
    assert (m.peak_torque <= 0.5).all() and (abs(m.trajectories["u"]) <= 0.5).all()
    fast = abs(m.trajectories["v"]).max(axis=0)
    np.testing.assert_array_equal(fast, m.peak_speed)
    assert (fast <= 0.8 * 1.001).all() and (fast[3:] > 0.75).all()


def plainly_detected(y: np.ndarray, back: float) -> tuple[np.ndarray, np.ndarray]:
    """Amplitude of the equivalent motion and number of reversals of readings (n,), by plain branches."""
    furthest = turned = y[0]
    way, share, found = 0, 1.0, 0
    amplitude, count = np.empty(y.size), np.empty(y.size)
    for k, reading in enumerate(y):
        delta = reading - furthest
        if way * delta > 0:
            furthest = reading
        elif abs(delta) > back:
            turned, furthest = furthest, reading
            if way:
                share, found = 0.5, found + 1
            way = 1 if delta > 0 else -1
        amplitude[k], count[k] = share * abs(reading - turned), found
    return amplitude, count


def test_gains_follow_the_stroke_since_the_last_reversal():
    names = ("y", "amplitude", "reversals", "kp")
    m = simulate(rich(5), LOOP, scheduled_pd(LIVELY), scenarios(6, 5), 0.3, record=names)
    t = m.trajectories
    assert m.reversals.max() > 2
    for lane in range(6):
        amplitude, count = plainly_detected(t["y"][:, lane], 2.5 * COUNT)
        np.testing.assert_array_equal(t["reversals"][:, lane], count)
        clipped = np.clip(amplitude, KNOTS[0], KNOTS[-1])
        np.testing.assert_array_equal(t["amplitude"][:, lane], clipped)
        np.testing.assert_allclose(t["kp"][:, lane], np.interp(clipped, KNOTS, SCHEDULE.kp), rtol=1e-12)


def test_frozen_gains_change_at_reversals_only():
    m = simulate(
        rich(5),
        LOOP,
        scheduled_pd(SCHEDULE, "frozen"),
        scenarios(6, 5),
        0.2,
        record=("kp", "reversals", "y", "amplitude"),
    )
    t, targets = m.trajectories, [s.target for s in scenarios(6, 5)]
    changed = np.diff(t["kp"], axis=0) != 0.0
    reversed_ = np.diff(t["reversals"], axis=0) != 0.0
    assert m.reversals.max() > 2 and changed.any()
    assert not (changed & ~reversed_).any()
    promised = np.clip(0.5 * abs(np.array(targets) - t["y"]), KNOTS[0], KNOTS[-1])
    np.testing.assert_array_equal(t["amplitude"][1:][reversed_], promised[1:][reversed_])


def test_the_cascade_leaves_no_error_under_load():
    m = simulate(plain(drive=2.0), Loop(1e-4), pi_cascade(30.0, 1.0, 20.0, 1.0), [Scenario(target=0.2, load=0.3)], 1.5)
    assert m.final_error[0] < 1e-9 and m.peak_speed[0] < 1.1 and m.overshoot[0] < 0.2


def test_a_run_that_goes_to_infinity_is_reported_and_harms_no_other():
    kp = np.array([50.0, -1e9, 50.0])
    m = simulate(plain(), LOOP, fixed_pd(kp, 1.0), [Scenario(target=0.1)] * 3, 0.5)
    np.testing.assert_array_equal(m.finite, [True, False, True])
    for values in (m.time_1pct, m.final_error, m.overshoot, m.peak_torque, m.peak_speed, m.ripple):
        assert np.isinf(values[1]) and np.isfinite(values[[0, 2]]).all()


def test_every_scenario_may_have_a_plant_of_its_own():
    plants = [plain(viscous) for viscous in (0.01, 0.02, 0.05)]
    many = [Scenario(target=0.1)] * 3
    together = simulate(plants, LOOP, fixed_pd(20.0, 0.5), many, 0.2)
    for i, plant in enumerate(plants):
        alone = simulate(plant, LOOP, fixed_pd(20.0, 0.5), many[:1], 0.2)
        assert alone.final_position[0] == together.final_position[i]
    with pytest.raises(WorkbenchError, match="2 plants for 3 scenarios"):
        simulate(plants[:2], LOOP, fixed_pd(20.0, 0.5), many, 0.2)


def forced(step, **more) -> Effect:
    made = {"name": "trial", "cause": "", "formula": "", "source": "", "port": FORCE, "reads": ("a",)}
    return Effect(**(made | {"parameters": {"m": Parameter(0.1, "1", "m")}, "step": step} | more))


def test_what_cannot_be_simulated_is_a_sentence():
    law, one = fixed_pd(1.0, 0.1), [Scenario(target=1.0)]
    with pytest.raises(WorkbenchError, match="has no inertia"):
        simulate(Plant("one mass", (find("viscous_friction")(),)), LOOP, law, one, 0.1)
    with pytest.raises(WorkbenchError, match="not affine in acceleration"):
        simulate(plain() + forced(lambda s, z, p: ({}, p.m * s.a * s.a)), LOOP, law, one, 0.1)
    with pytest.raises(WorkbenchError, match="implicit cycle"):
        cycle = forced(lambda s, z, p: ({}, s.dir, {"dir": s.dir}), reads=("dir",), provides=("dir",))
        simulate(plain() + cycle, LOOP, law, one, 0.1)
    with pytest.raises(WorkbenchError, match="must be positive"):
        simulate(plain().swap(find("inertia")(inertia=0.0)), LOOP, law, one, 0.1)
    for duration in (0.0, -1.0, float("nan")):
        with pytest.raises(WorkbenchError, match="duration"):
            simulate(plain(), LOOP, law, one, duration)
    with pytest.raises(WorkbenchError, match="no scenario"):
        simulate(plain(), LOOP, law, [], 0.1)
    with pytest.raises(WorkbenchError, match="kp has shape"):
        simulate(plain(), LOOP, fixed_pd(np.ones(3), 0.1), one, 0.1)
    with pytest.raises(WorkbenchError, match="no signal 'positon'"):
        simulate(plain(), LOOP, law, one, 0.1, record=("positon",))
    with pytest.raises(WorkbenchError, match="sample time"):
        Loop(0.0)


def test_under_the_rule_closing_a_short_move_has_gains_of_its_own_and_a_long_one_ends_with_those_of_40_counts():
    """Up to 40 counts it is a fixed PD with the gains of the move's size; a longer one ends as a fixed PD with those of 40 counts."""
    loop, gains = (
        Loop(1e-4, 2, velocity_filter=5e-4, resolution=COUNT),
        Table(KNOTS, {"kp": SCHEDULE.kp, "kd": SCHEDULE.kd}),
    )
    for size, met in ((10.0, 10.0), (35.0, 35.0), (40.0, 40.0)):
        kp, kd = gains_at(gains, met * COUNT)
        lanes = ScenarioArrays(1, target=size * COUNT, phase=0.5)
        ours, fixed = (
            simulate(hysteretic(), loop, c, lanes, 0.05, ("y",)).trajectories["y"]
            for c in (scheduled_pd(SCHEDULE, "closing"), fixed_pd(kp, kd))
        )
        np.testing.assert_allclose(ours, fixed, atol=1e-12)
    kp, kd = gains_at(gains, 40.0 * COUNT)
    lanes = ScenarioArrays(1, target=2000.0 * COUNT, phase=0.5)
    run = simulate(plain(), loop, scheduled_pd(SCHEDULE, "closing"), lanes, 0.5, ("y", "vh", "u_c")).trajectories
    y, vh, u = (run[n][:, 0] for n in ("y", "vh", "u_c"))
    near = np.abs(2000.0 * COUNT - y) < 40.0 * COUNT
    assert near.sum() > 100 and np.ptp(y[near]) > 10.0 * COUNT
    np.testing.assert_allclose(u[near], kp * (2000.0 * COUNT - y[near]) - kd * vh[near], rtol=1e-9, atol=1e-12)

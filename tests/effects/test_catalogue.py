"""Every effect of the catalogue against what its law says: closed forms, differential equations, inverses, errata."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from workbench.catalogue_page import page
from workbench.definition import ANGLE, SENSOR, Effect, catalogue, find
from workbench.effects.creep import creep
from workbench.effects.fading import fading_memory
from workbench.effects.gap import friction_behind_gap
from workbench.effects.hysteresis import knots, maxwell_slip
from workbench.effects.periodic import cogging
from workbench.effects.play import inverse, play_bank
from workbench.effects.virgin_curve import slip_of_curve
from workbench.errors import WorkbenchError
from workbench.kernel import step
from workbench.plant import ONE_MASS, TWO_MASS, Plant, places
from workbench.tracing.candidates import WHOLE

NAMES = (
    "inertia viscous_friction coulomb_friction presliding_hysteresis stribeck_friction nonlinear_viscous_friction "
    "coulomb_asymmetry load_dependent_friction friction_drift lugre_friction cyclic_friction cogging kinematic_error "
    "encoder_eccentricity linear_stiffness linear_damping cubic_stiffness piecewise_stiffness multi_body_compliance "
    "backlash creep fading_memory cable_spring gravity constant_offset sensor_trend transport_delay actuator_lag "
    "torque_constant_saturation flexible_mode clock_skew friction_behind_gap"
).split()


def output(effect: Effect, **signals) -> np.ndarray:
    """Output of an effect along signals, with the values that it carries."""
    values = {n: p.value for n, p in effect.parameters.items()}
    n = max(np.size(s) for s in signals.values())
    full = {name: np.broadcast_to(np.asarray(s, float), n) for name, s in signals.items()}
    columns = step.build(effect).run(full, values)
    weights = [values[c] for c in effect.linear] or [1.0]
    return sum(w * c for w, c in zip(weights, columns, strict=False))


def walk(n: int = 4000, seed: int = 7, size: float = 1e-3) -> np.ndarray:
    """A position that wanders over several `size`, from 0."""
    x = np.cumsum(np.cumsum(np.random.default_rng(seed).normal(size=n)))
    x = x - np.linspace(0.0, x[-1], n)
    return 3.0 * size * (x - x[0]) / np.abs(x).max()


def test_every_name_of_the_campaign_format_is_known():
    assert not set(NAMES) - set(catalogue())


def test_the_page_of_the_catalogue_is_the_catalogue():
    """Written anew by: python -m workbench.catalogue_page > docs/catalogue.md"""
    committed = Path(__file__).resolve().parents[2] / "docs" / "catalogue.md"
    assert committed.read_text(encoding="utf-8") == page()


def test_an_effect_is_named_as_its_function():
    assert all(e.name == name for name, e in catalogue().items())


def test_other_spellings_are_no_candidates():
    plant = Plant(ONE_MASS, (find("inertia")(inertia=1.0), find("coulomb_friction")(coulomb=1.0)))
    offered = {s.effect for s in WHOLE.candidates(plant)}
    assert {"creep", "lugre_friction", "presliding_hysteresis", "flexible_mode", "actuator_lag"} <= offered
    assert not offered & {n for n, e in catalogue().items() if not e.traced}
    # what bears another effect's name is traced under it
    other = {n for n, e in catalogue().items() if not e.traced or e.nearest}
    assert other == set(catalogue()) - set(NAMES)


def test_a_spring_to_ground_may_be_declared_as_a_stiffness_of_the_axis_and_is_offered_as_a_cable_spring():
    plant = Plant(ONE_MASS, (find("inertia")(inertia=1.0),))
    assert {s.effect for s in WHOLE.candidates(plant)} & {"linear_stiffness", "cable_spring"} == {"cable_spring"}
    spring = plant + find("linear_stiffness")(at="axis", stiffness=3.0)
    assert spring["linear_stiffness"].at == "axis"
    assert "cable_spring" in {s.effect for s in WHOLE.candidates(spring)}  # it may rest elsewhere
    x = np.linspace(-1.0, 1.0, 5)
    np.testing.assert_array_equal(output(spring["linear_stiffness"], q=x), 3.0 * x)


def test_one_source_of_direction_is_enough():
    """A second one would change what other effects read, though its amplitude be zero."""
    plant = Plant(ONE_MASS, (find("inertia")(inertia=1.0), find("presliding_hysteresis")(h0=1.0)))
    assert "lugre_friction" not in {s.effect for s in WHOLE.candidates(plant)}


def test_kinematic_error_is_in_the_joint_where_there_is_one_else_at_the_sensor():
    effect = find("kinematic_error")
    assert (places(TWO_MASS, effect), places(ONE_MASS, effect)) == (("joint",), ("sensor.position",))
    assert (effect.port, effect(at="sensor.position").port) == (ANGLE, SENSOR)
    Plant(ONE_MASS, (effect(at="sensor.position"),))
    with pytest.raises(WorkbenchError, match="cannot act at 'axis'"):
        Plant(ONE_MASS, (effect(at="axis"),))


# --- closed forms -----------------------------------------------------------------------------------------------------


def test_a_piecewise_spring_has_the_sum_of_both_slopes_outside():
    x = np.array([-3e-3, -1e-3, -5e-4, 0.0, 5e-4, 2e-3])
    found = output(find("piecewise_stiffness")(k1=100.0, k2=40.0, threshold=1e-3), q=x)
    expected = np.where(np.abs(x) < 1e-3, 100.0 * x, 100.0 * x + 40.0 * (x - 1e-3 * np.sign(x)))
    np.testing.assert_allclose(found, expected, atol=1e-15)
    assert (found[0] - found[1]) / (x[0] - x[1]) == pytest.approx(140.0)


def test_two_slopes_are_odd():
    x = np.linspace(-3e-3, 3e-3, 25)
    effect = find("two_slope_stiffness")(inner=90.0, outer=20.0, knee=1e-3)
    np.testing.assert_allclose(output(effect, q=x), -output(effect, q=-x), atol=1e-15)
    assert output(effect, q=-3e-3)[0] == pytest.approx(20.0 * -3e-3 - 70.0 * 1e-3)


def test_multi_body_compliance_solves_its_law():
    outside = {
        "flexspline_stiffness": 8e3,
        "flexspline_torque": 12.0,
        "generator_stiffness": 2e4,
        "generator_torque": 5.0,
    }
    effect = find("multi_body_compliance").declared(outside, {}, "test")
    torque = np.concatenate([-np.geomspace(1e-6, 150.0, 400), [0.0], np.geomspace(1e-6, 150.0, 400)])
    x = 12.0 / 8e3 * np.arctan(torque / 12.0) + np.sign(torque) * 5.0 / 2e4 * (1.0 - np.exp(-np.abs(torque) / 5.0))
    np.testing.assert_allclose(output(effect, q=x), torque, rtol=1e-10)
    assert {n: p.value for n, p in effect.outside.items()} == pytest.approx(outside)
    far = output(effect, q=[2e-3 + 1e-3, 2e-3 + 2e-3])  # beyond the domain it goes on, finite and increasing
    assert np.isfinite(far).all() and far[1] > far[0]


@pytest.mark.parametrize(("softness", "c"), [(1e-4, 0.1), (1.0, 0.3), (30.0, 3.0), (1e3, 50.0)])
def test_multi_body_compliance_finds_its_torque_whichever_part_is_softer(softness, c):
    effect = find("multi_body_compliance")(torque=1.0, x_f=1e-3, x_w=softness * 1e-3, c=c)
    torque = np.geomspace(1e-5, 14.0, 200)
    x = 1e-3 * np.arctan(torque) - softness * 1e-3 * np.expm1(-c * torque)
    np.testing.assert_allclose(output(effect, q=x), torque, rtol=1e-6)


def test_cogging_of_more_harmonics_is_the_sum_of_waves():
    effect = cogging(3).declared(
        {"amplitude": 0.3, "phase": 0.4, "amplitude_3": 0.1, "phase_3": -1.0, "order": 7.0}, {}, ""
    )
    q = np.linspace(-2.0, 3.0, 101)
    np.testing.assert_allclose(output(effect, q=q), 0.3 * np.sin(7 * q + 0.4) + 0.1 * np.sin(21 * q - 1.0), atol=1e-14)
    assert cogging().formula == "T = A1 sin(k q + p1) + A2 sin(2 k q + p2)"


def test_cyclic_friction_without_direction_is_cogging():
    q = np.linspace(-2.0, 3.0, 101)
    cyclic = output(find("cyclic_friction")(cosine=0.2, sine=0.3, order=5.0), q=q, dir=1.0, v=0.0)
    np.testing.assert_array_equal(cyclic, output(find("cogging")(c1=0.2, s1=0.3, order=5.0), q=q))


def test_angle_and_sensor_maps_are_what_they_say():
    q = np.linspace(-3.0, 3.0, 41)
    error = {"amplitude": 1e-3, "phase": 0.5, "order": 60.0}
    kinematic = find("kinematic_error").declared(error, {}, "")
    np.testing.assert_allclose(output(kinematic, q=0.01, motor_q=q), 0.01 + 1e-3 * np.sin(60 * q + 0.5), atol=1e-15)
    eccentric = find("encoder_eccentricity").declared({"amplitude": 1e-3, "phase": 0.5}, {}, "")
    np.testing.assert_allclose(output(eccentric, q=q), q + 1e-3 * np.sin(q + 0.5), atol=1e-15)
    np.testing.assert_allclose(
        output(find("backlash")(half_width=0.5), q=q), np.sign(q) * np.maximum(np.abs(q) - 0.5, 0), atol=1e-15
    )
    assert output(find("sensor_trend")(rate=1e-3), q=2.0, t=4.0)[0] == 2.004
    assert output(find("clock_skew")(offset=1e-3, skew=1e-5), t=100.0)[0] == pytest.approx(2e-3)


def test_a_torque_constant_that_saturates_is_odd_and_increasing():
    u = np.linspace(0.0, 5.0, 101)
    found = output(find("torque_constant_saturation")(fall=0.04), u=u)
    np.testing.assert_allclose(found, u / np.sqrt(1 + 0.04 * u * u), rtol=1e-15)
    assert (np.diff(found) > 0).all() and np.array_equal(
        found, -output(find("torque_constant_saturation")(fall=0.04), u=-u)
    )


# --- states -----------------------------------------------------------------------------------------------------------


def test_creep_relaxes_as_exponentials_whatever_the_step():
    effect = creep(3)(k1=2.0, k2=3.0, k3=5.0, rate=0.7, ratio=4.0)
    for n in (50, 5000):
        t = np.linspace(0.0, 3.0, n + 1)[1:]
        force = output(effect, dq=np.full(n, 3.0 / n), dt=3.0 / n)  # q = t
        exact = sum(k * (1 - np.exp(-r * t)) / r for k, r in ((2.0, 0.7), (3.0, 2.8), (5.0, 11.2)))
        np.testing.assert_allclose(force, exact, rtol=1e-11)


@pytest.mark.parametrize(("frequency", "damping"), [(3.0, 0.02), (40.0, 0.5), (300.0, 0.05)])
def test_a_flexible_mode_is_the_matrix_exponential(frequency, damping):
    dt, m, w = 1e-3, 0.2, 2 * np.pi * frequency
    a = np.random.default_rng(3).normal(size=200).cumsum()
    force = output(find("flexible_mode")(mass=m, frequency=frequency, damping=damping), a=a, dt=dt)
    free = np.zeros((4, 4))  # y, dy/dt, a, slope of a
    free[0, 1] = free[2, 3] = 1.0
    free[1] = [-w * w, -2 * damping * w, -1.0, 0.0]
    over, state, before, expected = expm(free * dt), np.zeros(2), 0.0, []
    for now in a:
        state = (over @ np.array([*state, before, (now - before) / dt]))[:2]
        before = now
        expected.append(-m * (w * w * state[0] + 2 * damping * w * state[1]))
    np.testing.assert_allclose(force, expected, rtol=1e-8, atol=1e-10 * np.abs(expected).max())


def test_a_flexible_mode_far_above_the_motion_is_added_inertia():
    t = np.arange(0, 2, 1e-3)
    a = np.sin(2 * np.pi * t) ** 3
    force = output(find("flexible_mode")(mass=0.2, frequency=200.0, damping=0.3), a=a, dt=1e-3)
    np.testing.assert_allclose(force, 0.2 * a, atol=2e-3 * 0.2)


def test_a_part_of_the_declared_mass_is_a_mode_less_what_was_declared_of_it():
    a = np.random.default_rng(3).normal(size=400).cumsum()
    own = {"mass": 0.2, "frequency": 40.0, "damping": 0.05}
    mode, part = (output(find(n)(**own), a=a, dt=1e-3) for n in ("flexible_mode", "flexible_part"))
    np.testing.assert_allclose(part, mode - 0.2 * a, rtol=0.0, atol=1e-12 * np.abs(a).max())


def test_fading_memory_follows_its_differential_equation():
    effect = find("fading_memory").declared({"A": 90.0, "alpha": 600.0}, {}, "")
    x = walk(400)
    path, position = np.abs(np.diff(x)).cumsum(), x[1:]
    found, way = output(effect, dq=np.diff(x)), np.sign(np.diff(x))
    ends, force, exact = np.concatenate([[0.0], path]), 0.0, []
    for i in range(position.size):
        over = solve_ivp(lambda _, f, s=way[i]: 90.0 * s - 600.0 * f, ends[i : i + 2], [force], rtol=1e-9, atol=1e-12)
        force = over.y[0, -1]
        exact.append(force)
    np.testing.assert_allclose(found, exact, atol=1e-7 * np.abs(exact).max())
    np.testing.assert_allclose(found, output(effect, dq=np.repeat(np.diff(x) / 3, 3))[2::3], atol=1e-12)


def test_several_elements_of_fading_memory_add():
    x, two = np.diff(walk()), fading_memory(2)(h_1=0.1, x0_1=1e-4, h_2=0.3, x0_2=2e-3)
    one = fading_memory()
    np.testing.assert_allclose(
        output(two, dq=x), output(one(h=0.1, x0=1e-4), dq=x) + output(one(h=0.3, x0=2e-3), dq=x), atol=1e-15
    )


def test_lugre_slides_at_its_stribeck_curve_and_starts_as_a_spring():
    effect = find("lugre_friction")(sigma0=100.0, x0=1e-3, ratio=0.5, speed=0.2, sigma1=0.0)
    for v in (0.01, 0.2, 1.0):
        slid = output(effect, dq=np.full(5000, v * 1e-3), v=v, dt=1e-3)[-1]
        assert slid == pytest.approx(0.1 * (1 + 0.5 * np.exp(-((v / 0.2) ** 2))), rel=1e-12)
    assert output(effect, dq=1e-9, v=0.0, dt=1e-3)[0] == pytest.approx(1e-7, rel=1e-5)
    damped = effect(sigma0=0.0, sigma1=2.0)
    assert output(damped, dq=1e-9, v=1e-6, dt=1e-3)[0] == pytest.approx(2e-6, rel=1e-5)


def test_lugre_without_stribeck_is_fading_memory():
    x = np.diff(walk())
    lugre = output(find("lugre_friction")(sigma0=100.0, x0=1e-3, ratio=0.0), dq=x, v=0.3, dt=1e-3)
    np.testing.assert_allclose(lugre, output(find("fading_memory")(h=0.1, x0=1e-3), dq=x), atol=1e-15)


def test_behind_a_gap_friction_is_lost_at_a_reversal_and_comes_back_only_across_the_gap():
    """One element: spring k = h0/x0, slider h0, gap 2 b in series (Jenkins 1962), by hand."""
    h0, b, x0 = 2.0, 3e-3, 1e-3
    effect = friction_behind_gap(1)(h0=h0, half_width=b, x0=x0)
    (slip,) = (x0 * c for c in knots(1, ()))
    path = [0.5 * b, b, b + 0.5 * slip, b + slip, 20e-3]  # from the middle of the gap, until it slides
    back = [0.5 * slip, slip, slip + b, slip + 2 * b, 1.5 * slip + 2 * b, 2 * slip + 2 * b, 30e-3]
    x = np.array([*path, *(20e-3 - np.array(back))])
    expected = [0.0, 0.0, 0.5, 1.0, 1.0, 0.5, 0.0, 0.0, 0.0, -0.5, -1.0, -1.0]
    found = output(effect, dq=np.diff(x, prepend=0.0))
    np.testing.assert_allclose(found, h0 * np.array(expected), atol=0.015 * h0)  # three small elements beside the one
    assert found[7] == 0.0 and found[3] == pytest.approx(h0) and found[-1] == pytest.approx(-h0)


def test_friction_behind_a_gap_takes_the_place_of_coulomb_friction():
    plant = Plant(ONE_MASS, (find("inertia")(inertia=1.0), find("coulomb_friction")(coulomb=1.0)))
    found = [s for s in WHOLE.candidates(plant) if s.effect == "friction_behind_gap"]
    assert [s.instead for s in found] == [("coulomb_friction@axis",), ()]


# --- operators --------------------------------------------------------------------------------------------------------


def test_what_play_leaves_is_stop():
    x = walk(20000)
    w, y = (output(find(n)(stiffness=1.0, radius=4e-4), dq=np.diff(x)) for n in ("stop", "play"))
    np.testing.assert_allclose(x[1:] - x[0] - y, w, rtol=0, atol=1e-12 * np.abs(x).max())
    np.testing.assert_array_equal(w, output(maxwell_slip((4e-4,))(k1=1.0), dq=np.diff(x)))


@pytest.mark.parametrize("weights", [(2.0, 1.0, 0.5, 3.0), (5.0, -2.0, -1.5, -1.0)])
def test_a_play_bank_is_undone_by_its_inverse(weights):
    x, radii = walk(20000), (2e-4, 7e-4, 1.5e-3)
    y = output(play_bank(radii, weights), dq=np.diff(x))
    back = output(play_bank(*inverse(radii, weights)), dq=np.diff(y, prepend=0.0))
    np.testing.assert_allclose(back, x[1:] - x[0], rtol=0, atol=1e-12 * np.abs(x).max())


def test_a_bank_that_falls_has_no_inverse():
    with pytest.raises(WorkbenchError, match="slope of -0.5"):
        inverse((1e-3, 2e-3), (1.0, -0.7, -0.8))
    with pytest.raises(WorkbenchError, match="increase from above 0"):
        play_bank((1e-3, 1e-3))


def test_maxwell_slip_passes_through_a_concave_curve_and_refuses_a_convex_one():
    x = np.array([1e-4, 3e-4, 1e-3, 4e-3])
    y = 0.2 * (1 - np.exp(-x / 5e-4))
    virgin = output(slip_of_curve(x, y), dq=np.diff(x, prepend=0.0))
    np.testing.assert_allclose(virgin, y, rtol=1e-13)
    with pytest.raises(WorkbenchError, match="convex at the deflection 0.002"):
        slip_of_curve([1e-3, 2e-3, 3e-3], [1.0, 1.5, 2.5])
    with pytest.raises(WorkbenchError, match="as many forces"):
        slip_of_curve([1e-3], [1.0, 2.0])
    assert slip_of_curve([1e-3, 2e-3], [1.0, 2.0]).parameters["k1"].value == pytest.approx(0.0, abs=1e-9)

"""The linear algebra of fits: bounded least squares, tangents, and what a force beside a solved model comes to."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.definition import find
from workbench.effects.free_bank import bank_beside, slips_of
from workbench.identification import solve as solving
from workbench.identification.bounded import bounded
from workbench.identification.cross_validation import from_normal
from workbench.identification.linearised import Linearised
from workbench.identification.problem import Problem
from workbench.identification.solve import solve, solved_at
from workbench.inverse.dynamics import inverse_dynamics
from workbench.inverse.shift import LAGRANGE, Places, between, weights
from workbench.plant import TWO_MASS, Plant
from workbench.record import IDENTIFICATION, Record, Source
from workbench.tracing.candidates import WHOLE, Offer
from workbench.tracing.decimation import decimate

DT, BAND = 1e-3, 100.0


def inverses():
    """Two encoders and a joint, 3 s at 1 kHz; what drives it is nothing special."""
    t = DT * np.arange(3000)
    q = 0.8 * np.sin(2.1 * t) + 0.1 * np.sin(17.0 * t + 0.3)
    torque = 0.02 * np.cos(5.0 * t) + 0.3 * np.sin(2.0 * t) + 0.02 * np.random.default_rng(3).normal(size=t.size)
    channels = {"torque": torque, "position": q + torque / 200.0, "load_position": q}
    counts = {"position": 1e-5, "load_position": 1e-5}
    return inverse_dynamics(
        [Record("made", IDENTIFICATION, t, channels, {}, Source("made", "", "made", {}), counts)], BAND
    )


def plant() -> Plant:
    made = Plant(TWO_MASS) + find("inertia")(at="motor") + find("inertia")(at="load") + find("linear_stiffness")
    return made + find("presliding_hysteresis")(at="motor", h0=0.02, x0=2e-3) + find("viscous_friction")(at="load")


@pytest.mark.parametrize("apart", [1e-2, 1e-4, 1e-5, 1e-6, 1e-9])
def test_columns_that_are_nearly_alike_are_fitted_as_by_an_orthogonal_decomposition(apart):
    rng = np.random.default_rng(1)
    phi = rng.normal(size=(4000, 6))
    phi[:, 1] = phi[:, 0] + apart * rng.normal(size=4000)
    y = phi @ rng.normal(size=6) + 0.1 * rng.normal(size=4000)
    free = np.full(6, np.inf)
    exact = np.linalg.lstsq(phi, y, rcond=None)[0]
    found = bounded(phi, y, -free, free)
    determined = (
        apart >= 1e-6
    )  # else what tells the two apart is below the accuracy of the columns, and is not looked for
    same = pytest.approx(np.linalg.norm(y - phi @ exact), rel=1e-12 if determined else 1e-3)
    assert np.linalg.norm(y - phi @ found) == same
    if determined:
        np.testing.assert_allclose(found, exact, atol=1e-6 * np.abs(exact).max())


def test_bounds_hold_where_columns_are_nearly_alike():
    rng = np.random.default_rng(2)
    phi = rng.normal(size=(500, 3))
    phi[:, 1] = phi[:, 0] + 1e-5 * rng.normal(size=500)
    y = 3.0 * phi[:, 0] - 2.0 * phi[:, 1] + phi[:, 2]
    found = bounded(phi, y, np.zeros(3), np.full(3, 10.0))
    assert np.all(found >= 0.0)
    np.testing.assert_allclose(phi @ found, phi[:, 0] + phi[:, 2], atol=1e-3)


def test_a_column_of_zeros_says_nothing_and_changes_nothing():
    rng = np.random.default_rng(4)
    phi = rng.normal(size=(300, 4))
    y = rng.normal(size=300)
    low, high = np.full(4, -np.inf), np.full(4, np.inf)
    alone = bounded(phi, y, low, high)
    more = np.insert(phi, 2, 0.0, axis=1)
    found = bounded(more, y, np.insert(low, 2, 0.5), np.insert(high, 2, 3.0))
    np.testing.assert_allclose(np.delete(found, 2), alone, rtol=1e-12)
    assert found[2] == 0.5  # as small as its bounds let it be
    assert np.all(bounded(np.zeros((5, 2)), np.ones(5), -np.ones(2), np.ones(2)) == 0.0)


@pytest.mark.parametrize(
    "missing",
    [
        find("clock_skew")(at="sensor.load_position", offset=1e-3),
        find("actuator_lag")(time_constant=2e-3),
        find("encoder_eccentricity")(at="sensor.position"),
        find("stribeck_friction")(at="load"),
        find("presliding_hysteresis")(at="joint", x0=1e-3),
    ],
    ids=lambda e: e.key,
)
def test_tangents_are_what_a_step_changes_of_everything_assembled(missing):
    problem = Problem(plant() + missing, inverses())
    theta = problem.start()
    at = solved_at(problem, theta)
    c = at.c + 0.01 * np.abs(at.c)
    found = problem.tangents(theta, c, at.y, at.phi)
    for k in range(theta.size):
        step = np.zeros(theta.size)
        step[k] = 1e-7 if problem.parameter(problem.free_shape[k]).scale == "time" else 1e-5
        (y1, phi1), (y0, phi0) = problem.assemble(theta + step), problem.assemble(theta - step)
        expected = ((phi1 - phi0) @ c - (y1 - y0)) / (2 * step[k])
        close = np.linalg.norm(found[:, k] - expected) <= 2e-2 * np.linalg.norm(expected) + 1e-9 * np.linalg.norm(at.y)
        assert close, problem.free_shape[k]


def test_what_a_force_beside_a_solved_model_comes_to_is_that_of_the_whole_problem():
    """Read off products with the model's columns, for every force of the catalogue, at its default shape."""
    base = Problem(plant(), inverses())
    solution = solve(base)
    tried = 0
    for candidate in WHOLE.candidates(plant()):
        problem = Linearised(candidate.plant, base, solution)
        if not problem.beside:
            continue
        tried += 1
        theta = problem.start()
        assert problem.cost(theta) == pytest.approx(solved_at(problem, theta).cost, rel=1e-6), candidate.key
    assert tried > 15


def test_no_step_is_tried_that_promises_what_a_bound_holds(monkeypatch):
    """All but the joint's stiffness would be negative here, and stand at zero: what a step takes of them it cannot have."""
    problem, tried, solved = Problem(plant(), inverses()), [], solving.solved_at
    monkeypatch.setattr(solving, "solved_at", lambda p, theta: tried.append(theta) or solved(p, theta))
    found = solve(problem, tolerance=1e-6)
    assert [n.key for n, c in zip(problem.free_linear, found.c, strict=True) if c > 0.0] == ["linear_stiffness@joint"]
    assert len(tried) == 1


def test_a_step_that_rises_leaves_a_shorter_one_no_more_than_its_parabola():
    assert solving._best_between(slope=2.0, rise=0.0) == 0.5  # f = 2 x^2 - 2 x
    assert solving._best_between(slope=2.0, rise=98.0) == pytest.approx(0.01)
    assert solving._best_between(slope=2.0, rise=np.inf) == np.inf


def test_friction_in_the_place_of_a_curve_comes_to_what_the_whole_problem_comes_to():
    """Beside friction that follows the load, and so reads the direction that either gives."""
    declared = plant()["presliding_hysteresis@motor"]
    curve = bank_beside(slips_of(declared), [declared], "motor")
    rest = plant().without(declared.key) + find("load_dependent_friction")(at="motor", mu=0.01)
    base = Problem(rest + curve, inverses())
    solution = solve(base)
    places = [c for c in Offer(stands_for={curve.key: declared}).candidates(rest + curve) if curve.key in c.instead]
    fast = {c.key: Linearised(c.plant, base, solution) for c in places}
    assert {key for key, problem in fast.items() if len(problem.beside) == 2} >= {"lugre_friction@motor"}
    for c in places:
        if not fast[c.key].beside:
            continue
        theta, all_columns = fast[c.key].start(), Linearised(c.plant, base, solution)
        all_columns.beside = ()
        whole = solved_at(all_columns, theta).cost
        assert fast[c.key].cost(theta) == pytest.approx(whole, rel=1e-6), c.key
        assert solved_at(fast[c.key], theta).cost == pytest.approx(whole, rel=1e-6), c.key


def test_starts_come_in_the_same_order_by_operators_that_run_at_the_search_s_own_rate():
    """Of a presliding friction beside a body: which of its lengths is the best shows at a quarter of the rate."""
    finer = decimate(inverses(), least=4.0)
    assert finer[0].fine is not None and finer[0].rough.fine is None
    assert finer[0].rough.rough is finer[0].rough  # nothing rougher than that
    bare = Plant(TWO_MASS) + find("inertia")(at="motor") + find("inertia")(at="load") + find("linear_stiffness")
    base = Problem(bare, finer)
    problem = Linearised(bare + find("presliding_hysteresis")(at="motor", x0=2e-3), base, solve(base))
    lengths = [np.array([np.log(x)]) for x in (0.02, 0.1, 0.3, 1.0)]
    exact = np.array([problem.cost(theta) for theta in lengths])
    rough = np.array([problem.cost(theta, roughly=True) for theta in lengths])
    assert np.array_equal(np.argsort(rough), np.argsort(exact)) and not np.array_equal(rough, exact)


@given(st.floats(0.0, 1.0, exclude_max=True))
@settings(max_examples=30, deadline=None)
def test_interpolation_is_exact_for_what_eight_points_determine(u):
    found = weights(u)
    points = np.arange(1 - LAGRANGE // 2, LAGRANGE // 2 + 1)
    for power in range(LAGRANGE):
        assert np.dot(found, points.astype(float) ** power) == pytest.approx(u**power, abs=1e-9)


def test_beyond_the_ends_a_signal_holds_its_first_and_last_value():
    x = np.array([2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0])
    np.testing.assert_allclose(between(x, np.array([-9.0, 0.0, 4.0, 9.0, 30.5])), [2.0, 2.0, 11.0, 29.0, 29.0])


def test_places_whose_weights_are_kept_read_the_bits_of_interpolation():
    rng = np.random.default_rng(4)
    steps = np.concatenate([10.0 / 3.0 * np.arange(120) - 9.0, [0.0, 99.0, 299.0, 305.5]])
    places = Places(steps)
    for x in rng.normal(size=(2, 300)):
        np.testing.assert_array_equal(places.read(x), between(x, steps))


@pytest.mark.parametrize("seed", range(20))
def test_what_a_bounded_fit_does_not_determine_stays_small_beside_parameters_at_their_bounds(seed):
    """Of 38 parameters 25 have a direction that nothing determines, as the knots of a curve beside a constant; an active set sent it to 1e13."""
    rng, n = np.random.default_rng(seed), 38
    nothing = np.concatenate([rng.normal(size=25), np.zeros(n - 25)])
    vectors = np.linalg.qr(np.column_stack([nothing, rng.normal(size=(n, n - 1))]))[0]
    values = np.concatenate([[0.0, 2e-6, 2e-4], np.geomspace(0.1, 3.0, n - 3)])
    gram, moment = (vectors * values) @ vectors.T, vectors @ (np.sqrt(values) * rng.normal(size=n))
    lower, upper = np.where((np.arange(n) == 34) | (np.arange(n) == 35), 0.0, -np.inf), np.full(n, np.inf)
    c = from_normal((gram + gram.T) / 2, moment, lower, upper)
    assert np.all(c >= lower) and np.linalg.norm(c) < 1e4

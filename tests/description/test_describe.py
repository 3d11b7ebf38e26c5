"""Equivalent stiffness and loss over amplitude, held against closed forms, mpmath, stepped loops and each other."""

from math import expm1, pi

import casadi as ca
import mpmath
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ive

from workbench.definition import FORCE, Effect, find, namespace
from workbench.description import bank_equivalent, equivalent, expressions, first_harmonic
from workbench.effects.elementary import exp, sign0
from workbench.errors import WorkbenchError
from workbench.kernel import arrays, step
from workbench.kernel.lanes import map_lanes
from workbench.kernel.program import read
from workbench.parameter import Parameter

H0, A0 = 0.15, 636.0  # N*m, 1/rad: virgin curve H0 (1 - exp(-A0 x))
OVER = np.geomspace(1e-5, 1.0, 61)  # rad


def hysteresis(d: float = 1.0) -> Effect:
    return find("presliding_hysteresis")(h0=H0, x0=A0 ** (-1.0 / d), d=d)


def curve(x: float, d: float = 1.0) -> float:
    return -H0 * expm1(-A0 * x**d)


def spherical(n: int, z):
    """exp(-z) i_n(z), the modified spherical Bessel function."""
    return np.sqrt(pi / (2.0 * z)) * ive(n + 0.5, z)


def closed(amplitude):
    """k_e and c_e w for d = 1."""
    z = A0 * amplitude / 2.0
    return 2.0 * H0 * A0 * ive(1, z) / z, 4.0 * H0 * A0 / pi * spherical(1, z)


# --- the integrals ----------------------------------------------------------------------------------------------------


def test_integrals_agree_with_the_bessel_closed_form():
    found = equivalent(hysteresis(), OVER)
    stiffness, loss = closed(OVER)
    np.testing.assert_allclose(found.stiffness, stiffness, rtol=1e-12)
    np.testing.assert_allclose(found.loss, loss, rtol=1e-10)
    np.testing.assert_allclose(found.loss[OVER > 1e-4], loss[OVER > 1e-4], rtol=1e-12)


def thirty_digits(a: float, d: float) -> tuple[float, float]:
    """k_e and c_e w by adaptive quadrature of their first definitions."""
    with mpmath.workdps(30):
        x0, exponent, amplitude = mpmath.mpf(A0) ** (-1 / mpmath.mpf(d)), mpmath.mpf(d), mpmath.mpf(a)

        def y(u):
            return -H0 * mpmath.expm1(-((u / x0) ** exponent))

        def over_angle(t):
            return y(amplitude * mpmath.sin(t / 2) ** 2) * mpmath.cos(t)

        cuts = [0, *(u for u in (x0 * mpmath.mpf(10) ** k for k in range(-3, 3)) if u < amplitude), amplitude]
        stiffness = (
            -4 / (mpmath.pi * amplitude) * mpmath.quad(over_angle, [mpmath.acos(1 - 2 * u / amplitude) for u in cuts])
        )
        loss = 8 / (mpmath.pi * amplitude**2) * (mpmath.quad(y, cuts) - amplitude * y(amplitude) / 2)
        return float(stiffness), float(loss)


@pytest.mark.parametrize("d", [0.8, 1.0])
def test_integrals_agree_with_thirty_digits(d):
    for a in (1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0):
        found = equivalent(hysteresis(d), a)
        assert (found.stiffness[0], found.loss[0]) == pytest.approx(thirty_digits(a, d), rel=1e-10)


@pytest.mark.parametrize("a", [1e-4, 1e-3, 1e-2])
def test_loss_is_the_area_of_the_loop(a):
    def down(x):
        return curve(a) - 2.0 * curve((a - x) / 2.0)  # Masing's rule; the way up is -down(-x)

    lost = quad(lambda x: -down(-x) - down(x), -a, a, epsrel=1e-13)[0]
    assert pi * a * a * equivalent(hysteresis(), a).loss[0] == pytest.approx(lost, rel=1e-9)


def test_the_formula_as_misprinted_is_neither_a_loss_nor_of_its_size():
    a = 1e-3
    misprinted = -8.0 / (pi * a * a) * quad(lambda u: curve(u) - curve(a) / 2.0, 0.0, pi, points=[0.01, 0.1])[0]
    assert misprinted == pytest.approx(-9.2e5, rel=0.01)
    assert equivalent(hysteresis(), a).loss[0] == pytest.approx(9.46333354, rel=1e-8)


@pytest.mark.parametrize(("a", "stiffness", "loss"), [(1e-4, 0.016, 1.97), (1e-3, 0.14, 1.72), (1e-2, 0.56, 0.78)])
def test_amplitude_is_zero_to_peak(a, stiffness, loss):
    read, true = 0, 1  # a stroke of `a` between reversals has the amplitude a/2
    found = equivalent(hysteresis(), [a, a / 2.0])
    assert 1.0 - found.stiffness[read] / found.stiffness[true] == pytest.approx(stiffness, abs=0.006)
    assert found.loss[read] / found.loss[true] == pytest.approx(loss, abs=0.006)


def test_slopes_over_amplitude_and_parameters_are_exact():
    slopes = expressions(hysteresis()).jacobian()
    x0 = 1.0 / A0
    for a in OVER[::4]:
        z = A0 * a / 2.0
        (k_e,), (c_ew,) = (v.ravel() for v in closed(np.array([a])))
        dk = H0 * A0**2 * (ive(2, z) - ive(1, z)) / z
        dc = 2.0 * H0 * A0**2 / pi * (spherical(2, z) + spherical(1, z) / z - spherical(1, z))
        k_by_a, k_by_p, c_by_a, c_by_p = (np.asarray(v).ravel() for v in slopes(a, [H0, x0, 1.0], 0.0, 0.0))
        assert k_by_a[0] == pytest.approx(dk, rel=1e-8)
        assert c_by_a[0] == pytest.approx(dc, rel=1e-8, abs=1e-10 * c_ew / a)
        # k_e = h0/x0 f(A/x0), and so is c_e w
        assert k_by_p[:2] == pytest.approx([k_e / H0, -(k_e + a * dk) / x0], rel=1e-8, abs=1e-10 * k_e / x0)
        assert c_by_p[:2] == pytest.approx([c_ew / H0, -(c_ew + a * dc) / x0], rel=1e-8, abs=1e-10 * c_ew / x0)


@pytest.mark.parametrize("d", [0.6, 0.9])
def test_slopes_over_every_input_agree_with_differences(d):
    function = expressions(hysteresis())
    values = np.array([2e-3, H0, 1.0 / A0, d])
    k_by_a, k_by_p, c_by_a, c_by_p = (np.asarray(v) for v in function.jacobian()(values[0], values[1:], 0.0, 0.0))
    exact = np.block([[k_by_a, k_by_p], [c_by_a, c_by_p]])
    for i, h in enumerate(1e-3 * values):
        near = [values + s * h * np.eye(4)[i] for s in (-2, -1, 1, 2)]
        two_down, down, up, two_up = (np.array(function(v[0], v[1:])).ravel() for v in near)
        assert exact[:, i] == pytest.approx((8.0 * (up - down) - (two_up - two_down)) / (12.0 * h), rel=1e-9)


def test_the_expression_and_the_lanes_agree_to_the_last_bit_whatever_is_evaluated_together():
    effect = hysteresis(0.8)
    found = equivalent(effect, OVER)
    values = np.array([p.value for p in effect.parameters.values()])
    stiffness, loss = expressions(effect)(OVER[None, :], values)
    assert np.array_equal(np.asarray(stiffness).ravel(), found.stiffness)
    assert np.array_equal(np.asarray(loss).ravel(), found.loss)
    assert np.array_equal([equivalent(effect, a).loss[0] for a in OVER], found.loss)


def test_an_expression_is_built_once_per_definition():
    assert expressions(hysteresis()) is expressions(hysteresis(0.8))


def test_a_jump_at_reversal_is_coulomb_friction():
    """y(0+) = h0: what integration by parts would miss."""
    found = equivalent(masing("jump", lambda x, p: p.h0 + 0.0 * x), [1e-4, 1.0])
    np.testing.assert_allclose(found.loss, 4.0 * H0 / (pi * found.amplitude), rtol=1e-13)
    np.testing.assert_allclose(found.stiffness * found.amplitude, 0.0, atol=1e-14)


def test_descriptions_cannot_be_written_into_and_want_positive_amplitudes():
    found = equivalent(hysteresis(), [1e-3])
    for array in (found.amplitude, found.stiffness, found.loss):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    for wrong in ([0.0], [-1e-3], [float("nan")], [[1e-3]]):
        with pytest.raises(WorkbenchError, match="above zero"):
            equivalent(hysteresis(), wrong)


# --- stepped loops ----------------------------------------------------------------------------------------------------


def masing_stack(positions, d: float) -> np.ndarray:
    """Force of an exact Masing operator at each position, from rest at 0: a stack of turning points, wiped as passed.

    From a reversal (x_r, F_r) the branch is F_r +- 2 y(|x - x_r|/2). Where it meets the reversal before that, both are
    forgotten and the branch of the earlier one goes on; beyond the first reversal the virgin curve does.
    """
    turns, forces, way, last = [], [0.0], 0, 0.0
    for x in positions:
        now = (x > last) - (x < last)
        if now == -way != 0:
            turns.append((last, forces[-1]))
        way = now or way
        while len(turns) > 1 and way * (x - turns[-2][0]) >= 0.0:
            del turns[-2:]
        if turns and abs(x) >= abs(turns[0][0]):
            turns.clear()
        at, force = turns[-1] if turns else (0.0, 0.0)
        forces.append(force + way * (2.0 * curve(abs(x - at) / 2.0, d) if turns else curve(abs(x), d)))
        last = x
    return np.array(forces[1:])


@pytest.mark.parametrize(("d", "a"), [(1.0, 1e-5), (1.0, 2e-3), (1.0, 1.0), (0.8, 1e-4), (0.8, 1e-2)])
def test_integrals_are_the_first_harmonic_of_a_stepped_masing_loop(d, a):
    samples = 65536
    theta = 2.0 * pi / samples * np.arange(-samples // 4, samples + samples // 2)
    force = masing_stack((a * np.cos(theta)).tolist(), d)[samples // 2 + samples // 4 :]  # one cycle, from a trough on
    first = -2.0 * np.fft.fft(force)[1] / (samples * a)
    found = equivalent(hysteresis(d), a)
    assert found.stiffness[0] == pytest.approx(first.real, rel=1e-10)
    assert found.loss[0] == pytest.approx(first.imag, rel=1e-10)


def elements(effect: Effect):
    """k (N*m/rad) and D (rad) of the bank that the effect steps."""
    inside = effect.derive(namespace(**{n: p.value for n, p in effect.parameters.items()}))
    return inside.h0 * np.asarray(ca.DM(inside.k)).ravel(), np.asarray(ca.DM(inside.slip)).ravel()


@pytest.mark.parametrize("a", [3e-6, 3e-5, 1e-3, 1e-2, 0.3])
def test_the_bank_in_closed_form_is_the_first_harmonic_of_the_stepped_bank(a):
    effect = hysteresis()
    k, slip = elements(effect)
    down = np.array(sorted({a, -a, *(a - 2.0 * slip[slip < a])}, reverse=True))  # linear in x between these
    x = np.concatenate(([0.0], down, -down[1:]))
    ready = step.build(effect)
    force = H0 * ready.run({"dq": np.diff(x, prepend=0.0)}, {n: p.value for n, p in effect.parameters.items()})[0]
    theta = np.concatenate((np.arccos(down / a), pi + np.arccos(down[1:] / a)))
    x, force = x[1:], force[1:]
    assert force[-1] == pytest.approx(force[0], rel=1e-12)  # it closes in its first cycle
    slope = np.diff(force) / np.diff(x)
    level = force[:-1] - slope * x[:-1]

    def over(primitive):
        return np.diff(primitive(theta))

    cosine = level * over(np.sin) + slope * a * over(lambda t: t / 2.0 + np.sin(2.0 * t) / 4.0)
    sine = level * over(lambda t: -np.cos(t)) + slope * a * over(lambda t: -np.cos(2.0 * t) / 4.0)
    found = bank_equivalent(k, slip, a)
    assert found.stiffness[0] == pytest.approx(cosine.sum() / (pi * a), rel=1e-10)
    assert found.loss[0] == pytest.approx(-sine.sum() / (pi * a), rel=1e-10, abs=1e-10 * found.stiffness[0])


def test_a_bank_of_27_elements_is_near_the_continuous_curve():
    """Within 1 % in stiffness, and in loss within 3.5 % of the largest; so where little is lost, not near in proportion."""
    assert elements(hysteresis())[0].size == 27
    amplitudes = np.geomspace(1e-5, 1.0, 401)
    exact, bank = equivalent(hysteresis(), amplitudes), bank_equivalent(*elements(hysteresis()), amplitudes)
    stiffness, loss = np.abs(bank.stiffness / exact.stiffness - 1.0), np.abs(bank.loss - exact.loss)
    assert 0.005 < stiffness.max() < 0.01
    assert 0.02 < loss.max() / exact.loss.max() < 0.035
    assert (loss / exact.loss).max() < 0.75
    assert (loss / exact.loss)[amplitudes > 1e-3].max() < 0.02


# --- any force --------------------------------------------------------------------------------------------------------


def masing(name: str, virgin) -> Effect:
    height = {"h0": Parameter(H0, "F", "height")}
    return Effect(name, "test", "", "", FORCE, height, lambda s, z, p: ({}, s.q), virgin=virgin, holds=("masing",))


def dahl() -> Effect:
    """Dahl's friction, dz/dx = a (1 - z sign(dx)): the same virgin curve, and fading memory where Masing has reversals."""

    def step(s, z, p):
        way = sign0(s.dq)
        following = way + (z.z - way) * exp(-p.a * way * s.dq)
        return {"z": following}, p.h0 * following

    return Effect(
        name="dahl",
        cause="test",
        formula="",
        source="",
        port=FORCE,
        parameters={"h0": Parameter(H0, "F", "height"), "a": Parameter(A0, "1/x", "rate")},
        linear=("h0",),
        states={"z": 1},
        reads=("dq",),
        step=step,
        virgin=lambda x, p: p.h0 * (1.0 - exp(-p.a * x)),
    )


def test_an_effect_without_masings_rule_is_refused_by_the_integrals():
    for effect in (dahl(), find("viscous_friction")):
        with pytest.raises(WorkbenchError, match="does not hold Masing's rule"):
            equivalent(effect, [1e-3])
        with pytest.raises(WorkbenchError, match="does not hold Masing's rule"):
            expressions(effect)


@pytest.mark.parametrize("a", [1e-5, 1e-3, 0.3])
def test_fading_memory_is_stepped_to_its_closed_form(a):
    """The settled way down is -1 + (1 + z) exp(-a (A - x)) from z = tanh(a A) on; far from settled after one cycle."""
    z = A0 * a
    peak = np.tanh(z)
    stiffness = 2.0 * H0 / a * (1.0 + peak) * ive(1, z)
    loss = 2.0 * H0 / (pi * a) * (2.0 + (1.0 + peak) * expm1(-2.0 * z) / z)
    found = first_harmonic(dahl(), a, 10.0, samples=1024)
    assert (found.stiffness[0], found.loss[0]) == pytest.approx((stiffness, loss), rel=1e-8)


def test_fading_memory_with_the_same_virgin_curve_is_another_force():
    stepped, integrals = first_harmonic(dahl(), 1e-3, 10.0), equivalent(hysteresis(), 1e-3)
    assert (stepped.stiffness[0], stepped.loss[0]) == pytest.approx((82.95, 22.17), abs=0.01)
    assert (integrals.stiffness[0], integrals.loss[0]) == pytest.approx((70.29, 9.46), abs=0.01)


def test_the_first_harmonic_of_static_forces_is_known():
    amplitudes = np.array([1e-3, 0.1, 2.0])
    viscous = first_harmonic(find("viscous_friction")(viscous=0.02), amplitudes, 7.0)
    np.testing.assert_allclose(viscous.loss, 0.02 * 7.0, rtol=1e-12)
    np.testing.assert_allclose(viscous.stiffness, 0.0, atol=1e-13)
    cubic = first_harmonic(find("cubic_stiffness")(k3=5.0), amplitudes, 7.0)
    np.testing.assert_allclose(cubic.stiffness, 5.0 * 0.75 * amplitudes**2, rtol=1e-12)
    np.testing.assert_allclose(cubic.loss, 0.0, atol=1e-13)
    inertia = first_harmonic(find("inertia")(inertia=0.01), amplitudes, 7.0)
    np.testing.assert_allclose(inertia.stiffness, -0.01 * 49.0, rtol=1e-12)
    coulomb = first_harmonic(find("coulomb_friction")(coulomb=0.3), amplitudes, 7.0)
    np.testing.assert_allclose(coulomb.loss, 4.0 * 0.3 / (pi * amplitudes), rtol=1e-6)


def test_a_stepped_bank_is_described_as_its_closed_form_says():
    amplitudes = np.geomspace(1e-5, 0.1, 5)
    stepped, exact = first_harmonic(hysteresis(), amplitudes, 1.0), bank_equivalent(*elements(hysteresis()), amplitudes)
    np.testing.assert_allclose(stepped.stiffness, exact.stiffness, rtol=1e-5)
    np.testing.assert_allclose(stepped.loss, exact.loss, rtol=1e-4)


def test_what_a_cosine_cannot_describe_is_refused_with_a_sentence():
    drift = Effect("drift", "test", "", "", FORCE, {}, lambda s, z, p: ({}, s.t * s.q), reads=("t", "q"))
    with pytest.raises(WorkbenchError, match="'drift' does not settle within 4096 cycles"):
        first_harmonic(drift, [1.0], 1.0, samples=64)
    loaded = Effect("loaded", "test", "", "", FORCE, {}, lambda s, z, p: ({}, s.tau * s.dir), reads=("tau", "dir"))
    with pytest.raises(WorkbenchError, match="reads tau, which a cosine motion does not give"):
        first_harmonic(loaded, [1.0], 1.0)
    with pytest.raises(WorkbenchError, match="it is not a force"):
        first_harmonic(find("actuator_lag"), [1.0], 1.0)
    with pytest.raises(WorkbenchError, match="multiple of 4 samples"):
        first_harmonic(dahl(), [1.0], 1.0, samples=10)


# --- lanes ------------------------------------------------------------------------------------------------------------


def test_lanes_hold_the_bits_of_numpy_and_of_casadi():
    x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 1)
    function = ca.Function("lanes_test", [x, p], [ca.vertcat(exp(x[0]) / x[1], ca.fmax(x[0], p[0]), p[0])])
    inputs = np.random.default_rng(1).normal(size=(2, 1003))
    inputs[1, 7] = 0.0  # a division by zero is infinite here too, and stops nothing
    found = map_lanes(read(function), inputs, [0.3])
    rows = arrays.evaluate(read(function), inputs, [0.3])[0]
    assert all(np.array_equal(a, np.broadcast_to(b, a.shape)) for a, b in zip(found, rows, strict=True))
    assert np.array_equal(found, np.asarray(function(inputs, 0.3)))
    only = ca.Function("lanes_test", [x], [ca.vertcat(x[0] * x[1])])
    assert np.array_equal(map_lanes(read(only), inputs), inputs[:1] * inputs[1:])

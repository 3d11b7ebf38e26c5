"""Weights of operators by streaming: the same as from the tall regressor, in little memory, whatever the block."""

import tracemalloc

import numpy as np
import pytest
from scipy.optimize import nnls

from workbench.definition import find
from workbench.effects.hysteresis import maxwell_slip
from workbench.errors import WorkbenchError
from workbench.kernel.step import build
from workbench.long_records.stream import ILL_CONDITIONED, fit_operators

RADII = np.geomspace(1e-3, 0.3, 8)


def walk(seed: int, n: int = 20_000) -> np.ndarray:
    return 0.4 + np.cumsum(np.random.default_rng(seed).normal(size=n)) * 2e-3


def tall(x, radii, kind: str = "stop") -> np.ndarray:
    """Return the regressor (n, m), each operator by the textbook's recursion on its own output."""
    columns = []
    for r in radii:
        column, value = [], 0.0
        for before, now in zip(np.append(x[0], x[:-1]) - x[0], x - x[0], strict=True):
            step = value + now - before if kind == "stop" else value
            value = min(max(step, -r if kind == "stop" else now - r), r if kind == "stop" else now + r)
            column.append(value)
        columns.append(column)
    return np.array(columns).T


@pytest.mark.parametrize("kind", ["stop", "play"])
@pytest.mark.parametrize("seed", range(3))
def test_the_weights_are_those_of_tall_non_negative_least_squares(kind, seed):
    x, rng = walk(seed), np.random.default_rng(seed + 100)
    phi = tall(x, RADII, kind)
    y = phi @ np.maximum(rng.normal(size=RADII.size), 0.0) - 3.0 * phi[:, 2] + 0.05 * rng.normal(size=x.size)
    expected, left = nnls(phi, y)
    found = fit_operators(x, y, RADII, kind)
    assert found.method == "cholesky" and found.condition <= ILL_CONDITIONED
    np.testing.assert_allclose(found.weights, expected, rtol=1e-8, atol=1e-8 * expected.max())
    assert (expected == 0.0).any() and (found.weights[expected == 0.0] == 0.0).all()
    assert found.residual == pytest.approx(left / np.sqrt(x.size), rel=1e-8)


def test_without_a_sign_it_is_least_squares():
    x = walk(5)
    phi, rng = tall(x, RADII), np.random.default_rng(5)
    y = phi @ rng.normal(size=RADII.size) + 0.05 * rng.normal(size=x.size)
    found = fit_operators(x, y, RADII, non_negative=False)
    np.testing.assert_allclose(found.weights, np.linalg.lstsq(phi, y, rcond=None)[0], rtol=1e-8)
    assert found.weights.min() < 0.0


@pytest.mark.parametrize("kind", ["stop", "play"])
def test_a_monotone_bank_may_have_weights_of_both_signs_but_no_falling_slope(kind):
    """The same optimum as a general solver of bounded least squares in the slopes, thresholds in any order."""
    x, rng = walk(14), np.random.default_rng(14)
    radii = rng.permutation(RADII)
    phi = tall(x, radii, kind)
    order = np.argsort(radii) if kind == "play" else np.argsort(-radii)
    y = phi[:, order] @ np.diff(rng.normal(size=radii.size), prepend=0.0) + 0.05 * rng.normal(size=x.size)
    found = fit_operators(x, y, radii, kind, monotone=True)
    assert np.cumsum(found.weights[order]).min() > -1e-12 and found.weights.min() < 0.0
    summed = np.tril(np.ones((radii.size, radii.size)))  # sums of the ordered weights; its inverse takes differences
    slopes = nnls(phi[:, order] @ np.linalg.inv(summed), y)[0]
    np.testing.assert_allclose(np.cumsum(found.weights[order]), slopes, atol=1e-8 * slopes.max())
    assert (slopes == 0.0).any() and found.residual < fit_operators(x, y, radii, kind).residual


def test_further_columns_have_any_sign():
    x = walk(6)
    rng = np.random.default_rng(6)
    v = np.gradient(x)
    phi = np.column_stack([v, np.ones(x.size), tall(x, RADII)])
    y = phi @ np.array([-3.0, -0.2, *rng.uniform(-0.5, 1.0, RADII.size)]) + 0.01 * rng.normal(size=x.size)
    both = np.column_stack([phi, -phi[:, :2]])  # a free factor is the difference of two that are not below zero
    expected = nnls(both, y)[0]
    expected = np.append(expected[:2] - expected[-2:], expected[2:-2])
    columns = (lambda block, offset: v[offset : offset + block.size], lambda block, offset: np.ones(block.size))
    for size in (100, 2048):
        found = fit_operators(x, y, RADII, columns=columns, block=size)
        np.testing.assert_allclose(found.columns, expected[:2], rtol=1e-8)
        np.testing.assert_allclose(found.weights, expected[2:], rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("size", [1, 7, 64, 5000, 10**6])
def test_the_size_of_a_block_does_not_matter(size):
    x = walk(7, 5000)
    y = np.tanh(5 * x) + np.random.default_rng(7).normal(size=x.size)
    one, two = fit_operators(x, y, RADII), fit_operators(x, y, RADII, block=size)
    np.testing.assert_allclose(one.weights, two.weights, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("non_negative", [True, False])
def test_an_ill_conditioned_set_is_solved_by_orthogonal_transformations(non_negative):
    """Two thresholds that differ by 2e-6 of themselves: the normal equations would leave about four digits."""
    x = walk(8)
    radii = np.array([0.01, 0.05, 0.05 * (1 + 2e-6), 0.2])
    phi = tall(x, radii)
    true = np.array([1.0, 2.0, 3.0, 0.5])
    y = phi @ true
    found = fit_operators(x, y, radii, non_negative=non_negative, block=999)
    assert found.method == "qr" and found.condition > ILL_CONDITIONED
    np.testing.assert_allclose(found.weights, true, rtol=1e-7)
    assert found.residual < 1e-12


@pytest.mark.parametrize(("apart", "method"), [(1e-2, "cholesky"), (1e-3, "cholesky"), (1e-4, "qr"), (1e-5, "qr")])
def test_the_weights_are_right_to_1e_8_on_either_side_of_the_rule(apart, method):
    x = walk(8)
    radii = np.array([0.01, 0.05, 0.05 * (1 + apart), 0.2])
    phi = tall(x, radii)
    y = phi @ np.array([1.0, 2.0, 3.0, 0.5]) + 1e-5 * np.random.default_rng(0).normal(size=x.size)
    found, expected = fit_operators(x, y, radii), nnls(phi, y)[0]
    assert found.method == method
    np.testing.assert_allclose(found.weights, expected, rtol=0.0, atol=1e-8 * expected.max())


def test_operators_that_cannot_be_told_apart_or_never_move():
    """Beyond the travel all stops are the position, and no play moves."""
    x = walk(9)
    far = float(np.ptp(x)) * 2
    y = 2.0 * (x - x[0])
    stops = fit_operators(x, y, [far, 2 * far])
    assert stops.method == "qr" and stops.weights.sum() == pytest.approx(2.0) and stops.residual < 1e-12
    plays = fit_operators(x, y, [0.01, far], "play")
    assert plays.weights[1] == 0.0 and plays.weights[0] > 1.9
    still = fit_operators(np.ones(10), np.ones(10), [0.1])
    assert still.weights[0] == 0.0 and still.residual == pytest.approx(1.0)


@pytest.mark.parametrize("kind", ["stop", "play"])
def test_the_operators_are_those_of_the_catalogue(kind):
    """Weights found here are stiffnesses of the effects."""
    x = walk(10, 3000)
    dq = np.diff(x, prepend=x[0])
    y = build(find(kind)).run({"dq": dq}, {"stiffness": 1.0, "radius": 0.02})[0]
    assert fit_operators(x, 3.0 * y, [0.02], kind).weights[0] == pytest.approx(3.0, rel=1e-10)
    if kind == "stop":
        slips = (0.004, 0.03, 0.1)
        k = np.array([5.0, 0.0, 2.0])
        columns = build(maxwell_slip(slips)).run({"dq": dq}, {f"slip{i}": s for i, s in enumerate(slips, 1)})
        np.testing.assert_allclose(fit_operators(x, k @ columns, slips).weights, k, atol=1e-9)


@pytest.mark.parametrize("hard", [False, True])
def test_a_million_samples_take_no_memory_to_speak_of(hard):
    """Twenty operators, by either method: below 50 MB, where the regressor would be 160 MB."""
    x, radii = walk(11, 1_000_000), np.geomspace(1e-3, 1.0, 20)
    y = np.tanh(x)
    limit = {"conditioned": 1.0} if hard else {}
    fit_operators(x[:5000], y[:5000], radii, **limit)
    tracemalloc.start()
    try:
        found = fit_operators(x, y, radii, **limit)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert found.method == ("qr" if hard else "cholesky")
    assert peak < 5e6


def test_arguments_that_do_not_fit_are_refused():
    x = walk(12, 50)
    for wrong, said in (
        (lambda: fit_operators(x, x[1:], RADII), "as many"),
        (lambda: fit_operators(x, x, [0.1, 0.0]), "above 0"),
        (lambda: fit_operators(x, x, RADII, "slip"), "not 'slip'"),
        (lambda: fit_operators(x, x * np.nan, RADII), "finite"),
    ):
        with pytest.raises(WorkbenchError, match=said):
            wrong()

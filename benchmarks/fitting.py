"""Weights of twenty stop operators from a million samples, beside solvers that are given the whole regressor."""

import tracemalloc
from statistics import median
from time import process_time

import numpy as np
from scipy.optimize import nnls

from workbench.long_records.stream import KINDS, advance, fit_operators
from workbench.threads import one_thread

SAMPLES, LONG = 1_000_000, 10_000_000
RADII = np.geomspace(1e-3, 1.0, 20)
PART = 50  # of the samples that cvxpy is given; its time is scaled to all


def record(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a random walk and a saturating force on it, with noise."""
    rng = np.random.default_rng(0)
    x = np.cumsum(rng.normal(size=n)) * 1e-3
    return x, np.tanh(3.0 * x) + 0.01 * rng.normal(size=n)


def regressor(x: np.ndarray) -> np.ndarray:
    """Return the operators' outputs (n, m)."""
    out = np.empty((x.size, RADII.size))
    advance(x, x[0], RADII, np.zeros(RADII.size), *KINDS["stop"], out)
    return out


@one_thread
def tall(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return nnls(regressor(x), y)[0]


@one_thread
def by_cvxpy(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    import cvxpy as cp

    w = cp.Variable(RADII.size, nonneg=True)
    cp.Problem(cp.Minimize(cp.sum_squares(regressor(x) @ w - y))).solve(solver=cp.CLARABEL)
    return w.value


def seconds(call, repeats: int) -> tuple[float, np.ndarray]:
    """Return the median CPU time of a call and its result; the first call, which may compile, is not counted."""
    result, times = call(), []
    for _ in range(repeats):
        start = process_time()
        call()
        times.append(process_time() - start)
    return median(times), result


def main() -> None:
    """Print CPU milliseconds, ratios to the streamed fit, and how far the weights are from it."""
    x, y = record(SAMPLES)
    few = slice(0, SAMPLES // PART)
    fit_operators(x[few], y[few], RADII)
    ours, weights = seconds(lambda: fit_operators(x, y, RADII).weights, 9)
    part = fit_operators(x[few], y[few], RADII).weights
    whole, tall_weights = seconds(lambda: tall(x, y), 3)
    scaled, cvxpy_weights = seconds(lambda: by_cvxpy(x[few], y[few]), 1)
    print(f"{SAMPLES} samples, {RADII.size} stop operators, weights >= 0, one thread, CPU time, median:")
    off = np.abs(tall_weights - weights).max() / weights.max()
    # over so few samples the widest operators never slip: they are one column, and only their sum is determined
    shown = regressor(x[few])
    apart = np.linalg.norm(shown @ (cvxpy_weights - part)) / np.linalg.norm(shown @ part)
    for name, time, said in (
        ("streamed", ours, ""),
        ("tall scipy nnls", whole, f"weights differ by {off:.1e} of the largest"),
        (f"tall cvxpy, Clarabel (x {PART})", scaled * PART, f"outputs differ by {apart:.1e}"),
    ):
        print(f"  {name:<30}{1e3 * time:10.1f} ms {time / ours:10.2f} x   {said}")
    x, y = record(LONG)
    long, _ = seconds(lambda: fit_operators(x, y, RADII), 1)
    tracemalloc.start()
    fit_operators(x, y, RADII)
    more = tracemalloc.get_traced_memory()[1] / 2**20
    tracemalloc.stop()
    print(f"  {LONG} samples{'':<15}{1e3 * long:10.1f} ms {long / ours:10.2f} x   {more:.1f} MB beside the data")


if __name__ == "__main__":
    main()

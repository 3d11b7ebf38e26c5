"""Weights of a bank from periodic records of displacement and force: dense, pruned and shaped, always passive.

What is minimised is the energy gain sqrt(sum e^2/sum x^2) over all records, e = f - F[x]. On one trajectory it is a lower
bound of an induced gain, no norm of the operator, and the record of the largest force rules it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.errors import WorkbenchError
from workbench.hysteresis.bank import Bank, columns
from workbench.threads import one_thread

STARTS = 6  # of a search over radii and rates: the spread of what they end in is shown
ROUNDS = 60  # of one search; twice as many change the gain by less than 1 %
LEAST, WHOLE = 0.02, 0.95  # of the largest amplitude: radii of a grid; half or twice LEAST moves a gain by under 2 %
STEP = (
    1e-4  # of a radius' or a rate's logarithm, for one-sided differences; ten times more or less changes no digit shown
)


@dataclass(frozen=True, eq=False)
class Periodic:
    """One settled record: x (n,) and f (n,) over whole periods, dt s apart, in the units that the bank is to have.

    band: Hz up to which f is known (what was divided and averaged); operators are compared below it.
    """

    x: np.ndarray
    f: np.ndarray
    dt: float
    band: float = np.inf

    def columns(self, radii, rates) -> np.ndarray:
        """Return (n, 1 + radii + rates): the operators along x, within the band."""
        whole = columns(self.x, self.dt, radii, rates)
        if self.band >= 0.5 / self.dt:
            return whole
        spectrum = np.fft.rfft(whole, axis=0)
        spectrum[np.fft.rfftfreq(self.x.size, self.dt) > self.band] = 0.0
        return np.fft.irfft(spectrum, self.x.size, axis=0)


@dataclass(frozen=True, eq=False)
class Fitted:
    """bank; gain: energy gain over all records, F/x; gains: of each record; optimality: largest violation of the conditions
    of optimality (Karush-Kuhn-Tucker), relative to the largest product of a column with the force; starts: gains of others."""

    bank: Bank
    gain: float
    gains: tuple[float, ...]
    optimality: float = 0.0
    starts: tuple[float, ...] = ()


def gain(records: Sequence[Periodic], forces: Sequence[np.ndarray]) -> float:
    """Return the energy gain of models' forces (n,) of each record."""
    left = sum(np.sum((r.f - y) ** 2) for r, y in zip(records, forces, strict=True))
    return float(np.sqrt(left / sum(np.sum(r.x**2) for r in records)))


def gains(bank: Bank, records: Sequence[Periodic]) -> tuple[float, ...]:
    """Return the energy gain of a bank on each record alone."""
    weights = np.concatenate([[bank.stiffness], bank.springs, bank.creeps])
    return tuple(gain([r], [r.columns(bank.radii, bank.rates) @ weights]) for r in records)


def stacked(records: Sequence[Periodic], radii, rates, even: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return (columns, force) of all records, one under the other, each over the `even`-th power of its displacement's norm."""
    if not records:
        raise WorkbenchError("a bank needs at least one record of displacement and force.")
    scale = [np.linalg.norm(r.x) ** -even for r in records]
    return (
        np.concatenate([w * r.columns(radii, rates) for w, r in zip(scale, records, strict=True)]),
        np.concatenate([w * r.f for w, r in zip(scale, records, strict=True)]),
    )


def solved(a: np.ndarray, f: np.ndarray) -> tuple[np.ndarray, float]:
    """Return (weights >= 0 of least squares, violation of the conditions of optimality); by Lawson and Hanson (1974)."""
    from scipy.optimize import nnls

    norms = np.linalg.norm(a, axis=0)
    norms = np.where(norms > 0.0, norms, 1.0)
    # the triangular factor has the same least squares and a twentieth of the rows
    q, r = np.linalg.qr(a / norms)
    b = q.T @ f
    weights = nnls(r, b)[0]
    slope = r.T @ (b - r @ weights)
    wrong = np.where(weights > 0.0, np.abs(slope), np.maximum(slope, 0.0)).max()
    return weights / norms, float(wrong / max(np.abs(r.T @ b).max(), 1e-300))


def _bank_of(weights: np.ndarray, radii, rates) -> Bank:
    n = 1 + len(radii)
    return Bank(float(weights[0]), radii, weights[1:n], rates, weights[n:])


def _fitted(bank: Bank, records: Sequence[Periodic], optimality: float, starts: tuple[float, ...] = ()) -> Fitted:
    each = gains(bank, records)
    power = [np.sum(r.x**2) for r in records]
    whole = np.sqrt(sum(g * g * p for g, p in zip(each, power, strict=True)) / sum(power))
    return Fitted(bank, float(whole), each, optimality, starts)


@one_thread
def nonnegative(records: Sequence[Periodic], radii, rates, even: float = 0.0) -> Fitted:
    """Return the passive bank of given radii and rates with the smallest energy gain; elements of weight 0 stay in it.

    even: how far records of small displacements count as those of large ones, 0 (the energy gain itself) to 1 (wholly).
    """
    a, f = stacked(records, radii, rates, even)
    weights, wrong = solved(a, f)
    return _fitted(_bank_of(weights, radii, rates), records, wrong)


@one_thread
def left_out(records: Sequence[Periodic], radii, rates, even: float) -> float:
    """Return the root mean square, over records, of the energy gain on each that the fit to all others leaves."""
    each = [
        gains(nonnegative([*records[:k], *records[k + 1 :]], radii, rates, even).bank, [r])[0]
        for k, r in enumerate(records)
    ]
    return float(np.sqrt(np.mean(np.square(each))))


def grid(records: Sequence[Periodic], plays: int, creeps: int, reach: float = WHOLE) -> tuple[np.ndarray, np.ndarray]:
    """Return radii and rates, even in the logarithm.

    Radii: from a fiftieth of the largest amplitude A, or a fifth of the smallest where that is less, to `reach` of A. Elements of r and A - r lose as much at A, so
    one beyond A/2 is told from one before it by its stiffness alone; what a bank says beyond its records hangs on which it
    is. For that take a reach of 1/2.
    Rates: from a twentieth of the lowest frequency's or 3 1/s, where an element is all but a spring, to twice the
    sampling's, where it is a damper.
    """
    sizes = [0.5 * np.ptp(r.x) for r in records]
    slowest = min(2 * np.pi / (r.x.size * r.dt) for r in records)
    fastest = max(1.0 / r.dt for r in records)
    radii = np.geomspace(min(LEAST * max(sizes), 0.2 * min(sizes)), reach * max(sizes), plays) if plays else np.zeros(0)
    return radii, np.geomspace(min(slowest / 20, 3.0), 2 * fastest, creeps) if creeps else np.zeros(0)


class Search:
    """Radii and rates as the free numbers of a least squares, their logarithms in theta (plays + creeps,); weights inside."""

    def __init__(self, records: Sequence[Periodic], plays: int, creeps: int):
        self.records, self.plays = records, plays
        ends = [(g[0], g[-1]) for g in grid(records, 2, 2)]
        bounds = np.log([e for e, n in zip(ends, (plays, creeps), strict=True) for _ in range(n)])
        self.low, self.high = bounds.T
        self.even = np.concatenate(
            [np.linspace(*np.log(e), n + 2)[1:-1] for e, n in zip(ends, (plays, creeps), strict=True)]
        )

    def parts(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.exp(np.sort(theta[: self.plays])), np.exp(np.sort(theta[self.plays :]))

    def residual(self, theta: np.ndarray) -> np.ndarray:
        a, f = stacked(self.records, *self.parts(theta))
        return f - a @ solved(a, f)[0]

    def ended(self, start: np.ndarray) -> Fitted:
        from scipy.optimize import least_squares

        bounds = self.low, self.high
        done = least_squares(self.residual, start, bounds=bounds, diff_step=STEP, max_nfev=ROUNDS)
        return nonnegative(self.records, *self.parts(done.x))


@one_thread
def pruned(records: Sequence[Periodic], plays: int, creeps: int, seed: int = 1, starts: int = STARTS) -> Fitted:
    """Return the best passive bank of so many elements, radii and rates searched and weights solved for inside.

    Variable projection (Golub and Pereyra 1973) with non-negative weights, from even radii and rates and from random ones.
    """
    search = Search(records, plays, creeps)
    random = np.random.default_rng(seed)
    drawn = (search.low + (search.high - search.low) * random.random(search.low.size) for _ in range(starts - 1))
    found = [search.ended(start) for start in (search.even, *drawn)]
    best = min(found, key=lambda f: f.gain)
    return replace(best, starts=tuple(f.gain for f in found))


def shaped(records: Sequence[Periodic], radii, rates, falling: float = 1.0) -> Fitted:
    """Return the passive bank whose springs per interval of log r never rise by more than `falling` times from one radius
    to the next larger (1: never), by a quadratic program (Clarabel); k0 is kept at or above 0 as well."""
    import cvxpy as cp

    a, f = stacked(records, radii, rates)
    norms = np.linalg.norm(a, axis=0)
    norms = np.where(norms > 0.0, norms, 1.0)
    q, r = np.linalg.qr(a / norms)
    w = cp.Variable(r.shape[1], nonneg=True)
    springs = cp.multiply(1.0 / norms[1 : 1 + len(radii)], w[1 : 1 + len(radii)])
    scale = float(np.linalg.norm(f))
    problem = cp.Problem(
        cp.Minimize(cp.sum_squares(r @ w - q.T @ f / scale)), [springs[1:] <= falling * springs[:-1]] if len(radii) > 1 else []
    )  # fmt: skip
    problem.solve(solver=cp.CLARABEL)
    if w.value is None:
        raise WorkbenchError(f"the shaped bank was not solved ({problem.status}); give other radii or rates.")
    return _fitted(_bank_of(np.maximum(w.value, 0.0) * scale / norms, radii, rates), records, 0.0)

"""Which parameters moved between two sets of records beyond what their intervals allow.

The same model is fitted to each with every value free. A parameter has moved where |b - a|/sqrt(s_a^2 + s_b^2) is beyond
Student's quantile, with Satterthwaite's degrees of freedom and Holm's correction for the number of parameters: of campaigns
between which nothing changed, 95 in 100 show no change at all. Of parameters that the records know only together, none may
move by itself though all of them together do: the whole vector is compared too, by the same sum of covariances.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.difference.wording import change_sentence, difference_sentence
from workbench.finding import Finding
from workbench.identification import intervals
from workbench.identification.fit import fitted_on
from workbench.identification.problem import Name, Problem
from workbench.identification.result import Estimate
from workbench.identification.solve import Solution, solve
from workbench.inverse.dynamics import InverseDynamics
from workbench.notebook import page
from workbench.plant import Plant
from workbench.threads import one_thread

CHANCE = 0.05  # that anything is said to have moved where nothing has
MATTERS = 0.01  # of the value: a smaller difference is not worth a sentence, however sure it is


@dataclass(frozen=True)
class Change:
    """One parameter as it is written outside, SI. half: half width of the difference's interval, all parameters at once.

    chance: of a difference as large where nothing changed, corrected for the number of parameters. moved: whether it is said
    to have changed.
    """

    effect: str
    at: str
    parameter: str
    unit: str
    before: float
    after: float
    half: float
    chance: float
    moved: bool
    sentence: str


@dataclass(frozen=True, eq=False)
class Difference:
    """changes: every free parameter that both sets of records determine. together: chance of the whole vector's difference.

    undetermined: "effect@at.parameter" that one of the sets does not determine. findings: where the records are not alike.
    """

    changes: tuple[Change, ...]
    undetermined: tuple[str, ...]
    together: float
    sentence: str
    findings: tuple[Finding, ...] = ()

    @property
    def moved(self) -> tuple[Change, ...]:
        return tuple(c for c in self.changes if c.moved)

    def _repr_html_(self) -> str:
        """What moved, as a table of all parameters and a drawing of each difference over its interval's half width."""
        rows = (
            (f"{c.effect}@{c.at}", c.parameter, c.before, c.after, c.half, "moved" if c.moved else "", c.unit)
            for c in self.changes
        )
        head = ("effect", "parameter", "before", "after", "±", "", "unit")
        return page(self.sentence, head, rows, self._draw if self.changes else None)

    def _draw(self, axes) -> None:
        (one,) = axes
        size = [(c.after - c.before) / c.half for c in self.changes]
        one.barh(range(len(size)), size, color=["tab:red" if c.moved else "0.6" for c in self.changes])
        one.axvspan(-1.0, 1.0, alpha=0.15)
        one.set_yticks(range(len(size)), [f"{c.effect}.{c.parameter}" for c in self.changes])
        one.set_xlabel("difference over the half width of its interval")


@dataclass(frozen=True, eq=False)
class Side:
    """One set of records: a plant fitted to it, each estimate with its standard deviation, and the degrees of freedom."""

    plant: Plant
    estimates: dict[tuple[str, str, str], Estimate]
    names: tuple[Name, ...]
    values: np.ndarray
    covariance: np.ndarray
    freedom: float


def _side(plant: Plant, inverses: Sequence[InverseDynamics], theta: np.ndarray | None = None) -> tuple[Side, Solution]:
    """Return one side. theta: where the search of the shape parameters starts."""
    problem = Problem(plant, fitted_on(inverses))
    solution = solve(problem, theta)
    found = problem.at(solution.theta, solution.c)
    names, covariance, _, _ = intervals.covariance(problem, solution)
    told = {(e.effect, e.at, e.parameter): e for e in intervals.estimates(found, names, covariance, 1.0)}
    values = np.array([found[n.key].parameters[n.parameter].value for n in names])
    return Side(found, told, tuple(names), values, covariance, float(intervals.freedom(problem))), solution


@one_thread
def compare(plant: Plant, before: Sequence[InverseDynamics], after: Sequence[InverseDynamics]) -> Difference:
    """Return what moved of a plant's free parameters between the identification records of two campaigns."""
    first, solution = _side(plant, before)
    second, _ = _side(plant, after, solution.theta)
    both = [k for k, e in first.estimates.items() if _known(e) and _known(second.estimates[k])]
    lost = tuple(
        f"{e.effect}@{e.at}.{e.parameter}" for k, e in first.estimates.items() if not e.fixed and k not in both
    )
    pairs = [(first.estimates[k], second.estimates[k]) for k in both]
    raw = [_chance_of(a, b, first.freedom, second.freedom) for a, b in pairs]
    changes = tuple(_change(a, b, p, first, second, len(pairs)) for (a, b), p in zip(pairs, holm(raw), strict=True))
    together = _jointly(first, second)
    return Difference(changes, lost, together, _sentence_of(changes, together))


def _known(e: Estimate) -> bool:
    """Whether the records determine a parameter at all."""
    return not e.fixed and e.high > e.low


def _deviation(e: Estimate) -> float:
    """Standard deviation of an estimate whose interval is one deviation wide to each side."""
    return 0.5 * (e.high - e.low)


def _freedom_of(a: Estimate, b: Estimate, first: float, second: float) -> float:
    """Return Satterthwaite's degrees of freedom of a difference."""
    va, vb = _deviation(a) ** 2, _deviation(b) ** 2
    return (va + vb) ** 2 / (va**2 / first + vb**2 / second)


def _chance_of(a: Estimate, b: Estimate, first: float, second: float) -> float:
    """Return the chance of a difference as large as this where nothing changed."""
    from scipy.special import stdtr

    apart = abs(b.value - a.value) / np.hypot(_deviation(a), _deviation(b))
    return float(2.0 * stdtr(_freedom_of(a, b, first, second), -apart))


def holm(chances: Sequence[float]) -> list[float]:
    """Return chances corrected for their number (Holm 1979): the smallest times n, the next times n - 1, never falling."""
    order = np.argsort(chances, kind="stable")
    corrected = np.empty(len(chances))
    corrected[order] = np.maximum.accumulate(np.array(chances)[order] * np.arange(len(chances), 0, -1))
    return [float(min(p, 1.0)) for p in corrected]


def _jointly(first: Side, second: Side) -> float:
    """Return the chance of the whole vector's difference: d' (A + B)^-1 d, as Hotelling's T^2, smaller freedom counting."""
    from scipy.special import fdtrc

    names = [n for n in first.names if n in second.names]
    if not names:
        return 1.0
    i, j = ([s.names.index(n) for n in names] for s in (first, second))
    d = second.values[j] - first.values[i]
    spread = first.covariance[np.ix_(i, i)] + second.covariance[np.ix_(j, j)]
    sizes = np.sqrt(np.diag(spread))
    d, spread = d / sizes, spread / np.outer(sizes, sizes)
    k, freedom = len(names), min(first.freedom, second.freedom)
    if freedom <= k:
        return 1.0
    squared = float(d @ np.linalg.pinv(spread, rcond=1e-8, hermitian=True) @ d)
    return float(fdtrc(k, freedom - k + 1, squared * (freedom - k + 1) / (freedom * k)))


def _change(a: Estimate, b: Estimate, chance: float, first: Side, second: Side, count: int) -> Change:
    from scipy.special import stdtrit

    t = stdtrit(_freedom_of(a, b, first.freedom, second.freedom), 1.0 - CHANCE / (2 * count))
    half = float(t * np.hypot(_deviation(a), _deviation(b)))
    apart, size = b.value - a.value, max(abs(a.value), abs(b.value))
    moved = chance < CHANCE and abs(apart) > MATTERS * size
    sentence = change_sentence(a, b, half, moved)
    return Change(a.effect, a.at, a.parameter, a.unit, a.value, b.value, half, chance, moved, sentence)


def _sentence_of(changes: Sequence[Change], together: float) -> str:
    """Return what a difference comes to."""
    moved = [f"{c.effect}.{c.parameter}" for c in changes if c.moved]
    return difference_sentence(moved, len(changes), bool(changes) and together < CHANCE, together)

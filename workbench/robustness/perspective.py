"""What errors over many cases come to: both perspectives of robustness, and what may be said of axes yet to be built.

A system may be called robust when its largest error over all conditions stays within what is tolerated, or when its errors
differ little between conditions (Tjahjowidodo, Al-Bender, Van Brussel 2013). The two can rank controllers in opposite
orders, so both are computed, and each is said by its name.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError
from workbench.robustness.cases import INDEPENDENT, Cases

CONFIDENCE = 0.99
EQUAL = 0.05  # relative difference below which two controllers count as equally robust


@dataclass(frozen=True)
class Perspectives:
    """One controller's errors, in the errors' unit. maximum: the first perspective. spread: the second, largest less
    smallest. median, low, high: quantiles at 1/2, 1/100 and 99/100. failed: share of cases whose error is not finite.
    """

    maximum: float
    spread: float
    median: float
    low: float
    high: float
    failed: float


def perspectives(errors: np.ndarray) -> Perspectives:
    """Return both perspectives of errors (n,), not negative; an infinite one makes both infinite."""
    errors = np.asarray(errors, dtype=float)
    failed = ~np.isfinite(errors)
    low, median, high = np.quantile(np.where(failed, np.inf, errors), (0.01, 0.5, 0.99), method="higher")
    spread = np.inf if failed.any() else float(errors.max() - errors.min())
    maximum = np.inf if failed.any() else float(errors.max())
    return Perspectives(maximum, spread, float(median), float(low), float(high), float(failed.mean()))


@dataclass(frozen=True)
class Share:
    """Of axes drawn from the declared distributions at most `upper`, and at least `lower`, exceed `limit`, each statement
    by itself with this confidence. exceeded of count draws did.
    """

    limit: float
    exceeded: int
    count: int
    confidence: float
    lower: float
    upper: float


def share_beyond(cases: Cases, values: np.ndarray, limit: float, confidence: float = CONFIDENCE) -> Share:
    """Return what share of all axes exceeds a limit (Clopper and Pearson 1934); a value that is not finite exceeds it.

    The limit must not be chosen from the draws. Raises WorkbenchError for cases that are no independent draws: of a grid
    or of quasi-random points no probability follows.
    """
    from scipy.stats import beta

    _refuse_dependent(cases)
    n = cases.count
    k = int(np.sum(~(np.asarray(values) <= limit)))
    upper = 1.0 if k == n else float(beta.ppf(confidence, k + 1, n - k))
    lower = 0.0 if k == 0 else float(beta.ppf(1.0 - confidence, k, n - k + 1))
    return Share(float(limit), k, n, confidence, lower, upper)


def share_beyond_worst(cases: Cases, confidence: float = CONFIDENCE) -> float:
    """Return the share p of all axes that at most exceed the worst of n draws: (1 - p)^n = 1 - confidence (Wilks 1941)."""
    _refuse_dependent(cases)
    return float(-np.expm1(np.log1p(-confidence) / cases.count))


def _refuse_dependent(cases: Cases) -> None:
    if cases.kind != INDEPENDENT:
        raise WorkbenchError(
            f"the cases are {cases.kind}, of which no share of all axes follows with any confidence; take independent draws."
        )


@dataclass(frozen=True)
class Order:
    """Controllers by one perspective, the most robust first. values: controller -> what they are ordered by, in the errors' unit.

    ties: those that count as equal to the first.
    """

    names: tuple[str, ...]
    values: Mapping[str, float]
    ties: tuple[str, ...]


def orders(found: Mapping[str, Perspectives]) -> tuple[Order, Order]:
    """Return the order of controllers by the first perspective, their largest error, and by the second, the spread of their errors."""
    return _order({c: p.maximum for c, p in found.items()}), _order({c: p.spread for c, p in found.items()})


def _order(values: Mapping[str, float]) -> Order:
    names = sorted(values, key=values.get)
    ties = tuple(c for c in names[1:] if values[c] <= values[names[0]] * (1.0 + EQUAL))
    return Order(tuple(names), values, ties)

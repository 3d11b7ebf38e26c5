"""Which parameter moves the error: two measures of each from the same draws, each with its standard error.

- Spearman's rank correlation of parameter and error: monotone influence, with its sign.
- The first-order share, Var(E[rank | x]) / Var(rank): how much of the scatter of the errors' ranks would be gone were x
  known, however it acts. Estimated by bins of equal count, with the correction for what bins explain by chance (Kelley 1935).

Ranks, because errors spread over decades and some are infinite. Standard errors by a jackknife over groups of draws.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.robustness.cases import GRID, Cases

BINS = 16
GROUPS = 20
SURE = 3.0  # standard errors from zero


@dataclass(frozen=True)
class Influence:
    """name: of what varies. correlation: rank correlation, share: of the ranks' variance; each with its standard error."""

    name: str
    correlation: float
    correlation_error: float
    share: float
    share_error: float

    @property
    def sure(self) -> bool:
        """Whether one of the measures is off zero by three standard errors."""
        return abs(self.correlation) > SURE * self.correlation_error or self.share > SURE * self.share_error


def _ranks(values: np.ndarray) -> np.ndarray:
    """Return ranks from 0 to 1, equal values sharing theirs; infinite ones are the largest."""
    from scipy.stats import rankdata

    return (rankdata(np.nan_to_num(values, nan=np.inf)) - 0.5) / len(values)


def _correlation(x: np.ndarray, y: np.ndarray) -> float:
    """Pearson's correlation; zero where one does not vary."""
    x, y = x - x.mean(), y - y.mean()
    size = np.sqrt((x * x).sum() * (y * y).sum())
    return float((x * y).sum() / size) if size > 0.0 else 0.0


def first_order(x: np.ndarray, y: np.ndarray, bins: int = BINS) -> float:
    """Return Var(E[y | x]) / Var(y) by bins of equal count in x; may be slightly negative where x does nothing."""
    n = len(y)
    bins = max(2, min(bins, n // 4))
    total = ((y - y.mean()) ** 2).sum()
    if not total > 0.0:
        return 0.0
    group = np.empty(n, dtype=np.intp)
    group[np.argsort(x, kind="stable")] = np.arange(n) * bins // n
    count = np.bincount(group, minlength=bins)
    mean = np.bincount(group, weights=y, minlength=bins) / count
    between = (count * (mean - y.mean()) ** 2).sum()
    within = (total - between) / (n - bins)
    return float((between - (bins - 1) * within) / total)


def _jackknife(measure: Callable, x: np.ndarray, y: np.ndarray, groups: int = GROUPS) -> float:
    """Return the standard error of a measure, by leaving out every `groups`-th draw in turn."""
    groups = min(groups, len(y))
    left = np.arange(len(y)) % groups
    values = np.array([measure(x[left != g], y[left != g]) for g in range(groups)])
    return float(np.sqrt((groups - 1) * np.mean((values - values.mean()) ** 2)))


def influences(cases: Cases, errors: np.ndarray) -> tuple[Influence, ...]:
    """Return the influence of all that varies on errors (n,), the strongest first. A grid has none: its draws are its levels."""
    if cases.kind == GRID or cases.count < 4 * GROUPS:
        return ()
    y = _ranks(errors)
    found = []
    for i, v in enumerate(cases.varied):
        x = cases.values[:, i]
        if x.min() == x.max():
            continue
        r = _ranks(x)
        found.append(
            Influence(v.name, _correlation(r, y), _jackknife(_correlation, r, y), first_order(r, y), _jackknife(first_order, r, y))
        )  # fmt: skip
    return tuple(sorted(found, key=lambda f: -f.share))

"""Cases that a controller is judged over: independent draws, a grid, or points spread evenly.

A draw is a number of its name, its seed and its own index alone: NumPy's SeedSequence makes one stream of each name, so
that neither the number of threads or workers, nor how many axes are drawn, nor what else varies, changes it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError
from workbench.robustness.distribution import Distribution

INDEPENDENT, GRID, EVEN = "independent draws", "a grid", "quasi-random points"


@dataclass(frozen=True)
class Varied:
    """name: what differs between axes, as workbench.robustness.vary reads it. distribution: in SI, or where `relative` as a
    factor on the nominal value. unit: SI, "1" for a factor.
    """

    name: str
    distribution: Distribution
    relative: bool = False
    unit: str = "1"


@dataclass(frozen=True, eq=False)
class Cases:
    """kind: how they were chosen, on which depends what may be said of them. varied (k,). values (n, k): SI."""

    kind: str
    varied: tuple[Varied, ...]
    values: np.ndarray

    def __post_init__(self):
        values = np.array(self.values, dtype=float)
        if values.ndim != 2 or values.shape[1] != len(self.varied) or not len(values) or not np.isfinite(values).all():
            raise WorkbenchError(f"cases need one finite number of each of the {len(self.varied)} that vary.")
        values.flags.writeable = False
        object.__setattr__(self, "values", values)

    @property
    def count(self) -> int:
        return len(self.values)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(v.name for v in self.varied)


def _checked(varied: Sequence[Varied], count: int) -> tuple[Varied, ...]:
    names = [v.name for v in varied]
    if count < 1 or not names:
        raise WorkbenchError("state what varies, and how many axes are drawn: at least one.")
    if twice := [n for n in names if names.count(n) > 1]:
        raise WorkbenchError(f"'{twice[0]}' varies twice; state one distribution for it.")
    return tuple(varied)


def independent(varied: Sequence[Varied], count: int, seed: int) -> Cases:
    """Return `count` axes, each number drawn independently of every other; draw i is the same for every count above i."""
    varied = _checked(varied, count)
    columns = []
    for v in varied:
        stream = np.random.default_rng(np.random.SeedSequence([seed, *v.name.encode()]))
        columns.append(v.distribution.at(stream.random(count)))
    return Cases(INDEPENDENT, varied, np.stack(columns, axis=1))


def even(varied: Sequence[Varied], count: int, seed: int) -> Cases:
    """Return scrambled Sobol points (Owen 1998): they cover evenly, but are not independent. count: a power of two."""
    from scipy.stats import qmc

    varied = _checked(varied, count)
    if count & (count - 1):
        raise WorkbenchError(f"{count} quasi-random points are no balanced set; take a power of two.")
    share = qmc.Sobol(len(varied), rng=np.random.default_rng(seed)).random(count)
    return Cases(EVEN, varied, np.stack([v.distribution.at(share[:, i]) for i, v in enumerate(varied)], axis=1))


def grid(varied: Sequence[Varied], levels: Sequence[Sequence[float]]) -> Cases:
    """Return every combination of levels, a list for each that varies, the last one running fastest."""
    varied = _checked(varied, 1)
    points = np.meshgrid(*levels, indexing="ij")
    return Cases(GRID, varied, np.stack([p.ravel() for p in points], axis=1))

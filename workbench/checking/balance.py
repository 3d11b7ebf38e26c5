"""The drive's balance of one record: what it reports, and what each parameter of the plant asks of it."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from workbench.definition import FORCE
from workbench.identification.problem import Problem
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.record import Record


@dataclass(frozen=True, eq=False)
class Balance:
    """The drive's balance of one record, filtered and trimmed: drive (n,) = columns (n, p) times the linear parameters.

    names: "effect@at.parameter" of each column; further columns, a constant and the position, stand for weight, springs
    and offsets that no model may declare. lower: what the parameters may not fall below. dt: s.
    """

    record: Record
    drive: np.ndarray
    columns: np.ndarray
    names: tuple[str, ...]
    lower: np.ndarray
    dt: float

    @cached_property
    def gram(self) -> np.ndarray:
        return self.columns.T @ self.columns

    @cached_property
    def power(self) -> float:
        """Sum of squares of the drive about its mean: a held weight is explained by anything."""
        return float(np.sum((self.drive - np.mean(self.drive)) ** 2))

    def solved(self, moment: np.ndarray) -> np.ndarray:
        """Return the parameters (p, ...) of moments (p, ...), columns' transpose times a drive."""
        norms = np.sqrt(np.diag(self.gram))
        norms = np.where(norms > 0, norms, 1.0)
        inverse = np.linalg.pinv(self.gram / np.outer(norms, norms), rcond=1e-12, hermitian=True)
        return inverse @ (moment.T / norms).T / (norms if moment.ndim == 1 else norms[:, None])

    def halves(self) -> tuple["Balance", "Balance"]:
        """Return the first and the second half of the record."""
        middle = self.drive.size // 2
        parts = (slice(0, middle), slice(middle, None))
        return tuple(replace(self, drive=self.drive[p], columns=self.columns[p]) for p in parts)

    def share(self, name: str, parameters: np.ndarray) -> float:
        """Return rms of one parameter's part over rms of the drive."""
        k = self.names.index(name)
        return float(abs(parameters[k]) * np.sqrt(self.gram[k, k] / max(self.power, 1e-300)))


def freed(plant: Plant) -> Plant:
    """Return the plant with every linear parameter of a force free: declared values are what is checked."""
    return replace(plant, effects=tuple(e.free(*e.linear) if e.port == FORCE else e for e in plant.effects))


def balance(plant: Plant, p: InverseDynamics) -> Balance:
    """Return the balance of a record."""
    problem = Problem(plant, [p])
    y, phi = problem.assemble(problem.start())
    rows, m = p.rows(plant), p.motion
    phi, y = np.nan_to_num(phi[::rows]), y[::rows]  # the drive's own balance; an effect without value has no part in it
    used = np.any(phi, axis=0)
    q = m.q[m.keep]
    columns = np.column_stack([phi[:, used], np.ones(y.size), q - np.mean(q)])
    free = [n for n, u in zip(problem.free_linear, used, strict=True) if u]
    lower = np.array([*(problem.parameter(n).lower for n in free), -np.inf, -np.inf])
    names = (*(f"{n.key}.{n.parameter}" for n in free), "constant", "position")
    return Balance(m.record, y, columns, names, lower, m.dt)

"""What the files have in common, and what is guessed of one column."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.errors import WorkbenchError
from workbench.intake.names import Meaning, meaning
from workbench.readers import Survey

FEWEST, FEW = (
    10,
    100,
)  # changes of a column that moves, of a hundred samples one: with fewer it is stuck, or not connected


@dataclass(frozen=True)
class Scale:
    """As campaign.toml has it. assumed: for its engineer to put in. why: what the number is."""

    value: float
    unit: str
    assumed: bool
    why: str


@dataclass(frozen=True)
class Guess:
    """One channel. channel: of the campaign format. column, unit: in the files. why: a clause.

    scale: of a time column that counts, or whose unit is assumed. rate: Hz, of samples without a time column. stated: whether
    the unit is the file's or its user's.
    """

    channel: str
    column: str
    unit: str
    why: str
    kind: str = ""
    scale: Scale | None = None
    rate: float = 0.0
    stated: bool = True


@dataclass(frozen=True)
class Columns:
    """What is common to all files. data: of each file, name -> (n,). meanings: name -> what the name says."""

    surveys: tuple[Survey, ...]
    meanings: Mapping[str, Meaning]

    @property
    def names(self) -> list[str]:
        return list(self.meanings)

    @property
    def path(self):
        return self.surveys[0].path

    def of(self, name: str) -> list[np.ndarray]:
        return [s.columns[name] for s in self.surveys]

    def moves(self, name: str) -> bool:
        changes = [int(np.count_nonzero(np.diff(x))) for x in self.of(name)]
        return sum(changes) >= min(FEWEST, sum(x.size for x in self.of(name)) // FEW)

    def only(self, names: Sequence[str]) -> "Columns":
        """Return these columns alone."""
        return replace(self, meanings={n: m for n, m in self.meanings.items() if n in names})


def common(surveys: Sequence[Survey], units: Mapping[str, str] | None = None, fewest: int = 3) -> Columns:
    """Return the columns that every file has. units: column -> unit, as its user says.

    Raises WorkbenchError where there are less than `fewest`: time, drive and position.
    """
    first, units = surveys[0], units or {}
    names = [n for n in first.columns if all(n in s.columns for s in surveys)]
    if len(names) < fewest:
        why = "".join(f" Left out: {text}" for s in surveys for text in list(s.refused.values())[:3])
        raise WorkbenchError(
            f"{first.path}: {len(names)} columns of numbers are common to all records ({', '.join(names) or 'none'}); time, "
            f"drive (torque, force or current) and position are needed in each, under the same names.{why}"
        )
    meanings = {n: meaning(n, units.get(n) or first.units.get(n, "")) for n in names}
    return Columns(tuple(surveys), meanings)

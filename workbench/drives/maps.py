"""Compensation tables: a quantity over position or speed, as two columns of CSV behind a head that says what it is.

A table whose phase belongs to a power-up says so in its head; it may be switched on after homing only.
"""

from dataclasses import dataclass

import numpy as np

from workbench.definition import Effect
from workbench.drives.fields import LICENCE, number
from workbench.errors import WorkbenchError
from workbench.kernel.step import build

HOMING = "valid after homing only"
ALWAYS = "valid always"


@dataclass(frozen=True, eq=False)
class Map:
    """what: "cogging", "kinematic error" or "friction". over, of: column heads with units. x, y (n,): SI. period: of x, or 0.

    homing: the phase belongs to a power-up.
    """

    what: str
    over: str
    of: str
    x: np.ndarray
    y: np.ndarray
    period: float
    homing: bool

    def text(self) -> str:
        """The table as CSV."""
        head = [
            f"# {self.what}; {HOMING if self.homing else ALWAYS}; period {self.period!r}",
            f"# {LICENCE}",
            f"{self.over},{self.of}",
        ]
        rows = [f"{float(x)!r},{float(y)!r}" for x, y in zip(self.x, self.y, strict=True)]
        return "\n".join(head + rows) + "\n"


def read(content: str, what: str) -> Map:
    """Return the map of a table; WorkbenchError, naming the line, unless it is one of `what`, finite and increasing."""
    lines = content.splitlines()
    parts = lines[0].removeprefix("# ").split("; ") if lines else []
    if (
        len(lines) < 5
        or len(parts) != 3
        or parts[0] != what
        or parts[1] not in (HOMING, ALWAYS)
        or not parts[2].startswith("period ")
    ):
        raise WorkbenchError(f"this is no table of {what} with its head and two rows.")
    rows = []
    for n, line in enumerate(lines[3:], 4):
        cells = line.split(",")
        if len(cells) != 2:
            raise WorkbenchError(f"table of {what}, line {n}: two cells are needed.")
        rows.append([number(c, f"table of {what}, line {n}") for c in cells])
    x, y = np.array(rows).T
    if not (np.diff(x) > 0.0).all():
        raise WorkbenchError(f"table of {what}: its first column does not increase.")
    over, of = lines[2].split(",")
    return Map(what, over, of, x, y, number(parts[2].removeprefix("period "), f"table of {what}"), parts[1] == HOMING)


def values_of(effect: Effect, signals: dict[str, np.ndarray]) -> np.ndarray:
    """Return an effect's output (n,) along signals; WorkbenchError where it reads what is not given."""
    if missing := set(effect.reads) - set(signals):
        raise WorkbenchError(f"effect '{effect.name}' reads {sorted(missing)[0]}, which no table is over.")
    values = {n: p.value for n, p in effect.parameters.items()}
    step = build(effect)
    found = step.run({n: signals[n] for n in effect.reads}, values)
    weights = [values[n] if n else 1.0 for n in step.columns]
    return sum(w * row for w, row in zip(weights, found, strict=False))


def cells_of(count: int) -> int:
    """Check how many rows a table is to have; WorkbenchError outside 4 to 4096, which drives hold."""
    if not 4 <= count <= 4096:
        raise WorkbenchError(f"a compensation table of {count} rows; 4 to 4096 are possible.")
    return count

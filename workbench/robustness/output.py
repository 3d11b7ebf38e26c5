"""A series as files: its worst cases, and every draw with what came of it."""

from pathlib import Path

import numpy as np

from workbench.robustness import worst
from workbench.robustness.result import Series
from workbench.robustness.workload import KEPT

DRAWS = "draws.csv"


def write(found: Series, folder: Path) -> None:
    """Write the worst cases and every draw into a folder that is made for them."""
    folder.mkdir()
    worst.write(found.work, found.worst, folder / worst.FILE)
    _write_draws(found, folder / DRAWS)


def _write_draws(found: Series, file: Path) -> None:
    """Write every draw with what came of it, a row each, exact decimals."""
    cases, columns = found.cases, found.columns
    heads = [*cases.names, *(f"{c}: {m}" for c in columns for m in KEPT)]
    data = np.column_stack([cases.values, *(columns[c][m] for c in columns for m in KEPT)])
    lines = [",".join(f'"{h}"' for h in heads), *(",".join(map(repr, row)) for row in data.tolist())]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")

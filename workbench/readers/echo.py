"""The CSV of `ros2 topic echo --csv` for sensor_msgs/JointState, which has no header.

A row is the message's fields one after the other, lists element by element: seconds and nanoseconds of the stamp, the frame,
the names of the joints, and then their positions, velocities and efforts, each of which may be empty.
"""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.readers.cells import number
from workbench.readers.held import Held

FIELDS = ("position", "velocity", "effort")


def is_echo(lines: Sequence[str]) -> bool:
    """Whether a text's first rows are stamp, frame and names of joints, with one, two or three numbers a joint."""
    return bool(lines) and _joints(next(csv.reader(lines[:1]), [])) > 0


def _joints(cells: Sequence[str]) -> int:
    """Return how many joints a row has, or 0 where it is none."""
    if len(cells) < 5 or not (cells[0].isdecimal() and cells[1].isdecimal() and int(cells[1]) < 10**9):
        return 0
    rest = cells[2:]
    texts = next((k for k, c in enumerate(rest) if k and number(c)), len(rest))
    count = texts - 1  # the first is the frame
    same = count > 0 and not number(rest[0]) and all(rest[1:texts]) and len(set(rest[1:texts])) == count
    return (
        count if same and all(map(number, rest[texts:])) and len(rest) - texts in (count, 2 * count, 3 * count) else 0
    )


def held(text: str, path: Path) -> dict[str, Held]:
    """Return "position.JOINT" and so on; of two numbers a joint the second may be either, "velocity or effort.JOINT"."""
    rows = list(csv.reader(text.rstrip("\n").split("\n")))
    count, width = _joints(rows[0]), len(rows[0])
    for k, row in enumerate(rows, 1):
        if len(row) != width or _joints(row) != count:
            raise WorkbenchError(
                f"{path}, row {k}: is no message like that of row 1; remove the row, or cut the record there."
            )
    names, values = rows[0][3 : 3 + count], np.array([row[3 + count :] for row in rows], float)
    clock = np.array([int(row[0]) + 1e-9 * int(row[1]) for row in rows])
    fields = FIELDS if values.shape[1] == 3 * count else ("position", "velocity or effort")
    return {f"{fields[k // count]}.{names[k % count]}": Held(values[:, k], "", clock) for k in range(values.shape[1])}

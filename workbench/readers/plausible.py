"""Samples that no axis has: said with record and sample, before anything is computed of them."""

import numpy as np

from workbench.errors import UnsoundRecord
from workbench.finding import GLITCH

LARGEST = 1e12  # in any SI unit: far beyond every axis, and its fourth power is far below what overflows
HUGE = 1e200  # what is larger overflows in some scales, and is as far beyond LARGEST in all of them


def plausible(record: str, channel: str, c, values: np.ndarray, sheet, first: int) -> None:
    """Raise UnsoundRecord where a value, in SI, is no number or larger than any axis has: squares of it would overflow.

    c: the declared channel. first: number of the first of these samples in the file.
    """
    beyond = np.flatnonzero(~(np.abs(values) <= LARGEST))
    if beyond.size:
        k = int(beyond[0])
        many = f", as are {beyond.size - 1} further samples" if beyond.size > 1 else ""
        raise UnsoundRecord(
            f"{sheet.place(k + first)}: sample {k + 1} of {channel} in record '{record}' is "
            f"{sheet.channels[channel][k + first]:.6g} {c.unit}, "
            f"more than {LARGEST:g} {c.si}{many}: no axis has that; mend the sample, or the scale of column '{c.column}'.",
            GLITCH if beyond.size == 1 else "scale",
            record,
        )

"""Dates and times of day as logs write them, in seconds."""

import re
from collections.abc import Sequence

import numpy as np

ISO = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d([.,]\d{1,9})?( ?(Z|UTC|[+-]\d\d:?\d\d))?", re.ASCII)
DAY = re.compile(r"\d\d?:\d\d:\d\d([.,]\d{1,9})?", re.ASCII)
ZONE = re.compile(r" ?(Z|UTC|[+-]\d\d:?\d\d)$")


def written(cell: object) -> bool:
    """Whether a cell is a date with time (ISO 8601) or a time of day ("10:15:00.250")."""
    return isinstance(cell, str) and bool(ISO.fullmatch(cell.strip(' "')) or DAY.fullmatch(cell.strip(' "')))


def seconds(cells: Sequence[str]) -> np.ndarray:
    """Return (n,) s since 1970, or since midnight, of cells that are `written` alike.

    The zone of the first cell is left out of all: what counts is the time between samples. Raises ValueError for a cell
    that is no such time.
    """
    texts = [c.strip(' "').replace(",", ".") for c in cells]
    if not all(map(written, texts)):
        raise ValueError("is no date or time of day")
    if DAY.fullmatch(texts[0]):
        return np.array([sum(float(p) * w for p, w in zip(t.split(":"), (3600, 60, 1), strict=True)) for t in texts])
    return since_1970(np.array([ZONE.sub("", t).replace(" ", "T") for t in texts], "datetime64[ns]"))


def since_1970(dates: np.ndarray) -> np.ndarray:
    """Return datetime64 or timedelta64 (n,) in s; what is no date becomes nan."""
    kind = "datetime64[ns]" if dates.dtype.kind == "M" else "timedelta64[ns]"
    exact = dates.astype(kind).astype(np.int64)
    return np.where(np.isnat(dates), np.nan, exact / 1e9)

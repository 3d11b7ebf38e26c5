"""Units that a file states itself, against those that its campaign declares."""

from math import isclose

from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.readers import wording
from workbench.units import to_si
from workbench.units.registry import legible, tidy


def stated(record: str, column: str, unit: str, declared: str) -> Finding | None:
    """Return a finding where the file states another unit than is declared for the column, or None."""
    said = wording.other_unit(record, column, unit, declared)
    return said if _differs(column, unit, declared) else None


def _differs(column: str, unit: str, declared: str) -> bool:
    """Whether two units are not the same; what cannot be read as one ("Nm", "counts") differs from none."""
    if tidy(unit) == "1" or not legible(tidy(unit)):
        return False
    try:
        return not isclose(to_si(1.0, unit, tidy(declared), column, step=True), 1.0, rel_tol=1e-9)
    except WorkbenchError:  # of another dimension
        return True

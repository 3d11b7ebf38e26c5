"""Laws by name: files and other machines hold a controller as its law's name and its numbers."""

from functools import cache

from workbench.control import laws, profile
from workbench.control.law import FEEDBACK, FOLLOWED, Law
from workbench.errors import WorkbenchError, nearest


@cache
def every() -> dict[str, Law]:
    """Return every law that a controller of this package can have, by its name."""
    fixed = (laws._PD, laws._CASCADE, laws._DUAL, profile._PLAIN, profile._FED)
    scheduled = (
        laws._scheduled(rule, follows, profiled)
        for rule in laws.RULES
        for follows in FOLLOWED
        for profiled in (False, True)
        if follows == FEEDBACK or rule == laws.FOLLOWING
    )
    return {one.name: one for one in (*fixed, *scheduled)}


def law(name: str) -> Law:
    """Return a law by its name; WorkbenchError with the nearest names where there is none."""
    if name not in every():
        raise WorkbenchError(f"there is no law '{name}' of a controller; {nearest(name, every())}")
    return every()[name]

"""Laws by name: files and other machines hold a controller as its law's name and its numbers."""

import copyreg
from dataclasses import fields
from functools import cache

from workbench.control import drive, laws, notched, profile
from workbench.control.law import FEEDBACK, FOLLOWED, Law
from workbench.errors import WorkbenchError, nearest


@cache
def every() -> dict[str, Law]:
    """Return every law that a controller of this package can have, by its name."""
    either = (False, True)
    fixed = (laws._PD, laws._PD_MOTOR, laws._CASCADE, laws._DUAL, laws._ON_MOTOR)
    profiles = (profile._law(fed, motor_speed) for fed in either for motor_speed in either)
    scheduled = (
        laws._scheduled(rule, follows, profiled, motor_speed)
        for rule in laws.RULES
        for follows in FOLLOWED
        for profiled in either
        for motor_speed in either
        if follows == FEEDBACK or rule == laws.FOLLOWING
    )
    plain = (*fixed, *profiles, *scheduled)
    drives = (drive._law(count) for count in range(drive.MOST + 1))
    return {one.name: one for one in (*plain, *(notched.law_of(p) for p in plain), *drives)}


def law_named(name: str) -> Law:
    """Return a law by its name; WorkbenchError with the nearest names where there is none."""
    if name not in every():
        raise WorkbenchError(f"there is no law '{name}' of a controller; {nearest(name, every())}")
    return every()[name]


def _pickled(law: Law) -> tuple:
    """Return how a law is pickled: one that is known by its name goes by it, so that it is the same one wherever it is unpickled."""
    if every().get(law.name) is law:
        return law_named, (law.name,)
    return Law, tuple(getattr(law, f.name) for f in fields(law))


copyreg.pickle(Law, _pickled)

"""What changed in a plant between tuning and export, named line by line."""

import hashlib
from collections.abc import Iterable

from workbench.errors import WorkbenchError

SHOWN = 6


def digest(lines: Iterable[str]) -> str:
    """Return the sha256, in hex, over lines as a plant's digest is: joined by line feeds, UTF-8."""
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def changed(old_lines: Iterable[str], new_lines: Iterable[str]) -> tuple[str, ...]:
    """Return one clause for each digest line that differs, such as "inertia@axis.inertia was 0.15, is 0.16".

    A line is a key, a blank and a value. Those of the old plant come first, in its order; then what was added.
    """
    old, new = (
        {key: value for key, _, value in (line.partition(" ") for line in lines)} for lines in (old_lines, new_lines)
    )
    found = []
    for key, value in old.items():
        if key not in new:
            found.append(f"{key} was {value}, is gone")
        elif new[key] != value:
            found.append(f"{key} was {value}, is {new[key]}")
    found += [f"{key} was absent, is {value}" for key, value in new.items() if key not in old]
    return tuple(found)


def insist_same(schedule, plant, tuned_lines: Iterable[str] | None = None) -> None:
    """Raise WorkbenchError, naming what changed, unless `plant` is the one that `schedule` was tuned on.

    tuned_lines: the digest lines of the plant that was tuned; else `schedule.plant_lines`, where there are some.
    """
    if schedule.plant_digest == plant.digest:
        return
    lines = tuned_lines if tuned_lines is not None else getattr(schedule, "plant_lines", None)
    head = "the plant has changed since the gains were tuned"
    mend = "Tune again, or export for the plant that was tuned."
    if not lines:
        raise WorkbenchError(
            f"{head} (digest {schedule.plant_digest[:12]}, now {plant.digest[:12]}); what changed cannot be named, since"
            f" the schedule does not hold the lines of the plant it was tuned on. {mend}"
        )
    lines = tuple(lines)
    if digest(lines) != schedule.plant_digest:
        raise WorkbenchError(
            f"{head} (digest {schedule.plant_digest[:12]}, now {plant.digest[:12]}); what changed cannot be named, since"
            f" the lines given are those of yet another plant ({digest(lines)[:12]}). {mend}"
        )
    clauses = changed(lines, plant.digest_lines())
    more = f"; and {len(clauses) - SHOWN} more" if len(clauses) > SHOWN else ""
    raise WorkbenchError(f"{head}: {'; '.join(clauses[:SHOWN])}{more}. {mend}")

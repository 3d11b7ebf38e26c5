"""Which record is for what: log files, cut at gaps in their samples, as identification and validation."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.intake import signals
from workbench.intake.columns import Columns
from workbench.intake.names import words_of
from workbench.readers import sampling, stem
from workbench.record import IDENTIFICATION, VALIDATION

CALM = (0.55, 0.75)  # of a single record: where it is parted, at the calmest moment
WORDS = {"val", "valid", "validation", "validate", "test", "check", "verify", "verification"}
DWELL = 0.02  # of the largest speed: an axis slower than this rests
APART = 0.1  # records whose shares of rest differ by less are taken for motions of one kind


@dataclass(frozen=True)
class Entry:
    """One [[records]] of the proposed campaign. survey: which file. since, until, counts_from: s, where a file is parted.

    locked: the load's encoder stands while the motor's moves.
    """

    survey: int
    role: str
    why: str
    name: str = ""
    since: float | None = None
    until: float | None = None
    counts_from: float | None = None
    locked: bool = False


@dataclass(frozen=True, eq=False)
class Stretch:
    """Samples of a file without a gap. survey: which file. samples: which of its own. time: (n,) s. since, until: s, in the middle
    of the gaps about it; None at an end of the file."""

    survey: int
    samples: slice
    time: np.ndarray
    since: float | None = None
    until: float | None = None

    @property
    def whole(self) -> bool:
        return self.since is None and self.until is None


def stretches(survey: int, time: np.ndarray) -> list[Stretch]:
    """Return what lies between the gaps of a file's clock (n,), s, and is worth a record; all of it where nothing is."""

    def between(k: int) -> float | None:
        return round(float(time[k - 1] + time[k]) / 2.0, 6) if 0 < k < time.size else None

    found = sampling.stretches(time)
    return [Stretch(survey, s, time[s], between(s.start), between(s.stop)) for s in found]


def entries(columns: Columns, parts: Sequence[Stretch], places, rates, bands) -> tuple[Entry, ...]:
    """Say what each stretch is for: by its file's name, else the one that rests most validates; a single one is parted.

    places: position of each, (n,), as logged. rates, bands: Hz, of each.
    """
    moving = list(zip(places, rates, bands, strict=True))
    if len(parts) == 1:
        made = _parted(parts[0].time, signals.resting(*moving[0]))
        return tuple(replace(e, name=f"{_name(columns, e)}_{e.name}") for e in map(_cut, made, 2 * parts))
    why = _validating(columns, parts, moving)
    made = [
        _cut(Entry(s.survey, *((VALIDATION, why[k]) if k in why else (IDENTIFICATION, "the others are fitted"))), s)
        for k, s in enumerate(parts)
    ]
    return tuple(_numbered(columns, made))


def _validating(columns: Columns, parts: Sequence[Stretch], moving) -> dict[int, str]:
    """Return the numbers of the stretches that validate, each with the reason."""
    named = [k for k, s in enumerate(parts) if WORDS & set(words_of(stem(columns.surveys[s.survey].path))[0])]
    if named and len(named) < len(parts):
        return dict.fromkeys(named, "its name says so")
    rest = [float(np.mean(signals.resting(*x) < DWELL)) for x in moving]
    top = [k for k, share in enumerate(rest) if share >= max(rest) - APART]
    k = top[-1]
    if len(top) > 1:
        return {k: "records of one kind are fitted but for the last"}
    return {k: f"it rests for {100 * rest[k]:.0f} % of its time, as an axis does that positions"}


def _cut(entry: Entry, part: Stretch) -> Entry:
    """Return an entry within the gaps about its stretch."""
    if part.whole:
        return entry
    until = part.until if entry.until is None else entry.until
    return replace(
        entry, survey=part.survey, since=part.since, until=until, why=f"{entry.why}; cut at a gap in its samples"
    )


def _numbered(columns: Columns, made: Sequence[Entry]) -> Iterator[Entry]:
    """Name entries of one file by their number; a file that is one record is named by its own name."""
    count: dict[int, int] = {}
    for e in made:
        count[e.survey] = count.get(e.survey, 0) + 1
        several = sum(other.survey == e.survey for other in made) > 1
        yield replace(e, name=f"{_name(columns, e)}_{count[e.survey]}") if several else e


def _name(columns: Columns, entry: Entry) -> str:
    name = stem(columns.surveys[entry.survey].path).replace(" ", "_")
    return "".join(c for c in name if c.isalnum() or c in "_-") or "record"


def _parted(time: np.ndarray, speed: np.ndarray) -> tuple[Entry, Entry]:
    """Part the only record in time: fitted up to the calmest moment between 55 and 75 % of it, and validated after it."""
    first, last = (int(share * time.size) for share in CALM)
    at = float(time[first + int(np.argmin(speed[first:last]))])
    why = "the only record is parted at its calmest moment between 55 and 75 %"
    later = f"{why}; what lies before only brings friction into its state"
    return (
        Entry(0, IDENTIFICATION, why, "first", until=at),
        Entry(0, VALIDATION, later, "second", counts_from=at),
    )

"""A new study from log files: surveyed, guessed, written whole, and read back before it is kept."""

import hashlib
import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from workbench import campaign
from workbench.errors import WorkbenchError
from workbench.finding import capital
from workbench.intake.columns import common
from workbench.intake.guess import channels
from workbench.intake.names import alike, known_unit
from workbench.intake.others import unused
from workbench.intake.proposal import proposal
from workbench.intake.text import campaign_text, lines_of, study_text
from workbench.outputs import whole
from workbench.readers import stem, survey

STUDY, FOLDER = "study.toml", "campaign"
NAME = re.compile(r"\w[\w.-]*")
LONGEST = 100  # characters; file systems end at 255 bytes, and outputs append to it
VERBS = (
    "all",
    "bench",
    "bench-trace",
    "clean",
    "fuzz",
    "help",
    "lock",
    "setup",
    "test",
    "third-party",
)  # of the Makefile


@dataclass(frozen=True)
class New:
    """folder: of the study. lines: what was guessed and why. edit: keys of campaign.toml that wait for a number."""

    folder: Path
    lines: tuple[str, ...]
    edit: tuple[str, ...]


def new(
    place: Path, files: Sequence[Path], told: Mapping[str, str] | None = None, *,
    units: Mapping[str, str] | None = None, axis: str = "", rate: float | None = None,
) -> New:  # fmt: skip
    """Write a study with its campaign into `place`, which must not exist, and return what was guessed.

    told: channel ("time", "drive", "position", "reference", "load_position") -> column, where its user knows better.
    units: column -> unit, likewise. axis: which of several is meant. rate: Hz, where no column is the time.
    Raises WorkbenchError, and writes nothing, where the files cannot make a campaign that loads.
    """
    _named(place)
    _different(files)
    units = _known(units or {})
    columns = common([survey(f) for f in files], units, 3 if rate is None else 2)
    guesses = channels(columns, told or {}, axis=axis, rate=rate)
    aside = unused(columns, guesses)
    if any(s.notes for s in columns.surveys):  # put on one raster: that of the columns that are used counts
        used = [g.column for g in guesses if g.column]
        columns = common([survey(f, used) for f in files], units, len(used))
    surveys = columns.surveys
    made = proposal(columns, guesses)
    title = capital(place.name.replace("_", " "))
    copies = _names(files)
    with whole(place, STUDY) as beside:
        inner = beside / FOLDER
        inner.mkdir()
        for file, name in zip(files, copies, strict=True):
            shutil.copyfile(file, inner / name)
        (inner / campaign.FILE).write_text(campaign_text(title, made, copies), encoding="utf-8")
        (beside / STUDY).write_text(study_text(title, made), encoding="utf-8")
        _readable(inner)
    aside += [f"Left out: {why}" for s in surveys for why in s.refused.values()]
    aside += [f"{s.path.name}: {note}" for s in surveys for note in s.notes]
    edit = tuple(f"channels.{c.guess.channel}.scale" for c in made.channels if c.scale and c.scale.assumed)
    return New(place, (*lines_of(made, copies), *aside), edit)


def _named(place: Path) -> None:
    """Refuse a name that a folder, a command line or the Makefile would misunderstand."""
    name = place.name
    if place.exists():
        raise WorkbenchError(f"{place} is there already; choose another name, or remove it.")
    if not NAME.fullmatch(name) or len(name) > LONGEST:
        raise WorkbenchError(
            f"'{name[:LONGEST]}' cannot name a study; letters, digits, '_', '-' and '.' can, {LONGEST} at most, a letter or digit first."
        )
    if name in VERBS:
        raise WorkbenchError(f"'{name}' is a command of the Makefile (make {name}); choose another name.")


def _different(files: Sequence[Path]) -> None:
    """Refuse one log under two names: it would be validated on what it was fitted to."""
    seen: dict[str, Path] = {}
    for file in files:
        digest = hashlib.sha256(file.read_bytes()).hexdigest() if file.is_file() else str(file)
        if digest in seen:
            raise WorkbenchError(f"{file}: holds the same bytes as {seen[digest]}; name each log once.")
        seen[digest] = file


def _known(units: Mapping[str, str]) -> dict[str, str]:
    """Return column -> unit in this project's spelling."""
    found = {column: known_unit(unit) for column, unit in units.items()}
    for column, unit in found.items():
        if not unit:
            near = ", ".join(alike(units[column], ""))
            raise WorkbenchError(
                f"--unit {column}={units[column]}: there is no such unit; known are {near} and others."
            )
    return found


def _readable(folder: Path) -> None:
    """Load the campaign as a run will; what keeps it from loading is said of the folder that it is about."""
    try:
        campaign.load(folder)
    except WorkbenchError as e:
        raise WorkbenchError(f"these records make no campaign: {str(e).replace(f'{folder}/', '')}") from e


def _names(files: Sequence[Path]) -> list[str]:
    """Return a name within the folder for each file; of files with one stem the later ones get a number."""
    names, stems = [], set()
    for file in files:
        first = stem(file)
        suffix = file.name[len(first) :]
        number, unique = 1, first
        while unique in stems:
            number += 1
            unique = f"{first}_{number}"
        stems.add(unique)
        names.append(f"{unique}{suffix}")
    return names

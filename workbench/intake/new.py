"""A new study from log files: surveyed, guessed, written whole, and read back before it is kept."""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from workbench import campaign
from workbench.errors import WorkbenchError
from workbench.finding import capital
from workbench.intake.guess import channels, common
from workbench.intake.proposal import Proposal, proposal
from workbench.intake.text import campaign_text, study_text
from workbench.outputs import whole
from workbench.readers import survey

STUDY, FOLDER = "study.toml", "campaign"


@dataclass(frozen=True)
class New:
    """folder: of the study. lines: what was guessed and why. edit: keys of campaign.toml that wait for a number."""

    folder: Path
    lines: tuple[str, ...]
    edit: tuple[str, ...]


def new(place: Path, files: Sequence[Path], told: Mapping[str, str] | None = None) -> New:
    """Write a study with its campaign into `place`, which must not exist, and return what was guessed.

    told: channel ("time", "drive", "position", "reference", "load_position") -> column, where its user knows better.
    Raises WorkbenchError, and writes nothing, where the files cannot make a campaign that loads.
    """
    if place.exists():
        raise WorkbenchError(f"{place} is there already; choose another name, or remove it.")
    surveys = [survey(f) for f in files]
    columns = common(surveys)
    made = proposal(columns, channels(columns, told or {}))
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
    refused = [f"Left out: {why}" for s in surveys for why in s.refused.values()]
    edit = tuple(f"channels.{c.guess.channel}.scale" for c in made.channels if c.scale and c.scale.assumed)
    return New(place, (*_lines(made, copies), *refused), edit)


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
        stem, dot, suffix = file.name.partition(".")
        number, unique = 1, stem
        while unique in stems:
            number += 1
            unique = f"{stem}_{number}"
        stems.add(unique)
        names.append(f"{unique}{dot}{suffix}")
    return names


def _lines(p: Proposal, files: Sequence[str]) -> list[str]:
    said = []
    for c in p.channels:
        g = c.guess
        said.append(f"{g.channel}: column '{g.column}' in '{g.unit}' - {g.why}.")
        if c.scale:
            what = "assumed until you edit it" if c.scale.assumed else "found"
            said.append(f"    scale {c.scale.value:g} {c.scale.unit}, {what}: {c.scale.why}.")
        if c.resolution:
            said.append(f"    encoder step {c.resolution:.6g} {g.unit}: {c.resolution_why}.")
    for e in p.entries:
        window = f" up to {e.until:.6g} s" if e.until else f" from {e.counts_from:.6g} s on" if e.counts_from else ""
        said.append(f"{files[e.survey]}{window}: {e.role} - {e.why}.")
    said.append(f"evaluation bandwidth {p.bandwidth:g} Hz: up to here the position's spectrum stands above its noise.")
    if p.uneven:
        said.append(f"{p.uneven} time steps are more than 1 % off; the records are resampled, and the report says so.")
    return said

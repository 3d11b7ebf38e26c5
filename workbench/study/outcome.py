"""What the steps of a study bring together."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from workbench.definition import Effect
from workbench.description import Equivalent
from workbench.finding import Finding
from workbench.plant import Plant
from workbench.record import Record
from workbench.report.contents import Chapter
from workbench.residual.residual_maps import ResidualMaps
from workbench.tracing.result import Trace


@dataclass(frozen=True, eq=False)
class Outcome:
    """plant: as declared. campaign: its title. bandwidth: of the evaluation filter, Hz. trace: with the fits before and
    after. residual_maps: what its residuals follow. equivalents: described effects. figures: name -> number or word, by which
    requirements are judged; units: name -> unit of a figure ("1" where absent). chapters: further chapters of the report.
    tables: further content of results.json. files: writers of further outputs, called with the study's output folder.
    """

    plant: Plant
    campaign: str
    bandwidth: float
    trace: Trace
    records: tuple[Record, ...] = ()
    equivalents: tuple[tuple[Effect, Equivalent], ...] = ()
    figures: Mapping[str, float | str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    chapters: tuple[Chapter, ...] = ()
    findings: tuple[Finding, ...] = ()
    tables: Mapping[str, object] = field(default_factory=dict)
    files: tuple[Callable[[Path], None], ...] = ()
    residual_maps: tuple[ResidualMaps, ...] = ()


@dataclass(frozen=True, eq=False)
class Part:
    """What one further step of a study adds to its outcome; the fields are those of Outcome."""

    figures: Mapping[str, float | str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    chapters: tuple[Chapter, ...] = ()
    findings: tuple[Finding, ...] = ()
    tables: Mapping[str, object] = field(default_factory=dict)
    files: tuple[Callable[[Path], None], ...] = ()


def with_part(outcome, part: Part):
    """Return an outcome (or a part) with a part added to it."""
    return replace(
        outcome,
        figures={**outcome.figures, **part.figures},
        units={**outcome.units, **part.units},
        chapters=(*outcome.chapters, *part.chapters),
        findings=(*outcome.findings, *part.findings),
        tables={**outcome.tables, **part.tables},
        files=(*outcome.files, *part.files),
    )

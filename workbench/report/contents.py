"""What a report is made of: the result of a study, and the blocks that chapters are written in.

A chapter is data, so a later study adds chapters without touching the template: it appends to `StudyResult.chapters`.
All strings are text, never markup; the one exception is `Equation.math`, which is Typst mathematics of the program's own.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.definition import Effect
from workbench.description.result import Equivalent
from workbench.finding import Finding
from workbench.plant import Plant
from workbench.record import Record
from workbench.report.advice import Advice
from workbench.residual.residual_maps import ResidualMaps
from workbench.tracing.result import Trace
from workbench.verification.closed_loop import ClosedLoop

GOOD, BAD, QUIET, STRONG, CODE, PLAIN = "good", "bad", "quiet", "strong", "code", "plain"


@dataclass(frozen=True)
class Check:
    """One line of a study's requirements. bound: as declared, such as "<= 0.11". value and bound in `unit`; a word has none.
    words: what the figure is called, its name where absent."""

    name: str
    value: float | str
    unit: str
    bound: str
    passed: bool
    words: str = ""

    @property
    def called(self) -> str:
        return self.words or self.name


@dataclass(frozen=True)
class Recorded:
    """One record as the report lists it. rate in Hz, duration in s, drive_rms in N*m or N; file: a name, not a path."""

    name: str
    role: str
    motion: str
    samples: int
    rate: float
    duration: float
    drive_rms: float
    file: str
    sha256: str

    @classmethod
    def of(cls, record: Record) -> "Recorded":
        """Return the line of a record."""
        return cls(
            record.name,
            record.role,
            record.motion,
            record.time.size,
            1.0 / record.dt,
            float(record.time[-1] - record.time[0]),
            float(np.sqrt(np.mean(record.drive**2))),
            record.source.path.name,
            record.source.sha256,
        )


# --- blocks ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Marked:
    """A piece of text with a tone: good, bad, quiet, strong, or code (a name as it is typed)."""

    text: str
    tone: str


Cell = str | Marked


@dataclass(frozen=True)
class Paragraph:
    text: str


@dataclass(frozen=True)
class Heading:
    """A heading within a chapter."""

    text: str


@dataclass(frozen=True)
class Callout:
    """A sentence in a box. tone: plain, good or bad."""

    text: str
    tone: str = PLAIN


@dataclass(frozen=True)
class Items:
    """A list with bullets."""

    texts: tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """alignment: one letter a column: l, c, r, w for text that may wrap, or p for prose, which takes the
    width that is left."""

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    caption: str
    alignment: str

    def __post_init__(self):
        for row in (self.columns, self.alignment, *self.rows):
            if len(row) != len(self.columns):
                raise ValueError(
                    f"Table '{self.caption}': {len(self.columns)} columns, but a row of {len(row)}: {row}."
                )


@dataclass(frozen=True)
class Figure:
    """name: of its file, unique in a report. svg: bytes, or a function that draws them. caption: what it shows, beside
    the finding that the drawing has as its title. alt: for those who do not see it. fixed: whether it stays on paper where it
    stands, instead of floating to where it leaves no gap."""

    name: str
    svg: bytes | Callable[[], bytes]
    caption: str
    alt: str
    fixed: bool = False

    def __post_init__(self):
        if not re.fullmatch(r"[a-z0-9_]+", self.name):
            raise ValueError(
                f"A figure is named '{self.name}'; small letters, digits and underscores make a file's name."
            )


@dataclass(frozen=True)
class Equation:
    """math: Typst mathematics. alt: how it is read aloud."""

    math: str
    alt: str


Block = Paragraph | Heading | Callout | Items | Table | Figure | Equation


@dataclass(frozen=True)
class Chapter:
    title: str
    blocks: tuple[Block, ...]


# --- the result ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class StudyResult:
    """All that one study found, or one trace.

    kind: "Study", or what else the report is of. residual_maps: what the residuals follow; nothing where it was not looked at.

    name: of the study; title: of the report; question: one line, what the study asks. campaign: its title. plant: as
    declared. bandwidth: of the evaluation filter, Hz. equivalent: effects with their description over amplitude.
    closed: the loop, closed with what the trace found, or the sentence why it is not; None where it was not asked for.
    chapters: further chapters, after the standard ones and before the method. tuned: digest of the plant that gains were tuned
    for, where any were. advice: which controller to take, where one was tuned. answer: to the question, beyond the finding.
    command: that makes it again. inputs: digest of all that it depends on.
    """

    name: str
    title: str
    question: str
    campaign: str
    records: tuple[Recorded, ...]
    plant: Plant
    bandwidth: float
    trace: Trace
    equivalent: tuple[tuple[Effect, Equivalent], ...] = ()
    checks: tuple[Check, ...] = ()
    findings: tuple[Finding, ...] = ()
    closed: ClosedLoop | str | None = None
    chapters: Sequence[Chapter] = ()
    residual_maps: tuple[ResidualMaps, ...] = ()
    kind: str = "Study"
    tuned: str = ""
    advice: Advice | None = None
    answer: str = ""
    command: str = ""
    inputs: str = ""

    @property
    def drive(self) -> str:
        """What the drive gives: "torque" or "force"."""
        return "torque" if self.plant.rotary else "force"

"""The chapters of a report in their order: the finding first, then what it rests on, then how it was computed."""

from collections.abc import Iterable
from dataclasses import replace

from workbench.finding import Finding
from workbench.report.cause import cause
from workbench.report.closed_loop import closing
from workbench.report.contents import Block, Callout, Chapter, Items, Paragraph, StudyResult
from workbench.report.description import description
from workbench.report.method import method, provenance
from workbench.report.model import declared, extended
from workbench.report.opening import CAUTIONS, finding, records
from workbench.report.recommend import RECOMMENDED
from workbench.report.required import required
from workbench.report.residual import residual
from workbench.report.residual_maps import where_it_lives
from workbench.report.wording import finding_items, typeset

OF_GAINS = ("gains", "schedule")  # subjects of findings that belong to the chapters of the study


def _of_study(result: StudyResult) -> tuple[Chapter, ...]:
    """Return the chapters of the study itself."""
    return result.chapters


# What a report may hold, in its order: a new chapter is a function of the result and its place here. One that has nothing to say is None.
ORDER = (
    finding, records, declared, residual, where_it_lives, cause, extended, description, closing, _of_study, required, method, provenance,
)  # fmt: skip


def standard(result: StudyResult) -> tuple[Chapter, ...]:
    """Return all chapters that have something to say. No sentence of a list or a paragraph is there twice."""
    made = [make(result) for make in ORDER]
    chapters = [c for one in made for c in (one if isinstance(one, tuple) else (one,)) if c is not None]
    return _once(_with_findings(chapters, result))


def texts(chapters: Iterable[Chapter]) -> list[str]:
    """Return every sentence group of the chapters: paragraphs, boxes and items of lists."""
    found = []
    for chapter in chapters:
        for block in chapter.blocks:
            found += [block.text] if isinstance(block, (Paragraph, Callout)) else list(getattr(block, "texts", ()))
    return found


def _with_findings(chapters: list[Chapter], result: StudyResult) -> list[Chapter]:
    """Add the findings that no chapter says: those of gains to the study's first chapter, the others to the records."""
    known = " ".join(texts(chapters))
    elsewhere = (*result.trace.findings, *result.trace.before.findings, *result.trace.after.findings)
    left = [
        f
        for f in result.findings
        if f not in elsewhere and f.kind not in (RECOMMENDED, *CAUTIONS) and f.sentence not in known
    ]
    of_gains = [f for f in left if f.subject in OF_GAINS] if result.chapters else []
    first = next((i for i, c in enumerate(chapters) if result.chapters and c is result.chapters[0]), 1)
    for at, chosen in ((1, [f for f in left if f not in of_gains]), (first, of_gains)):
        chapters[at] = _added(chapters[at], chosen)
    return chapters


def _added(chapter: Chapter, findings: list[Finding]) -> Chapter:
    return replace(chapter, blocks=(*chapter.blocks, *finding_items(findings)))


def _once(chapters: Iterable[Chapter]) -> tuple[Chapter, ...]:
    """Return the chapters with every text where it stands first, and nowhere else; its units as they are printed."""
    seen: set[str] = set()

    def fresh(text: str) -> bool:
        known = text in seen
        seen.add(text)
        return not known

    def kept(block: Block) -> Block | None:
        if isinstance(block, Items):
            left = tuple(t for t in map(typeset, block.texts) if fresh(t))
            return Items(left) if left else None
        if isinstance(block, (Paragraph, Callout)):
            block = replace(block, text=typeset(block.text))
            return block if fresh(block.text) else None
        return block

    return tuple(replace(c, blocks=tuple(b for b in map(kept, c.blocks) if b is not None)) for c in chapters)

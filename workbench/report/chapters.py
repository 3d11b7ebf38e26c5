"""The chapters of a report in their order: the finding first, then what it rests on, then how it was computed."""

from workbench.report.cause import cause
from workbench.report.contents import Chapter, Heading, StudyResult
from workbench.report.description import description
from workbench.report.method import method, provenance
from workbench.report.model import declared, extended
from workbench.report.opening import finding, records
from workbench.report.residual import residual
from workbench.report.unknown import lives, shade
from workbench.report.where import where

__all__ = [
    "cause",
    "declared",
    "description",
    "extended",
    "finding",
    "method",
    "provenance",
    "records",
    "residual",
    "standard",
    "where",
]


def standard(result: StudyResult) -> tuple[Chapter, ...]:
    """Return all chapters; those of the study itself stand between the description and the method."""
    chapters = [finding(result), records(result), declared(result), residual(result)]
    unknown = (Heading("Where it lives"), lives(result)) if result.trace.unknown else ()
    if result.where:
        chapters.append(where(result.where, unknown, shade(result)))
    elif unknown:
        chapters.append(Chapter("Where the residual lives", unknown))
    chapters.append(cause(result))
    if result.trace.causes:
        chapters.append(extended(result))
    if result.equivalent:
        chapters.append(description(result))
    return (*chapters, *result.chapters, method(result), provenance(result))

"""The report of a study: HTML and PDF from one Typst source, with its figures."""

from workbench.report.contents import StudyResult
from workbench.report.writing import drawn, write

__all__ = ["StudyResult", "drawn", "write"]

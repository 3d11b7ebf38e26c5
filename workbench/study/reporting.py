"""From a study's outcome to what its report is made of, and to its line in the list of reports."""

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

from workbench.report.advice import advice_of, worth_in_short
from workbench.report.advice import headline as advised
from workbench.report.contents import Check, Recorded, StudyResult
from workbench.report.index import write_index
from workbench.study import stamp
from workbench.study.configuration import Study
from workbench.study.outcome import Outcome
from workbench.study.results import answer


def report_of(
    study: Study, outcome: Outcome, judged: Sequence[Check], folder: Path, read: Iterable[Path]
) -> StudyResult:
    """Return what the report of a study is made of. folder: that its gains were written into. read: files outside its own folder."""
    return StudyResult(
        name=study.name,
        title=study.title,
        question=study.question,
        campaign=outcome.campaign,
        records=tuple(Recorded.of(r) for r in outcome.records),
        plant=outcome.plant,
        bandwidth=outcome.bandwidth,
        trace=outcome.trace,
        equivalent=outcome.equivalents,
        checks=tuple(judged),
        findings=outcome.findings,
        chapters=outcome.chapters,
        residual_maps=outcome.residual_maps,
        tuned=outcome.tables.get("tuned_plant", {}).get("digest", ""),
        advice=advice_of(outcome.tables, _recommended_files(folder), outcome.plant.displacement),
        answer=answer(study, outcome) or worth_in_short(outcome.tables, outcome.plant.displacement),
        command=f"workbench run studies/{study.name}",
        inputs=stamp.sources(study.folder, read).hexdigest(),
    )


def headline(report: StudyResult) -> str:
    """Return which controller to take, or "" where none was tuned."""
    return advised(report.advice) if report.advice else ""


def _recommended_files(folder: Path) -> list[str]:
    """Return the files of the recommended controller below a study's outputs; none where no gains were written."""
    path = folder / "gains" / "contents.json"
    if not path.is_file():
        return []
    content = json.loads(path.read_text(encoding="utf-8"))
    return [f"gains/{f}" for c in content["controllers"] if c["recommended"] for f in c["files"]]


def list_again(study: Study, place: Path) -> None:
    """Write the list of reports anew where the outputs lie in it, and nowhere else."""
    if place == study.folder.parent.parent / "reports" / study.name:
        write_index(place.parent)

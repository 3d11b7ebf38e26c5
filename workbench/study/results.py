"""results.json: every number of a study, and the checks it was judged by."""

import json
from math import isfinite
from pathlib import Path

from workbench import __version__
from workbench.errors import WorkbenchError, nearest
from workbench.report.contents import Check
from workbench.study.configuration import Study
from workbench.study.outcome import Outcome
from workbench.tracing.output import estimate

FORMAT = 1


def checks(study: Study, outcome: Outcome) -> tuple[Check, ...]:
    """Judge every requirement; WorkbenchError for a figure that the study does not have (nearest names)."""
    found = []
    for r in study.requirements:
        if r.name not in outcome.figures:
            raise WorkbenchError(
                f"{study.table.path('requirements')}: this study has no figure '{r.name}'; {nearest(r.name, outcome.figures)}"
            )
        unit = outcome.units.get(r.name, "1")
        if r.equals is None and r.unit != unit:
            raise WorkbenchError(
                f"{study.table.path('requirements')}.{r.name}: the bound is in '{r.unit}', the figure in '{unit}'; use the latter."
            )
        value = outcome.figures[r.name]
        found.append(Check(r.name.replace("_", " "), value, unit, r.bound, r.passed(value)))
    return tuple(found)


def plain(value):
    """A value as JSON can hold it: NaN and infinity become None, arrays lists."""
    if isinstance(value, float):
        return value if isfinite(value) else None
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    return value


def model(fit) -> dict:
    """A fit as results.json holds it."""
    return {
        "digest": fit.plant.digest,
        "parameters": [
            {"effect": e.effect, "at": e.at, "parameter": e.parameter, **estimate(e)} for e in fit.estimates
        ],
        "nrmse": {"identification": fit.identification, "validation": fit.validation, "records": dict(fit.nrmse)},
        "rms": dict(fit.rms),
        "by_record": {name: list(ends) for name, ends in fit.spread.items()},
    }


def write(study: Study, outcome: Outcome, judged: tuple[Check, ...], folder: Path) -> None:
    """Write results.json into a folder."""
    content = {
        "format": FORMAT,
        "workbench": __version__,
        "study": study.name,
        "title": study.title,
        "verdict": outcome.trace.verdict,
        "sentence": outcome.trace.sentence,
        "checks": [
            {"name": c.name, "value": c.value, "unit": c.unit, "bound": c.bound, "passed": c.passed} for c in judged
        ],
        "figures": {n: {"value": v, "unit": outcome.units.get(n, "1")} for n, v in outcome.figures.items()},
        "model_before": model(outcome.trace.before),
        "model_after": model(outcome.trace.after),
        "equivalents": [
            {"effect": e.name, "at": e.at, "amplitude": q.amplitude, "stiffness": q.stiffness, "loss": q.loss}
            for e, q in outcome.equivalents
        ],
        "findings": [
            {
                "kind": f.kind,
                "subject": f.subject,
                "sentence": f.sentence,
                "evidence": dict(f.evidence),
                "remedy": f.remedy,
            }
            for f in outcome.findings
        ],
        **outcome.tables,
    }
    text = json.dumps(plain(content), indent=1, allow_nan=False, ensure_ascii=False)
    (folder / "results.json").write_text(text + "\n", encoding="utf-8")

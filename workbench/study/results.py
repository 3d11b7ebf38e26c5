"""results.json: every number of a study, and the checks it was judged by."""

import json
import re
from math import isfinite
from pathlib import Path

from workbench import __version__
from workbench.errors import WorkbenchError, nearest
from workbench.report import numbers
from workbench.report.contents import Check
from workbench.report.required import in_words
from workbench.study.configuration import Study
from workbench.study.outcome import Outcome
from workbench.tracing.output import estimate

FORMAT = 1
PREFIXED = ("s", "rad", "m", "N", "N*m")  # units that a prefix goes well with


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
        found.append(
            Check(r.name.replace("_", " "), value, unit, r.bound, r.passed(value), in_words(r.name, study.words))
        )
    return tuple(found)


def answer(study: Study, outcome: Outcome) -> str:
    """Return the study's answer to its question, with the figures that it names; WorkbenchError for one that there is not."""

    def shown(match) -> str:
        name = match[1]
        if name not in outcome.figures:
            raise WorkbenchError(
                f"{study.table.path('answer')}: this study has no figure '{name}'; {nearest(name, outcome.figures)}"
            )
        value = outcome.figures[name]
        unit = outcome.units.get(name, "1")
        if isinstance(value, str):
            return value.replace("_", " ")
        if match[2]:
            return numbers.percent(value)
        return (
            numbers.exact(value, 3)
            if unit == "1"
            else numbers.scaled(value, unit)
            if unit in PREFIXED
            else numbers.quantity(value, unit)
        )

    return re.sub(r"\{(\w+)(:%)?\}", shown, study.answer)


def _plain(value):
    """A value as JSON can hold it: NaN and infinity become None, arrays lists."""
    if isinstance(value, float):
        return value if isfinite(value) else None
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
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


def write(study: Study, outcome: Outcome, judged: tuple[Check, ...], folder: Path, advice: str = "") -> None:
    """Write results.json into a folder. advice: which controller to take, or ""."""
    content = {
        "format": FORMAT,
        "workbench": __version__,
        "study": study.name,
        "title": study.title,
        "verdict": outcome.trace.verdict,
        "sentence": outcome.trace.sentence,
        "answer": answer(study, outcome),
        "advice": advice,
        "checks": [
            {"name": c.name, "value": c.value, "unit": c.unit, "bound": c.bound, "passed": c.passed, "words": c.called}
            for c in judged
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
    text = json.dumps(_plain(content), indent=1, allow_nan=False, ensure_ascii=False)
    (folder / "results.json").write_text(text + "\n", encoding="utf-8")

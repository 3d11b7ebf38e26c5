"""trace.json and the predictions beside it."""

import json
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path

import numpy as np

from workbench.identification.result import Estimate, Fit
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.residual.residual_maps import ResidualMaps, as_list, load_as_dict
from workbench.tracing import calibration
from workbench.tracing.result import CandidateScore, Cause, Refinement, Trace

FORMAT = 1


def _number(value: float) -> float | None:
    """A float that JSON can hold; None for NaN and infinity."""
    return float(value) if isfinite(value) else None


def _plain(data):
    """Return nested plain data in which what is not finite is None."""
    if isinstance(data, dict):
        return {k: _plain(v) for k, v in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(v) for v in data]
    return _number(data) if isinstance(data, float) else data


def estimate(e: Estimate) -> dict:
    return {
        "value": _number(e.value),
        "unit": e.unit,
        "interval_95": [_number(e.low), _number(e.high)],
        "fixed": e.fixed,
        "meaning": e.meaning,
    }


def _cause(c: Cause) -> dict:
    return {
        "effect": c.effect,
        "at": c.at,
        "kind": c.kind,
        "law": c.law,
        **({"form": c.form} if c.form else {}),
        "sentence": c.sentence,
        "parameters": {e.parameter: estimate(e) | _was(c, e) for e in c.parameters},
        "size": _number(c.size),
        "share": {IDENTIFICATION: _number(c.share_identification), VALIDATION: _number(c.share_validation)},
        "rivals": list(c.rivals),
        "experiment": c.experiment,
    }


def _refinement(r: Refinement) -> dict:
    return {
        "effect": r.effect,
        "at": r.at,
        "kind": r.kind,
        "sentence": r.sentence,
        "size": _number(r.size),
        "parameters": {e.parameter: estimate(e) | _was(r, e) for e in r.parameters},
    }


def _candidate(c: CandidateScore) -> dict:
    return {
        "effect": c.effect,
        "at": c.at,
        "kind": c.kind,
        "gain": _number(c.gain),
        "standard_error": _number(c.scatter),
        "nrmse_held_out": _number(c.held_out),
        "nrmse": _number(c.nrmse),
        "earns_its_place": c.earns,
    }


def _errors(trace: Trace, role: str) -> dict:
    """Return the errors on the records of a role before and after, and what noise alone would leave of them."""
    before, after = (getattr(fit, role) for fit in (trace.before, trace.after))
    return {"before": _number(before), "after": _number(after), "floor": _number(trace.floor[role])}


def _was(c: Cause | Refinement, e: Estimate) -> dict:
    """Return the value that a corrected parameter was declared with."""
    return {"was": _number(c.was[e.parameter])} if e.parameter in c.was else {}


def _by_name(fit: Fit) -> list[Estimate]:
    """Return the estimates by effect and place, whatever the order in which the effects were declared."""
    return sorted(fit.estimates, key=lambda e: (e.effect, e.at))


def as_dict(trace: Trace, predictions: dict[str, str]) -> dict:
    """Return the content of trace.json. predictions: record stem -> path of its CSV relative to trace.json."""
    return {
        "format": FORMAT,
        "verdict": trace.verdict,
        "sentence": trace.sentence,
        "ranked": list(dict.fromkeys(c.effect.partition(" ")[0] for c in trace.ranked)),
        "added": list(trace.added),
        "causes": [_cause(c) for c in trace.causes],
        "refinements": [_refinement(r) for r in trace.refinements],
        "evidence": _plain(trace.evidence.as_dict()) if trace.evidence else {},
        "criteria": trace.criteria.as_dict,
        "nrmse": {role: _errors(trace, role) for role in (IDENTIFICATION, VALIDATION)},
        "candidates": [[_candidate(c) for c in step] for step in trace.steps],
        "model": [
            {"effect": e.effect, "at": e.at, "parameter": e.parameter, **estimate(e)} for e in _by_name(trace.after)
        ],
        "findings": [
            {"kind": f.kind, "subject": f.subject, "sentence": f.sentence, "remedy": f.remedy}
            for f in (*trace.findings, *trace.after.findings)
        ],
        "unknown": trace.located,
        "smallest_shown": [
            {"effect": s.effect, "at": s.at, "parameter": s.parameter, "value": _number(s.value), "unit": s.unit}
            | {"of": "a change of the declared value" if s.change else "the effect"}
            for s in trace.smallest
        ],
        "predictions": predictions,
    }


def write(
    trace: Trace, folder: Path, maps: Sequence[ResidualMaps] = (), further: Mapping[str, object] | None = None
) -> None:
    """Write trace.json and predictions/<record>.csv into an existing folder.

    maps: of the residual. further: keys of trace.json behind the trace's own; None where it stands beside a study's results, which
    hold the errors of the load and the calibrations.
    """
    more = {"where": as_list(maps)} if maps else {}
    if further is not None:
        phases = [calibration.as_dict(c) for c in trace.calibrations]
        more = {"nrmse_load": load_as_dict(maps), **more, "calibrations": phases, **further}
    paths = {}
    (folder / "predictions").mkdir()
    for name, prediction in sorted(trace.after.predictions.items()):
        paths[name] = f"predictions/{name}.csv"
        rows = np.column_stack([trace.after.series[name].time, prediction])
        lines = "%.9g,%.9g\n" * len(rows) % tuple(rows.ravel().tolist())  # in a third of savetxt's time
        (folder / paths[name]).write_text(f"time_s,prediction\n{lines}", encoding="utf-8")
    text = json.dumps(as_dict(trace, paths) | more, indent=1, allow_nan=False)
    (folder / "trace.json").write_text(text + "\n", encoding="utf-8")

"""Data-sheet values that would fit otherwise, but by too little to be wrong: they stay as declared, and the page says so."""

from dataclasses import replace

from workbench.finding import capital, place, title
from workbench.identification.by_record import held
from workbench.identification.result import Estimate, Fit
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.candidates import CORRECTION
from workbench.tracing.criteria import Criteria
from workbench.tracing.decide import NOTHING, REFINEMENT, Verdict
from workbench.tracing.evidence import Evidence, Weighed
from workbench.tracing.preparing import Declared
from workbench.tracing.result import Refinement
from workbench.tracing.selection import Selection
from workbench.tracing.weighing import Confirmed, confirm


def near_values(confirmed: Confirmed, verdict: Verdict, declared: Plant) -> dict[str, Refinement]:
    """Return key of the effect -> what is said of a value that a decision takes for a refinement, where validation is no worse with it."""
    every = zip(confirmed.added, confirmed.weighed, verdict.roles, strict=True)
    return {
        j.candidate.key: _said(w, declared, j.candidate.key, confirmed.fits[-1])
        for j, w, role in every
        if j.candidate.kind == CORRECTION and role == REFINEMENT and not w.after[VALIDATION] > w.before[VALIDATION]
    }


def put_back(
    late: Declared, selected: Selection, confirmed: Confirmed, evidence: Evidence, verdict: Verdict, criteria: Criteria
) -> tuple[Confirmed, Evidence, Verdict]:
    """Return what whole records bear out where nothing is missing, with its evidence and roles, beside fixed values as they were declared: what
    stays is a refinement as before. With a cause the others are weighed anew instead."""
    roles = dict(zip((j.candidate.key for j in confirmed.added), verdict.roles, strict=True))
    kept = [j for j in confirmed.added if j.candidate.kind != CORRECTION]
    if verdict.verdict != NOTHING or len(kept) == len(confirmed.added):
        return confirmed, evidence, verdict
    again = confirm(late, kept, selected, criteria, confirmed.levels)
    stay = tuple(roles[j.candidate.key] for j in again.added)
    return again, replace(evidence, added=again.weighed), replace(verdict, roles=stay)


def _said(w: Weighed, declared: Plant, key: str, fit: Fit) -> Refinement:
    """Return a value as a refinement. fit: in which it is free, beside all that was added."""
    was = held(declared[key])
    found = tuple(e for e in fit.estimates if f"{e.effect}@{e.at}" == key and e.parameter in was)
    values = " and ".join(_beside(e, was[e.parameter].value) for e in found)
    known = f"the {100 * w.tolerance:g} % that such a value is known to"
    within = w.changed <= w.tolerance
    why = f"that lies within {known}" if within else f"what lies beyond {known} takes too little for a cause"
    return Refinement(
        w.effect,
        w.at,
        CORRECTION,
        f"{capital(title(w.effect))} at the {place(w.at)} would fit as {values}, and leave {100 * fit.identification:.2f} % of the "
        f"drive on the identification records; {why}, and it stays as declared.",
        found,
        min(w.size(IDENTIFICATION), w.beside_others),
        {n: p.value for n, p in was.items()},
    )


def _beside(e: Estimate, was: float) -> str:
    """Return a value with its interval, beside what was declared."""
    unit = f" {e.unit}" if e.unit else ""
    return f"{e.value:.4g}{unit} (95 %: {e.low:.4g} to {e.high:.4g}) in the place of {was:.4g}"

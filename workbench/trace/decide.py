"""The decision: evidence in, verdict out. No record, no model and no search is seen here.

| question, in this order | answer |
|---|---|
| does the angle between two encoders say that one is late? | cause, whatever else |
| a correction within the fixed value's tolerance, or an effect below the practical size? | refinement |
| does the error grow on validation, or does the effect explain nearly nothing there? | not borne out |
| does a free form of the declared laws take what it takes? | refinement: the declared law is nearly right |
| do the causes take `held` of the validation power, or leave little that is explainable? | cause |
| is more than `explainable` of the drive predictable from outside the loop? | unknown |
| else | nothing missing |
"""

from dataclasses import dataclass

from workbench.record import IDENTIFICATION, VALIDATION
from workbench.trace.criteria import Criteria
from workbench.trace.evidence import CORRECTION, Evidence, Weighed

CAUSE, NOTHING, UNKNOWN = "cause", "nothing_missing", "unknown"
REFINEMENT, NOT_BORNE_OUT, DRESSING = "refinement", "not borne out", "dressing"


@dataclass(frozen=True)
class Verdict:
    """verdict: "cause", "nothing_missing" or "unknown". roles: of each effect of the evidence, in its order: "cause",
    "refinement", "not borne out" or "dressing" (it only dresses what no effect explains). something_else: whether more is
    missing beside the causes. alarms: names of what an engineer must look at first."""

    verdict: str
    roles: tuple[str, ...]
    something_else: bool = False
    alarms: tuple[str, ...] = ()


def decide(evidence: Evidence, criteria: Criteria) -> Verdict:
    """Return the verdict on this evidence."""
    roles = tuple(role(a, criteria) for a in evidence.added)
    causes = [a for a, r in zip(evidence.added, roles, strict=True) if r == CAUSE]
    if causes and (evidence.place_instead or not answers(evidence, causes, criteria)):
        roles = tuple(DRESSING if r == CAUSE else r for r in roles)
        causes = []
    if causes or evidence.clock:
        size = evidence.after.size
        more = size >= criteria.beside and size >= 0.5 * evidence.before.size and not evidence.idle
        return Verdict(CAUSE, roles, more, alarms(evidence, roles))
    missing = evidence.before.size >= criteria.explainable
    return Verdict(UNKNOWN if missing else NOTHING, roles, False, alarms(evidence, roles))


def role(a: Weighed, criteria: Criteria) -> str:
    """Return what one effect is by itself."""
    if a.kind == CORRECTION and a.changed <= a.tolerance:
        return REFINEMENT
    if a.size(VALIDATION) < 0.0 or a.share(VALIDATION) < criteria.carried * a.share(IDENTIFICATION):
        return NOT_BORNE_OUT
    if a.size(IDENTIFICATION) < criteria.practical or a.near_law:
        return REFINEMENT
    return CAUSE


def answers(evidence: Evidence, causes: list[Weighed], criteria: Criteria) -> bool:
    """Whether the causes are the answer: they hold on validation, or leave little of what could be explained."""
    declared = evidence.declared[VALIDATION] ** 2
    taken = sum(max(a.before[VALIDATION] ** 2 - a.after[VALIDATION] ** 2, 0.0) for a in causes)
    if declared > 0.0 and taken >= criteria.held * declared:
        return True
    before, after = evidence.before.size**2, evidence.after.size**2
    return before >= criteria.explainable**2 and after <= criteria.left * before


def alarms(evidence: Evidence, roles: tuple[str, ...]) -> tuple[str, ...]:
    """Return "below floor" where the extended model's error is less than noise alone would leave."""
    kept = [a for a, r in zip(evidence.added, roles, strict=True) if r in (CAUSE, REFINEMENT)]
    if not kept:
        return ()
    below = [r for r in (IDENTIFICATION, VALIDATION) if kept[-1].after[r] < 0.9 * evidence.floor[r]]
    return ("below floor",) if below else ()

"""Whether causes answer for what a declared model leaves: by what they take of the records, and by what stays to be explained."""

from math import isfinite, sqrt

from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import Evidence, Weighed


def answers(evidence: Evidence, causes: list[Weighed], criteria: Criteria) -> bool:
    """Whether the causes are the answer: they take `held` of both roles, or leave little of what could be explained.

    Of 205 right answers none takes less than 0.71 of identification; a friction over place took 0.26 of what a drive's constant leaves that
    goes with the electrical angle, and 0.53 of validation. Where nothing could be explained validation alone decides of what it chose: what shows in the last
    second of a record takes little of identification. A declared friction that is only nearly right took 0.61 and 0.67 of validation, and 0.39 and
    0.48 of identification, of two complete models. Beside much that nothing explains (a bench whose records are noisy, or that lacks more than one thing) it is enough that they take `held` of
    identification and of what could be explained; and that one of them takes `held` of the load's balance, in which it shows, unless the drive keeps
    `unaccounted`: an amplifier's dead time left 12 % there beside a load's inertia that took all of its balance. What only an injected torque shows (a delay, a lag) is in no reference, and moves excite it
    little: then it is enough that the
    causes take as much of the identification records, by blocks that were not seen, or a level that wanders in bench time, and that nothing
    explainable stays. Else a model that leaves more than `unaccounted` in every role has none,
    nor one that leaves more beyond noise than its causes take, and something explainable of it: of three right causes that took less than half in
    either role none left anything there; of grease that is squeezed out at rest a Stribeck peak left 6.8 % of the drive where it took 5.3 and 6.2.
    """
    judge = VALIDATION if isfinite(evidence.declared[VALIDATION]) else IDENTIFICATION
    held, much = (_share_of(causes, evidence, r) >= criteria.held for r in (judge, IDENTIFICATION))
    explainable = evidence.before.size >= criteria.explainable
    if held and (much or (not explainable and any(a.chosen for a in causes))):
        return True
    left = evidence.left_by(causes[-1])
    if left < criteria.unaccounted and any(a.behind and a.share(judge) >= criteria.held for a in causes):
        return True
    if explainable and much and little_left(evidence, criteria, 1.0 - criteria.held):
        return True
    more = left > _most_taken(causes) and evidence.after.size >= criteria.explainable
    if left >= criteria.unaccounted or more:
        return False
    if explainable:
        return little_left(evidence, criteria, criteria.left)
    return (much or _level_gone(evidence, criteria)) and evidence.after.size < criteria.explainable


def _most_taken(causes: list[Weighed]) -> float:
    """Return what causes take away together over the drive's rms, in the role in which that is most."""
    taken = (sum(max(a.before[r] ** 2 - a.after[r] ** 2, 0.0) for a in causes) for r in (IDENTIFICATION, VALIDATION))
    return sqrt(max(t for t in taken if isfinite(t)))


def _level_gone(evidence: Evidence, criteria: Criteria) -> bool:
    """Whether what was added leaves little of a level that wanders in bench time: by itself that may be low-frequency noise, but a law of few
    numbers takes none of that from blocks that it has not seen."""
    level = evidence.before.level
    return level >= criteria.explainable and evidence.after.level**2 <= criteria.left * level**2


def _share_of(causes: list[Weighed], evidence: Evidence, role: str) -> float:
    """Return the share of the declared model's residual power that causes take away together."""
    taken = sum(max(a.before[role] ** 2 - a.after[role] ** 2, 0.0) for a in causes)
    declared = evidence.declared[role] ** 2
    return taken / declared if declared > 0.0 else 0.0


def little_left(evidence: Evidence, criteria: Criteria, left: float) -> bool:
    """Whether what was added leaves little of what could be explained, of every kind that is worth it: a cause leaves no line as it was.
    left: share of its power that is little."""
    kinds = zip(evidence.before.sizes, evidence.after.sizes, strict=True)
    gone = all(min(b, a) < criteria.explainable or a**2 <= left * b**2 for b, a in kinds)
    return gone and evidence.after.size**2 <= left * evidence.before.size**2

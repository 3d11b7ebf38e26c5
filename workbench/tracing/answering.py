"""Whether causes answer for what a declared model leaves: by what they take of the records, and by what stays to be explained."""

from collections.abc import Sequence
from math import isfinite

from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import Evidence, Weighed


def answers(evidence: Evidence, causes: Sequence[Weighed], refined: Sequence[Weighed], criteria: Criteria) -> bool:
    """Whether causes are the answer, of what refinements of the declared laws leave: they take `held` of its power in both roles, or leave
    little of what could be explained.

    What only dresses something else leaves much of it: beside `beside` of the drive that stays (also in an inertia that changes along the stroke,
    or a gain that does in bench time) causes must have taken `near` of both roles. Of 895 campaigns and axes 25 dressings that left so much had taken 0.74 of
    one of the roles at most, five 0.86 and more (four are told by a place, or by what changes along the stroke), and BRFD's gap 0.96.

    Where nothing could be explained validation alone decides of what it chose: what shows in the last second of a record takes little of identification.
    What takes `held` of identification and of nothing that could be explained is an answer (a delay that only an injected torque shows, which
    moves excite little), and what leaves less than `explainable` of that which could, and at most half, and what takes `held` of the load's balance in which it shows; of a
    model that keeps less than `unaccounted` beyond noise.
    """
    judge = VALIDATION if isfinite(evidence.declared[VALIDATION]) else IDENTIFICATION
    taken = {role: _share_of(causes, refined, evidence, role) for role in (judge, IDENTIFICATION)}
    if much_stays(evidence, criteria) and min(taken.values()) < criteria.near:
        return False
    explainable = evidence.before.size >= criteria.explainable
    much = taken[IDENTIFICATION] >= criteria.held
    if taken[judge] >= criteria.held and (much or (not explainable and any(a.chosen for a in causes))):
        return True
    if evidence.left_by(causes[-1]) >= criteria.unaccounted:
        return False
    if any(a.behind and a.share(judge) >= criteria.held for a in causes):
        return True
    left = evidence.after.size
    gone = left < criteria.explainable and left**2 <= (1.0 - criteria.held) * evidence.before.size**2
    return gone if explainable else much


def much_stays(evidence: Evidence, criteria: Criteria) -> bool:
    """Whether `beside` of the drive stays to be explained beside causes. A right law that is only near leaves less: EMPS' friction 1.4 %, of which three
    effects took 0.75 of both roles; a large cogging beside a friction that turns over a little speed, declared as dry, 1.5 %."""
    return evidence.after.most >= criteria.beside


def _share_of(causes: Sequence[Weighed], refined: Sequence[Weighed], evidence: Evidence, role: str) -> float:
    """Return the share that causes take away together of the residual's power that refinements of the declared model leave."""
    declared = evidence.declared[role] ** 2 - _taken(refined, role)
    return _taken(causes, role) / declared if declared > 0.0 else 0.0


def _taken(added: Sequence[Weighed], role: str) -> float:
    return sum(max(a.before[role] ** 2 - a.after[role] ** 2, 0.0) for a in added)

"""The decision: evidence in, verdict out. No record, no model and no search is seen here.

| question, in this order | answer |
|---|---|
| does the angle between two encoders say that one is late? | cause, whatever else |
| do the counts that an encoder lost take more of the drive than any cause, and at least `explainable`? | unknown |
| does the error grow on validation, or does the effect explain nearly nothing there, or a further wave only with a phase found there? | not borne out |
| does what is outside the loop bear out less than `held` of what it takes, for certain by `alike` standard errors? | not borne out |
| an effect below the practical size, or a correction beyond its tolerance; or below `explainable` with values that no machine has; or below `beside` of the joint's torque where the drive does not show it? | refinement |
| a memory of the friction that is declared, or a speed over which that turns, which takes less than `beside` of the drive? | refinement |
| the same memory beside another cause, below `unaccounted` of the drive? | refinement |
| a further one that takes less than `lesser` of what the largest cause takes of the same balance, and less than `unaccounted`? | refinement |
| a further one that takes `held` of what the larger ones leave in neither role, of which less than `explainable` is foretold? | refinement |
| does one place of the records say more than the causes do, or do they pay for a window of the stroke with residual elsewhere? | unknown |
| does a stiffness of the joint or an inertia that changes along the stroke, which no effect is, take `explainable` more of the drive than they do? | unknown |
| do the causes take `held` of the residual's power in both roles (of validation alone where nothing is explainable and that chose them), and `near` of it where `beside` stays explainable with them? | cause |
| or, of a model that keeps less than `unaccounted` beyond noise, `held` of a load's balance, or of identification where nothing was explainable, or leave less than `explainable` of what was, and at most half? | cause |
| is more than `explainable` of the drive predictable from outside the loop (beside what declared laws are nearly right in, and beside causes that are no answer)? | unknown |
| does an inertia that changes along the stroke, or a drive's gain that does in bench time, take `held` of what the declared model leaves, and `explainable` of the drive? | unknown |
| does more than `whole` of the drive stay beyond what noise may leave, in every role? | unknown |
| is the declared model's drive farther from that of validation than none at all would be? | unknown |
| else | nothing missing |
"""

from dataclasses import dataclass

from workbench.record import IDENTIFICATION, VALIDATION
from workbench.residual.noise_floor import TOLD
from workbench.tracing.answering import answers
from workbench.tracing.criteria import Criteria
from workbench.tracing.dressing import changes, largest, less_than_places
from workbench.tracing.evidence import CORRECTION, Evidence, Weighed

CAUSE, NOTHING, UNKNOWN = "cause", "nothing_missing", "unknown"
REFINEMENT, NOT_BORNE_OUT, DRESSING = "refinement", "not borne out", "dressing"
MEMORIES = ("presliding_hysteresis", "fading_memory")  # that are all of what a law makes of friction that gives way


@dataclass(frozen=True)
class Verdict:
    """verdict: "cause", "nothing_missing" or "unknown". roles: of each effect of the evidence, in its order: "cause",
    "refinement", "not borne out" or "dressing" (it only dresses what no effect explains). something_else: whether more is
    missing beside the causes. alarms: names of what an engineer must look at first. added: names of the causes, the one that takes most first."""

    verdict: str
    roles: tuple[str, ...]
    something_else: bool = False
    alarms: tuple[str, ...] = ()
    added: tuple[str, ...] = ()

    @property
    def ranked(self) -> tuple[str, ...]:
        """The causes, best first: the one that takes most of the identification records leads."""
        return self.added


def decide(evidence: Evidence, criteria: Criteria) -> Verdict:
    """Return the verdict on this evidence."""
    own = tuple(_role(a, criteria) for a in evidence.added)
    first = largest([a for a, r in zip(evidence.added, own, strict=True) if r == CAUSE], criteria)
    own = tuple(NOT_BORNE_OUT if a.power_up and a is not first else r for a, r in zip(evidence.added, own, strict=True))
    roles = _lesser(evidence, own, criteria)
    if any(r == CAUSE and not a.of_declared for a, r in zip(evidence.added, roles, strict=True)):
        roles = _lesser(evidence, _but_near_laws(evidence, own, criteria), criteria)
    causes = [a for a, r in zip(evidence.added, roles, strict=True) if r == CAUSE]
    refined = [a for a, r in zip(evidence.added, roles, strict=True) if r == REFINEMENT]
    spread = evidence.traded or evidence.place_instead or less_than_places(evidence, causes, criteria)
    dressed = bool(causes) and (spread or not answers(evidence, causes, refined, criteria))
    if dressed:
        roles = tuple(DRESSING if r == CAUSE else r for r in roles)
        causes = []
    if _lost_most(evidence, causes, criteria):
        roles = tuple(DRESSING if r == CAUSE else r for r in roles)
        return Verdict(UNKNOWN, roles, False, _alarms(evidence, roles))
    if causes or evidence.clock:
        size = evidence.after.size
        more = size >= criteria.beside and size >= 0.5 * evidence.before.size and not evidence.idle
        ordered = sorted(causes, key=lambda a: a.order(criteria.practical), reverse=True)
        names = (*(("clock_skew",) if evidence.clock else ()), *(a.effect.partition(" ")[0] for a in ordered))
        return Verdict(CAUSE, roles, more, _alarms(evidence, roles), tuple(dict.fromkeys(names)))
    # what a declared law is only nearly right in is no part of what is missing
    near = all(r == REFINEMENT and a.of_declared for a, r in zip(evidence.added, roles, strict=True))
    left = evidence.after if roles and near and not evidence.refused else evidence.before
    size = max(left.size, evidence.after.most) if dressed else left.size
    missing = size >= criteria.explainable or changes(evidence, criteria)
    missing = missing or evidence.unaccounted >= criteria.whole or evidence.astray
    return Verdict(UNKNOWN if missing else NOTHING, roles, False, _alarms(evidence, roles))


def _but_near_laws(evidence: Evidence, roles: tuple[str, ...], criteria: Criteria) -> tuple[str, ...]:
    """Return the roles beside another cause: there a memory of the declared friction is that law's, which is only nearly right, up to `unaccounted`
    of the drive. Every contact gives way; of who declares it dry few have left that out."""
    near = (
        a.effect in MEMORIES and a.of_declared and a.in_drive(IDENTIFICATION) < criteria.unaccounted
        for a in evidence.added
    )
    return tuple(REFINEMENT if r == CAUSE and n else r for r, n in zip(roles, near, strict=True))


def _lost_most(evidence: Evidence, causes: list[Weighed], criteria: Criteria) -> bool:
    """Whether the counts that an encoder lost, and that were put back, take more than any cause beside them; a late encoder is a cause whatever else."""
    largest = max((a.size(IDENTIFICATION) for a in causes), default=0.0)
    return evidence.lost >= max(criteria.explainable, largest) and not evidence.clock


def _role(a: Weighed, criteria: Criteria) -> str:
    """Return what one effect is by itself."""
    # without a validation record both are NaN, and say nothing
    if a.size(VALIDATION) < 0.0 or a.share(VALIDATION) < criteria.carried * a.share(IDENTIFICATION):
        return NOT_BORNE_OUT
    if a.came_back(criteria.held, criteria.alike, criteria.near):
        return NOT_BORNE_OUT
    if a.of_declared and a.in_drive(IDENTIFICATION) < criteria.beside:
        return REFINEMENT
    if _beyond(a) < _least(a, criteria):
        return REFINEMENT
    return CAUSE


def _least(a: Weighed, criteria: Criteria) -> float:
    """Return what an effect takes at least, over the rms of the drive or of the joint's torque, to be a cause. What the load's balance alone shows
    is `beside`: every bearing rubs, and of four dry frictions of a load that its maker did not count three take 1.3 to 1.9 % of the joint's torque,
    and 0.2 % of the drive at most; of 21 right causes that show behind the joint the drive shows 1.1 % and more."""
    if a.behind and a.in_drive(IDENTIFICATION) < criteria.practical:
        return criteria.beside
    return criteria.explainable if a.implausible else criteria.practical


def _lesser(evidence: Evidence, roles: tuple[str, ...], criteria: Criteria) -> tuple[str, ...]:
    """Return the roles with those for refinements that only make up for the law of the largest cause, or that would be no cause if the
    larger ones had been declared."""
    small = _small(evidence.added, roles, criteria)
    weak = (a.foretold < criteria.explainable for a in evidence.added)
    return tuple(REFINEMENT if r == CAUSE and (s or w) else r for r, s, w in zip(roles, small, weak, strict=True))


def in_question(added: tuple[Weighed, ...], criteria: Criteria) -> list[int]:
    """Return the places, among additions, of further causes that take `held` of what the larger ones leave in neither role: of these it is to
    be asked what is foretold of that. Of the drive alone."""
    roles = tuple(_role(a, criteria) for a in added)
    small = _small(added, roles, criteria)
    first = largest([a for a, r in zip(added, roles, strict=True) if r == CAUSE], criteria)
    held = _held(added, roles, criteria)
    further = (r == CAUSE and not s and a is not first for a, r, s in zip(added, roles, small, strict=True))
    weak = (f and not h and not a.behind for a, f, h in zip(added, further, held, strict=True))
    return [i for i, w in enumerate(weak) if w]


def _held(added: tuple[Weighed, ...], roles: tuple[str, ...], criteria: Criteria) -> list[bool]:
    """Whether each effect takes `held` of what the larger ones leave, in the balance in which it shows most, in either role: those that came
    before it, and larger causes that came after it. Without a validation record NaN says nothing."""

    def larger(i: int) -> list[Weighed]:
        least = added[i].order(criteria.practical)
        return [
            a
            for a, r in zip(added[i + 1 :], roles[i + 1 :], strict=True)
            if r == CAUSE and a.order(criteria.practical) > least
        ]

    return [
        any(a.share(role, larger(i)) >= criteria.held for role in (IDENTIFICATION, VALIDATION))
        for i, a in enumerate(added)
    ]


def _small(added: tuple[Weighed, ...], roles: tuple[str, ...], criteria: Criteria) -> tuple[bool, ...]:
    """Whether each effect is small beside the largest cause: it takes less than `lesser` of what that one takes of the balance in which the
    effect shows (of a joint's torque, which a load's balance is held against, the same law is a larger share than of the drive). What takes
    `unaccounted` is not small."""
    first = largest([a for a, r in zip(added, roles, strict=True) if r == CAUSE], criteria)
    most = (criteria.lesser * first.size_where(a, IDENTIFICATION) if first else 0.0 for a in added)
    return tuple(a.size(IDENTIFICATION) < min(m, criteria.unaccounted) for a, m in zip(added, most, strict=True))


def _beyond(a: Weighed) -> float:
    """Return what an effect takes away, over the drive's rms; of a correction, what no value within its tolerance takes beside all others and beside a drive
    whose gain is known no better than that value: of a wheel's drive that saturates a mass 2.6 % off took 7.1 % of the drive before the saturation was
    there, and 1.1 beside it."""
    if a.kind != CORRECTION:
        return a.size(IDENTIFICATION)
    if a.changed <= a.tolerance:
        return 0.0
    size = a.size(IDENTIFICATION) if a.behind else min(a.size(IDENTIFICATION), a.beside_others)
    return size * (1.0 - 2.0 * a.tolerance / a.changed)


def _alarms(evidence: Evidence, roles: tuple[str, ...]) -> tuple[str, ...]:
    """Return "below floor" where the extended model's error is less than noise alone would leave."""
    kept = [a for a, r in zip(evidence.added, roles, strict=True) if r in (CAUSE, REFINEMENT)]
    if not kept:
        return ()
    below = [r for r in (IDENTIFICATION, VALIDATION) if kept[-1].after[r] < TOLD * evidence.floor[r]]
    return ("below floor",) if below else ()

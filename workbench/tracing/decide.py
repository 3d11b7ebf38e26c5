"""The decision: evidence in, verdict out. No record, no model and no search is seen here.

| question, in this order | answer |
|---|---|
| does the angle between two encoders say that one is late? | cause, whatever else |
| do the counts that an encoder lost take more of the drive than any cause, and at least `explainable`? | unknown |
| a correction within the fixed value's tolerance, or an effect (a correction beyond its tolerance) below the practical size, or below `explainable` with values that no machine has, or below `beside` of the joint's torque where the drive does not show it? | refinement |
| a memory of the friction that is declared, or a speed over which that turns, of which the drive shows less than the practical size on validation or while the load moves, or less than `explainable` behind the joint, or (of asperities or bristles alone) less than `beside`? | refinement |
| the same beside another cause, that takes less than `unaccounted` of the drive, or gives way within some counts and takes less than `beside` while its body moves? | refinement |
| a further one (beside an encoder that is late any is) that takes less than `lesser` of what the largest cause takes of the same balance (a further order of that one is its own) and less than `unaccounted` of the drive (unless it takes `held` of validation, and of what that one does there), on validation less than the practical size, less than `beside` with values that no machine has or of the drive as a memory of the friction that is declared, or says the curve that a larger one says? | refinement |
| a further one that takes `held` of what the larger ones leave in neither role, of which less than `explainable` is foretold, or which the load's balance alone shows? | refinement |
| does the error grow on validation, or does the effect explain nearly nothing there, or a further wave only with a phase found there? | not borne out |
| does what is outside the loop bear out less than `held` of what it takes, for certain by `alike` standard errors? | not borne out |
| is what they take of a window of the stroke paid for with residual elsewhere? | unknown |
| does a stiffness of the joint or an inertia that changes along the stroke, which no effect is, take `explainable` more of the drive than they do? | unknown |
| has what takes most values that no machine has, or no formula, and leaves `beside` explainable? or is it a friction that drifts, and leaves `explainable` that bench time foretells? | unknown |
| does an inertia, or a drive's constant, that changes along the stroke take `held` of what they leave, and `beside` of the drive? or does a drive's gain that changes in bench time, of which they are the mean (data-sheet values or drifts, or what takes half of it), take more than `left` of it? | unknown |
| do the causes take `held` of the power in both roles (of validation alone where nothing is explainable and that chose them), or one of the balance behind a joint in which it shows, beside a drive that keeps less than `unaccounted`, or of the identification power and of what is explainable, or leave little of that (and none of it where they leave more beyond noise than they take)? | cause |
| is more than `explainable` of the drive predictable from outside the loop (where nothing was added but what declared laws are nearly right in, of what that leaves)? | unknown |
| does an inertia that changes along the stroke, or a drive's gain that does in bench time, take `held` of what the declared model leaves, and `explainable` of the drive? | unknown |
| does more than `whole` of the drive stay beyond what noise may leave, in every role? | unknown |
| is the declared model's drive farther from that of validation than none at all would be? | unknown |
| else | nothing missing |
"""

from dataclasses import dataclass
from math import inf

from workbench.record import IDENTIFICATION, VALIDATION
from workbench.residual.noise_floor import TOLD
from workbench.tracing.answering import answers, little_left
from workbench.tracing.criteria import Criteria
from workbench.tracing.dressing import changes, doubtful, largest, of_a_change
from workbench.tracing.evidence import CORRECTION, Evidence, Weighed

CAUSE, NOTHING, UNKNOWN = "cause", "nothing_missing", "unknown"
REFINEMENT, NOT_BORNE_OUT, DRESSING = "refinement", "not borne out", "dressing"
# Counts of an encoder, within which friction that gives way is what every contact does: five that their authors did not count are 4 to 18 long, four
# that were missing beside another cause 50 and more. Halved, the longest of the five is a cause; doubled, none changes
FEW = 30.0
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
    spread = evidence.traded or (evidence.place_instead and not little_left(evidence, criteria, criteria.left))
    dressed = bool(causes) and of_a_change(evidence, causes, criteria)
    if causes and (
        spread or dressed or doubtful(evidence, causes, criteria) or not answers(evidence, causes, criteria)
    ):
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
    # what only dresses a change along the stroke or in bench time was borne out: something is there, though the reference may foretell none of it
    # what a declared law is only nearly right in is no part of what is missing
    near = all(r == REFINEMENT and a.of_declared for a, r in zip(evidence.added, roles, strict=True))
    left = evidence.after if roles and near and not evidence.refused else evidence.before
    missing = left.size >= criteria.explainable or dressed or changes(evidence, criteria)
    missing = missing or evidence.unaccounted >= criteria.whole or evidence.astray
    return Verdict(UNKNOWN if missing else NOTHING, roles, False, _alarms(evidence, roles))


def _but_near_laws(evidence: Evidence, roles: tuple[str, ...], criteria: Criteria) -> tuple[str, ...]:
    """Return the roles beside another cause: there a memory of the declared friction is that law's, which is only nearly right, up to `unaccounted`
    of the drive; and of FEW counts however much it is of a drive that waits between moves, where it takes less than `beside` while its body moves. Every contact
    gives way; of who declares it dry few have left that out."""
    near = (
        a.effect in MEMORIES
        and a.of_declared
        and (a.in_drive(IDENTIFICATION) < criteria.unaccounted or (a.length < FEW and a.in_motion < criteria.beside))
        for a in evidence.added
    )
    return tuple(REFINEMENT if r == CAUSE and n else r for r, n in zip(roles, near, strict=True))


def _lost_most(evidence: Evidence, causes: list[Weighed], criteria: Criteria) -> bool:
    """Whether the counts that an encoder lost, and that were put back, take more than any cause beside them; a late encoder is a cause whatever else."""
    largest = max((a.size(IDENTIFICATION) for a in causes), default=0.0)
    return evidence.lost >= max(criteria.explainable, largest) and not evidence.clock


def _role(a: Weighed, criteria: Criteria) -> str:
    """Return what one effect is by itself."""
    if a.kind == CORRECTION and a.changed <= a.tolerance:
        return REFINEMENT
    # without a validation record both are NaN, and say nothing
    out = a.size(VALIDATION) < 0.0 or a.share(VALIDATION) < criteria.carried * a.share(IDENTIFICATION)
    # what a load does at standstill may be most of its balance there: the drive may bear out what shows a little more behind the joint
    if out and not (a.behind and a.of_drive(VALIDATION) >= criteria.held):
        return NOT_BORNE_OUT
    if a.came_back(criteria.held, criteria.alike, criteria.near):
        return NOT_BORNE_OUT
    # a declared friction is only nearly right at standstill: a load's small balance shows it, or slow records that nothing else has
    little = a.behind and a.in_drive(IDENTIFICATION) < criteria.explainable
    moved = a.in_motion if a.at == "load" else inf
    if a.of_declared and (little or min(a.in_drive(VALIDATION), moved) < criteria.practical):
        return REFINEMENT
    if a.of_declared and a.effect in MEMORIES and a.in_drive(IDENTIFICATION) < criteria.beside:
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
    larger ones had been declared. Beside an encoder that is late any is a further one."""
    added = evidence.added
    hidden = (evidence.clock and a.size(VALIDATION) < criteria.practical for a in added)
    small = [s or h for s, h in zip(_small(added, roles, criteria), hidden, strict=True)]
    weak = (a.foretold < criteria.explainable for a in added)
    return tuple(REFINEMENT if r == CAUSE and (s or w) else r for r, s, w in zip(roles, small, weak, strict=True))


def in_question(added: tuple[Weighed, ...], criteria: Criteria) -> list[int]:
    """Return the places, among additions, of further causes that take `held` of what the larger ones leave in neither role: of these it is to
    be asked what is foretold of that. Of the drive alone, and of no further order of the largest."""
    roles = tuple(_role(a, criteria) for a in added)
    small = _small(added, roles, criteria)
    first = largest([a for a, r in zip(added, roles, strict=True) if r == CAUSE], criteria)
    held = _held(added, roles, criteria)
    further = (r == CAUSE and not s and a is not first for a, r, s in zip(added, roles, small, strict=True))
    weak = (
        f and not h and not a.behind and not _further_of(a, first) for a, f, h in zip(added, further, held, strict=True)
    )
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
    """Whether each effect is small beside the largest cause: by what it takes, or because it says the curve of a larger one."""
    causes = [a for a, r in zip(added, roles, strict=True) if r == CAUSE]
    first = largest(causes, criteria)
    most = first.size(IDENTIFICATION) if first else 0.0
    return tuple(
        a.same_curve
        or (first is not None and _little_of(a, first, criteria))
        or (a.size(IDENTIFICATION) < most and a.size(VALIDATION) < criteria.practical)
        or (a.implausible and a.size(IDENTIFICATION) < min(most, criteria.beside))
        or (a.of_declared and a is not first and a.in_drive(IDENTIFICATION) < criteria.beside)
        # what is foretold of the drive says nothing of a load's balance: there right ones took 0.5 and more of it, what nobody put there 0.43 at most
        or (a.behind and a is not first and not held and not _further_of(a, first))
        for a, held in zip(added, _held(added, roles, criteria), strict=True)
    )


def _little_of(a: Weighed, first: Weighed, criteria: Criteria) -> bool:
    """Whether an effect takes less than `lesser` of what the largest cause takes of the balance in which that effect shows: of a joint's torque,
    which a load's balance is held against, the same law is a larger share than of the drive. Not what takes `unaccounted` of the drive, nor what
    takes `held` of the validation record, and of what the largest takes there: that one may be excited little (a cogging at line speed)."""
    least = min(criteria.lesser * first.size_where(a, IDENTIFICATION), inf if a.behind else criteria.unaccounted)
    carried = a.share(VALIDATION) >= criteria.held and a.size(VALIDATION) >= criteria.held * first.size_where(
        a, VALIDATION
    )
    return a.size(IDENTIFICATION) < least and not carried and not _further_of(a, first)


def _further_of(a: Weighed, first: Weighed | None) -> bool:
    """Whether an effect is a further order, or part, of another one: it has its name and its place."""
    return first is not None and (a.effect.partition(" ")[0], a.at) == (first.effect.partition(" ")[0], first.at)


def _beyond(a: Weighed) -> float:
    """Return what an effect takes away, over the drive's rms; of a correction, what no value within its tolerance takes beside all others and beside a drive
    whose gain is known no better than that value: of a wheel's drive that saturates a mass 2.6 % off took 7.1 % of the drive before the saturation was
    there, and 1.1 beside it."""
    size = min(a.size(IDENTIFICATION), inf if a.behind else a.beside_others)
    return size * (1.0 - 2.0 * a.tolerance / a.changed) if a.kind == CORRECTION and a.changed > 0.0 else size


def _alarms(evidence: Evidence, roles: tuple[str, ...]) -> tuple[str, ...]:
    """Return "below floor" where the extended model's error is less than noise alone would leave."""
    kept = [a for a, r in zip(evidence.added, roles, strict=True) if r in (CAUSE, REFINEMENT)]
    if not kept:
        return ()
    below = [r for r in (IDENTIFICATION, VALIDATION) if kept[-1].after[r] < TOLD * evidence.floor[r]]
    return ("below floor",) if below else ()

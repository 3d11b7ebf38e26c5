"""One composite in the place of its parts: LuGre friction is presliding, Stribeck's peak and a damping of the bristles in one law.

The search finds the parts one after another, each in its own shape. Begun where they came out, the composite may say the same as both;
then it is the simpler answer, and its name the cause's. So is a disc's second wave the disc's, whichever of its waves was found first.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import pi, remainder

from workbench.definition import Effect, catalogue
from workbench.identification.solve import NoValue
from workbench.plant import Plant
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import ADDITION, AGAIN, Candidate, Offer, without
from workbench.tracing.criteria import Criteria
from workbench.tracing.discs import MEETS, count_of, on_the_shaft
from workbench.tracing.judge import ScoredCandidate, freedom, scored_as
from workbench.tracing.near_law import Law, as_declared, gives_way
from workbench.tracing.spellings import CABLE, SPRING
from workbench.tracing.state import Refitted, State

WEIGHT = "gravity"  # that a preload may hide in, though it is none
# rad, of a weight's phase up to which a travel that does not tell a weight from a spring is a spring's. Of 38 weights that others left out none hangs
# at less than 0.35 rad where the encoder reads zero; a pendulum that does (0.009 and 0.025 rad, measured) swings so far that it is told. Halved or
# doubled, of these none changes
HANGS = 0.05
# rad, from where a data sheet says that a weight hangs, within which it is right about that. Of six weights that others held wrong five are right to
# 0.003 rad; what turned by 0.07 was an arm's spring that nobody had declared. Halved or doubled, of these none changes
TURNED = 0.02


def composed(answer: Answer, declared: Plant, criteria: Criteria, offer: Offer) -> Answer:
    """Return the answer with a composite of the catalogue in the place of all of its parts, where it leaves no more than what is of
    practical size beside them; the answer itself where none does. declared: what the search began with, beside whose dry friction what gives way is
    asked by itself."""
    for composite in catalogue().values():
        for parts in _whole(composite, answer):
            if any(gives_way(j.candidate, declared) for j in parts):
                continue  # what the declared law is only nearly right in is no part of what is missing
            one = _in_place(composite, parts, answer, declared, criteria, offer)
            if one is not None:
                first = next(i for i, j in enumerate(answer.added) if j in parts)
                rest = [j for j in answer.added if j not in parts]
                return replace(answer, added=[*rest[:first], one, *rest[first:]], pruned=one.state)
    return answer


def decomposed(answer: Answer, declared: Plant, criteria: Criteria, laws: Sequence[Law]) -> Answer:
    """Return the answer with a composite that stands for declared dry friction under the name of the part of it that is missing: that part takes `near`
    of what the composite takes beside the free virgin curve, and without a memory it leaves less than `unaccounted` of the drive more. Every contact
    gives way, and what the declared law is only nearly right in is no part of what is missing (`composed`). laws: the declared laws that free curves may stand for."""
    return replace(answer, added=[_by_part(j, answer, declared, criteria, laws) for j in answer.added])


def _by_part(
    j: ScoredCandidate, answer: Answer, declared: Plant, criteria: Criteria, laws: Sequence[Law]
) -> ScoredCandidate:
    """Return an addition under the name of its missing part, itself where it is none of what `decomposed` asks."""
    last, composite = answer.last, answer.last.plant[j.candidate.key]
    own = [catalogue()[n] for n in composite.parts if "dir" not in catalogue()[n].provides]
    called = j.candidate.part or j.candidate.stands or j.candidate.kind != ADDITION
    if called or len(own) != 1 or not j.candidate.instead or not gives_way(j.candidate, declared):
        return j
    rest = without(last.plant, j.candidate, declared)
    known = {n: p.value for n, p in composite.parameters.items() if n in own[0].parameters and n not in own[0].linear}
    part = own[0](at=j.candidate.at, **known)
    try:
        bare, alone = State(rest, last.inverses), State(rest + part, last.inverses)
        dry = State(as_declared(rest, laws) + part, last.inverses)
    except NoValue:
        return j
    most = bare.errors.total - last.errors.total
    memory = dry.errors.total - last.errors.total
    named = bare.errors.total - alone.errors.total >= criteria.near * most
    if not named or memory >= criteria.unaccounted**2 * last.power:
        return j
    return replace(j, candidate=replace(j.candidate, part=own[0].name))


def of_one_disc(answer: Answer) -> Answer:
    """Return the answer with the waves of a reading that stand to an eccentricity of its disc as 2 or 3 to 1 under that one's name: a magnet
    off its axis, or two windings, err twice a turn, too. Alone such a wave may be a gear's; one that repeats with the motor's shaft, of an axis
    with one encoder, is named the disc's (`discs.on_the_shaft`)."""
    plant, count = answer.last.plant, count_of(answer.last.inverses)
    discs = [(e.at, e.name, e.parameters[e.harmonic].value) for e in plant.effects if e.harmonic]
    shafts = [(e, n) for e in plant.effects if (n := on_the_shaft(e, plant, count))]
    discs += [(e.at, n, e.parameters["order"].value) for e, n in shafts]

    def named(j: ScoredCandidate) -> ScoredCandidate:
        wave = plant[j.candidate.key]
        if j.candidate.kind != ADDITION or "order" not in wave.parameters:
            return j
        order = wave.parameters["order"].value
        own = (n for at, n, turns in discs if _reads(at, wave.at) and _harmonic(order, turns))
        name = on_the_shaft(wave, plant, count) or next(own, "")
        as_called = {"stands": name} if j.candidate.stands else {"part": name}
        return replace(j, candidate=replace(j.candidate, **as_called)) if name else j

    return replace(answer, added=[named(j) for j in answer.added])


def of_the_axis(answer: Answer, declared: Plant, criteria: Criteria) -> Answer:
    """Return the answer with a spring that is relaxed at the encoder's zero in the place of a cable whose preload is not certain: a
    cable or a hose is at rest wherever it happens to be. A constant force that is free at its place is all of a preload: what is missing beside it is
    the stiffness alone, as of a counterweight's gas spring, and no record tells where it rests. Where a weight is known there, or a joint between encoders of
    separate zeros carries the preload, it is a cable. A weight that hangs where the encoder reads zero, on a travel that does not bend its sine, is such a
    spring, too; and so is what a data sheet's weight leaves where both of its numbers would be wrong, and a spring says as much with one.
    declared: what the search began with."""
    plant, zeroed = answer.last.plant, any(p.motion.record.zero is not None for p in answer.last.inverses)
    for i, j in enumerate(answer.added):
        pull = plant[j.candidate.key]
        beside = {e.name for e in plant.effects if e.at == pull.at and e is not pull}
        added = j.candidate.kind == ADDITION
        relaxed = (pull.name == CABLE or _hangs(pull)) and not j.candidate.stands
        if (
            not (relaxed if added else _turned(pull, declared))
            or beside & {SPRING, WEIGHT}
            or (zeroed and j.candidate.at == "load")
        ):
            continue
        rest = without(plant, j.candidate, declared)
        spring = catalogue()[SPRING](at=j.candidate.at, stiffness=abs(pull.parameters[pull.linear[0]].value))
        candidate = Candidate(SPRING, spring.at, ADDITION, rest + spring)
        try:
            before, after = State(rest, answer.last.inverses), State(candidate.plant, answer.last.inverses)
        except NoValue:
            continue
        told = scored_as(after, j.candidate, answer.last, criteria)[0]
        alike = after.errors.total <= answer.last.errors.total + criteria.practical**2 * answer.last.power
        # a rest that is certain is one, however little it takes: a rig's, of a seventh of the travel, takes 4.5 +- 0.9 % of what the spring leaves
        if told.gain <= criteria.certain * told.scatter if added else alike:
            one = _found(candidate, before, after, criteria)
            answer = replace(answer, added=[*answer.added[:i], one, *answer.added[i + 1 :]], pruned=after)
            plant = after.plant
    return answer


def _hangs(pull: Effect) -> bool:
    """Whether a force is a weight that hangs where the encoder reads zero."""
    return pull.name == WEIGHT and abs(_at_zero(pull)) < HANGS and pull.outside["mgl"].value > 0.0


def _turned(pull: Effect, declared: Plant) -> bool:
    """Whether a force is a weight of which a data sheet would be wrong in where it hangs, too."""
    if pull.name != WEIGHT or "phase" in pull.parameters:  # of which one of the two is free
        return False
    return abs(remainder(_at_zero(pull) - _at_zero(declared[pull.key]), 2.0 * pi)) > TURNED


def _at_zero(weight: Effect) -> float:
    """Return the angle, rad, at which a weight stands where the encoder reads zero: 0 where it hangs."""
    return weight.outside["phase"].value


def _reads(disc: str, wave: str) -> bool:
    """Whether a disc's reading errs by a wave at a place: at its own, or of the angle of the joint between two encoders."""
    return wave in (disc, "joint")


def _harmonic(order: float, of: float) -> bool:
    """Whether an order is the second or third harmonic of another one."""
    return any(abs(order - n * of) < MEETS * order for n in map(int, AGAIN))


def _whole(composite: Effect, answer: Answer) -> list[list[ScoredCandidate]]:
    """Return, place by place, the additions that are together all parts of a composite."""
    if not composite.traced or len(composite.parts) < 2:
        return []
    found = []
    for place in sorted({j.candidate.at for j in answer.added}):
        here = [j for j in answer.added if (j.candidate.kind, j.candidate.at) == (ADDITION, place)]
        parts = [j for j in here if j.candidate.effect in composite.parts]
        if {j.candidate.effect for j in parts} == set(composite.parts):
            found.append(parts)
    return found


def _in_place(
    composite: Effect,
    parts: list[ScoredCandidate],
    answer: Answer,
    declared: Plant,
    criteria: Criteria,
    offer: Offer,
) -> ScoredCandidate | None:
    """Return the composite fitted in the place of its parts, begun at their values, beside what is declared there; None where it leaves
    plainly more."""
    last, place = answer.last, parts[0].candidate.at
    rest = last.plant
    for j in parts:
        rest = without(rest, j.candidate, declared)
    asked = replace(offer, only={composite.name}).candidates(rest)
    same = [c for c in asked if (c.effect, c.at) == (composite.name, place)]
    # in the place of a declared law rather than beside it
    candidate = max(same, key=lambda c: len(c.instead), default=None)
    if candidate is None:
        return None
    known = {n: p.value for j in parts for n, p in last.plant[j.candidate.key].parameters.items()}
    begun = candidate.plant[candidate.key]
    begun = begun(**{n: known[n] for n, p in begun.parameters.items() if n in known and n not in begun.linear})
    candidate = replace(candidate, plant=candidate.plant.swap(begun))
    try:
        before, after = State(rest, last.inverses), State(candidate.plant, last.inverses)
    except NoValue:
        return None
    if after.errors.total > last.errors.total + criteria.practical**2 * last.power:
        return None
    found = _found(candidate, before, after, criteria)
    return found if found.score.earns else None


def _found(candidate: Candidate, before: State, after: State, criteria: Criteria) -> ScoredCandidate:
    """Return the judgement of a candidate that ended in the state `after`, beside what the state `before` has."""
    fit = Refitted(after.problem, after.solution.theta, after.solution.c)
    score, errors = scored_as(before, candidate, after, criteria)
    return ScoredCandidate(
        candidate, score, errors, freedom(candidate.plant), after.solution.theta, refitted=fit, state=after
    )

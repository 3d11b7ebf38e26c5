"""The search: what it adds beside declared laws that may be only nearly right, and what later additions made needless."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from workbench.identification.solve import NoValue
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import Offer, without
from workbench.tracing.composing import composed, decomposed, of_one_disc, of_the_axis
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import CORRECTION
from workbench.tracing.greedy import Step, extended
from workbench.tracing.judge import Progress, ScoredCandidate
from workbench.tracing.near_law import SEEN, Law, as_declared, count_at, freed, laws, lengthened
from workbench.tracing.pruning import pruned
from workbench.tracing.ranking import absurd, step
from workbench.tracing.starting import at_own_starts
from workbench.tracing.state import State

# What a free virgin curve may be: the memory of a catalogued law or, as it is a spring far short of its slips, what a stiffness lacks
OF_A_CURVE = {"presliding_hysteresis", "fading_memory", "linear_stiffness"}


@dataclass(frozen=True, eq=False)
class Selection:
    """declared: the model as declared, solved; base: with free virgin curves where these take what is of practical size.

    steps: of the search; looked: every step's judgements, those of the revision too; provisional: keys of what was added
    before it was certain. laws: declared frictions that a curve stood for; refined: those whose curve stays, as a refinement.
    """

    declared: State
    base: State
    answer: Answer
    steps: Sequence[Step]
    looked: Sequence[Sequence[ScoredCandidate]]
    laws: tuple[Law, ...]
    refined: tuple[Law, ...] = ()

    @property
    def found(self) -> Plant:
        """The plant that the search ended with, its free virgin curves put back to the declared laws."""
        return as_declared(self.answer.last.plant, self.laws)

    def less(self, *gone: ScoredCandidate) -> State | None:
        """Return the state that the search ended with, without some additions; None where it has no value."""
        last, plant = self.answer.last, self.answer.last.plant
        for j in gone:
            plant = without(plant, j.candidate, self.base.plant)
        try:
            return State(plant, last.inverses)
        except NoValue:
            return None

    @property
    def dry(self) -> Plant:
        """The same, with declared friction in the place of what has a memory and was added in its stead: where an axis sticks, that dresses rest."""
        plant = self.answer.last.plant
        for j in self.answer.added:
            if j.candidate.instead and "dir" in plant[j.candidate.key].provides:
                plant = without(plant, j.candidate, self.base.plant)
        return as_declared(plant, self.laws)

    @property
    def provisional(self) -> set[str]:
        return {s.added.candidate.key for s in self.steps if s.provisional}


def select(
    declared: State,
    whole: Sequence[InverseDynamics],
    offer: Offer,
    criteria: Criteria,
    progress: Progress,
    rests: Callable[[Plant], bool] = lambda _: False,
) -> Selection:
    """Return what the search adds to a declared model. whole: inverse dynamics of the identification records as they are.

    rests: whether rest is most of what is left beside what was found: it is asked with every effect, with which the search then ends, as it
    is to be made once more where the axis moves.
    """
    known = tuple(law for law in laws(declared.plant, declared.inverses) if law.declared.key not in offer.stands_for)
    base = curved(declared, known, criteria)
    longer = lengthened(known, base.plant, declared.inverses)
    if longer != known:
        known, base = longer, curved(declared, longer, criteria)
    base = at_own_starts(base)  # as every candidate beside it, or the start would be what a candidate takes

    def freshly(state: State) -> State:
        """Return a state with the free curves that take what is of practical size beside what was added, found anew."""
        held = {e.key for e in state.plant.effects}
        here = tuple(law for law in known if {law.key, law.declared.key} & held)
        state = curved(state, here, criteria) if here else state
        return at_own_starts(state)

    offer = replace(offer, stands_for={**offer.stands_for, **{law.key: law.declared for law in known}})

    def selected(added: Sequence[ScoredCandidate], steps: Sequence[Step] = ()) -> Selection:
        return Selection(declared, base, Answer(added, base), steps, [s.judgements for s in steps], known)

    steps = extended(base, whole, progress, offer, criteria, freshly, lambda added: rests(selected(added).dry))
    looked = [s.judgements for s in steps]
    answer = Answer([s.added for s in steps if s.added is not None], base).standing
    if answer.added and rests((so_far := selected(answer.added, steps)).dry):
        return so_far
    if len(answer.added) > 1:
        answer = pruned(answer, base.plant, looked, progress, offer, criteria)
    answer, refined = _of_declared_laws(answer, known, looked, progress, offer, criteria)
    answer = decomposed(composed(answer, base.plant, criteria, offer), base.plant, criteria, known)
    answer = of_the_axis(of_one_disc(answer), base.plant, criteria)
    return Selection(declared, base, answer, steps, looked, known, refined)


def curved(state: State, known: Sequence[Law], criteria: Criteria) -> State:
    """Return a state with the free virgin curves of `known`, found anew where that is better, or with the declared laws where the
    curves take less than half of what is of practical size."""
    held = {e.key for e in state.plant.effects}
    stands = any(law.key in held for law in known)
    plain = State(as_declared(state.plant, known), state.inverses) if stands else state
    found = [s for s in (state if stands else None, _with_curves(state, known)) if s is not None]
    best = min(found, key=lambda s: s.errors.total, default=plain)
    return best if best is not plain and size(plain, best) >= 0.5 * criteria.practical else plain


def _with_curves(state: State, known: Sequence[Law]) -> State | None:
    """Return a state with the free virgin curves of `known`, or None where none is found."""
    plant = freed(state.plant, known, state.inverses)
    if not any(law.key in {e.key for e in plant.effects} for law in known):
        return None
    try:
        return State(plant, state.inverses)
    except NoValue:
        return None


def size(before: State, after: State) -> float:
    """Return what a state takes away of another's held-out residual, over the drive's rms."""
    return (max(before.errors.total - after.errors.total, 0.0) / before.power) ** 0.5 if before.power > 0.0 else 0.0


def _of_declared_laws(
    answer: Answer,
    known: Sequence[Law],
    looked: list[Sequence[ScoredCandidate]],
    progress: Progress,
    offer: Offer,
    criteria: Criteria,
) -> tuple[Answer, tuple[Law, ...]]:
    """Say what the free virgin curves are: nothing, a law of the catalogue other than the declared one, or a refinement.

    A curve that takes less than what is of practical size gives way to the declared law. Where a law of the catalogue takes
    nearly what the curve takes, over a length that the encoder sees, that law is missing. Else the declared law is nearly right.
    """
    refined = []
    for law in known:
        last = answer.last
        if law.key not in {e.key for e in last.plant.effects}:
            continue
        plain = State(as_declared(last.plant, [law]), last.inverses)
        if size(plain, last) < criteria.practical:
            answer = replace(answer, pruned=plain)
            continue
        progress(f"asking what the virgin curve at the {law.declared.at} is")
        own = {k: e for k, e in offer.stands_for.items() if k == e.key}
        offered = replace(offer, only=OF_A_CURVE, stands_for=own)
        judgements = step(plain, progress, offered, criteria)
        looked.append(judgements)
        much = criteria.held * plain.errors.total  # beside the declared law: less may be friction smooth in speed
        here = [j for j in judgements if j.candidate.at == law.declared.at and j.refitted and not absurd(j, plain)]
        formulas = [j for j in here if j.candidate.instead or _taken(plain, j) >= much]
        best = _commonest(formulas, criteria.practical**2 * last.power)
        near = best is not None and _taken(plain, best) >= criteria.near * (plain.errors.total - last.errors.total)
        if near and _length(best) > SEEN * count_at(law.declared.at, last.inverses):
            best = best if best.state else replace(best, state=best.refitted.state)
            first = _taken(plain, best) > sum(j.score.gain for j in answer.added[:1]) * answer.declared.errors.total
            added = [best, *answer.added] if first else [*answer.added, best]
            answer = Answer(added, answer.declared, best.state)
        else:
            refined.append(law)
    return answer, tuple(refined)


def _commonest(formulas: Sequence[ScoredCandidate], alike: float) -> ScoredCandidate | None:
    """Return the formula that leaves least or, of those that leave no more than `alike` beside that one, a data sheet's value, which is no
    law more, then one with Masing's memory: asperities remember every reversal, and bristles that forget are the rarer picture."""
    best = min(formulas, key=lambda j: (j.errors.total, j.candidate.key), default=None)
    level = [j for j in formulas if j.errors.total - best.errors.total <= alike]
    value = next((j for j in level if j.candidate.kind == CORRECTION), None)
    return value or next((j for j in level if "masing" in j.candidate.plant[j.candidate.key].holds), best)


def _taken(before: State, j: ScoredCandidate) -> float:
    """Return the held-out power that a judged candidate takes away."""
    return before.errors.total - j.errors.total


def _length(j: ScoredCandidate) -> float:
    """Return the presliding length of a fitted friction with memory, SI: x0, or 1/alpha."""
    values = {n: p.value for n, p in j.refitted.plant[j.candidate.key].parameters.items()}
    return values["x0"] if "x0" in values else 1.0 / max(values.get("alpha", 0.0), 1e-300)

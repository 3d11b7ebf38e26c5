"""The trace: select effects, prune them, confirm them on whole records, weigh the evidence, decide, describe."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from workbench.definition import CHANNELS, Effect, catalogue
from workbench.errors import WorkbenchError
from workbench.identification.intervals import block_seconds, seconds
from workbench.identification.result import Fit
from workbench.identification.solve import NoValue
from workbench.inverse.dynamics import InverseDynamics
from workbench.keeping import kept
from workbench.plant import Plant
from workbench.processes import shared
from workbench.residual.noise_floor import floor as noise_floor
from workbench.threads import one_thread
from workbench.tracing.budget import BUDGET, Budget
from workbench.tracing.by_validation import by_validation
from workbench.tracing.candidates import Offer
from workbench.tracing.choice import Choice
from workbench.tracing.criteria import Criteria
from workbench.tracing.data_sheet import within_tolerance
from workbench.tracing.decide import CAUSE, NOT_BORNE_OUT, REFINEMENT, Verdict, decide
from workbench.tracing.decimation import decimate
from workbench.tracing.evidence import CORRECTION, Evidence
from workbench.tracing.explainable import explainable
from workbench.tracing.foreseen import loaded
from workbench.tracing.further import foretold
from workbench.tracing.in_turn import later
from workbench.tracing.judge import STANDARD, Progress, ScoredCandidate
from workbench.tracing.near_value import near_values, put_back
from workbench.tracing.otherwise import as_a_curve, in_place_of_two, otherwise
from workbench.tracing.preparing import Declared, Rest, prepared, turned_back
from workbench.tracing.reporting import Outcome, reported
from workbench.tracing.result import Trace
from workbench.tracing.selection import Selection, select
from workbench.tracing.sound import soundly
from workbench.tracing.state import State
from workbench.tracing.unexplained import Unexplained, instead, traded
from workbench.tracing.weighing import Confirmed, as_they_end, confirm, refuted_by, with_curves
from workbench.tracing.wording_search import too_short

# Blocks of the identification records, by which gains are judged on what was not fitted: with fewer their scatter says nothing. Halved, a command that
# saturates for half a second is "unknown"; doubled, three measured axes of 1.3 to 2.7 s are refused
FEWEST = 4
NO_VALUE = (
    "the declared model has no value on these records: a shape parameter lies far from them; check it and its unit."
)
# Searches at most without what whole records do not bear out. Halved or doubled, no change; with none an actuator has nothing missing at a quarter
# of its drive
AGAIN = 2


@one_thread
@kept
def trace(
    plant: Plant | Fit,
    inverses: Sequence[InverseDynamics],
    progress: Progress = lambda _: None,
    most: int | None = None,
    only: Collection[str] | None = None,
    own: Collection[Effect] = (),
    criteria: Criteria = STANDARD,
    budget: Budget = BUDGET,
) -> Trace:
    """Trace the residual of `plant` on the identification records among `inverses`.

    plant: as declared, or a fit of it. most: effects added at most, as the criteria say where absent. only: names of the effects
    that are judged, all where absent. own: effects that are judged beside those of the catalogue. criteria: what
    decides. budget: of the search. Returns the verdict with its evidence. Validation records choose no class of effects; they
    decide whether what was found is borne out, and where it is not, which law of its class is; and, where what leads has values that no
    machine has, which plausible effect stands in its place. Raises WorkbenchError where the
    declared model has no value on the records, or they are too short to be judged on what was not fitted.
    """
    plant = plant.plant if isinstance(plant, Fit) else plant
    criteria = criteria if most is None else replace(criteria, steps=most)
    progress("fitting the declared model")
    logged = [n for n in CHANNELS if all(n in p.motion.record.channels for p in inverses)]
    begin = min((float(p.motion.t[0]) for p in inverses), default=0.0)
    offer = Offer(only, own, [e.key for e in plant.effects], budget=budget, logged=logged, begin=begin)
    try:
        late = prepared(plant, inverses, only, criteria)
    except NoValue:
        raise WorkbenchError(NO_VALUE) from None
    late, selected, offered = _searched(late, offer, criteria, progress)
    if late.turn and selected.answer.added and not late.turn.stands(selected.answer, late.inverses, criteria):
        progress("searching once more, with friction as it is declared")
        late, selected, offered = _searched(turned_back(late, only, criteria), offer, criteria, progress)
    return _decided(late, *_borne_out(late, selected, offered, criteria, progress), criteria, progress)


def _searched(
    late: Declared, offer: Offer, criteria: Criteria, progress: Progress
) -> tuple[Declared, Selection, Offer]:
    """Return what a search selects beside a declared model, and what it was offered; where rest is most of what is left beside that, with
    records that count where the axis moves, of a search on these."""
    declared, offered = _begun(late, offer, criteria)
    rest = Rest(late)
    selected = select(declared, late.whole, offered, criteria, progress, lambda found: rest(found) is not None)
    if selected.answer.added and (moving := rest(selected.dry)) is not None:
        progress("searching once more, where the axis moves")
        late = moving
        hinted = [j.candidate.key for j in selected.answer.added]
        declared, offered = _begun(late, replace(offer, hinted=hinted), criteria)
        selected = select(declared, late.whole, offered, criteria, progress)
    return late, selected, offered


def _borne_out(
    late: Declared, selected: Selection, offer: Offer, criteria: Criteria, progress: Progress
) -> tuple[Selection, Offer, Confirmed]:
    """Return what a search selected, what it was offered, and what whole records bear out of it; without what it added first and they
    do not bear out, which stood in the place of others, searched again.

    A drive that saturates to its sign is Coulomb friction where commands are compared as the search does, and no prediction of the drive.
    """
    for again in range(AGAIN + 1):
        progress("fitting the extended model")
        confirmed = confirm(late, selected.answer.added, selected, criteria)
        if again == AGAIN or not selected.answer.added or selected.answer.added[0] in confirmed.added:
            break
        lost = selected.answer.added[0].candidate
        progress(f"searching once more without {lost.key}, which whole records do not bear out")
        names = {e.name for e in (*catalogue().values(), *offer.own)} if offer.only is None else {*offer.only}
        offer = replace(offer, only=names - {lost.effect, lost.effect.partition(" ")[0]})
        selected = select(selected.declared, late.whole, offer, criteria, progress)
    return selected, offer, confirmed


def _decided(
    late: Declared, selected: Selection, offer: Offer, confirmed: Confirmed, criteria: Criteria, progress: Progress
) -> Trace:
    """Weigh what whole records bear out of what a search selected, decide, and say so; without what is not borne out, once more."""
    inverses, first = late.inverses, True
    progress("weighing the evidence")
    order, orders, refused, given_up, values = selected.answer.added, [], [], [], {}
    while order is not None:
        if not first:
            confirmed = confirm(late, order, selected, criteria, confirmed.levels)
        choice = Choice(selected, confirmed, late, offer, criteria, progress)
        for ask in (by_validation, soundly, otherwise, as_a_curve, in_place_of_two) if first else (soundly,):
            choice = ask(choice)
        anew, selected, confirmed = first or choice.selected is not selected, choice.selected, choice.confirmed
        if anew:
            evidence, place = _evidence_of(selected, confirmed, late, inverses, criteria)
        given_up += confirmed.given_up
        confirmed = foretold(selected, confirmed, evidence.before.size, criteria)
        evidence = replace(evidence, added=confirmed.weighed)
        verdict = decide(evidence, criteria)
        values |= near_values(confirmed, verdict, late.plant)
        orders = later(confirmed.added, verdict) if first else orders
        again, first = bool(orders) and NOT_BORNE_OUT in verdict.roles, False
        order = orders.pop(0) if again else _standing(confirmed, verdict)
        orders, values = (orders, {}) if again else ([], values)
        stands = order is None and verdict.verdict == CAUSE
        after = with_curves(confirmed.fits[-1], selected, inverses) if stands else None
        if after:
            stay = as_they_end(confirmed.added, after.plant, selected.answer.last, criteria)
            order = stay if len(stay) < len(confirmed.added) else None
        if order is not None and len(order) < len(confirmed.added):
            # without what is not borne out, the others are weighed again: one may have been needed by it alone
            refused += [a for a, r in zip(confirmed.weighed, verdict.roles, strict=True) if r == NOT_BORNE_OUT]
    confirmed, evidence, verdict = put_back(late, selected, confirmed, evidence, verdict, criteria)
    evidence, confirmed = replace(evidence, refused=tuple(refused)), replace(confirmed, given_up=tuple(given_up))
    outcome = Outcome(late, inverses, selected, confirmed, evidence, verdict, place, criteria, after, values)
    return reported(outcome, progress)


def _begun(late: Declared, offer: Offer, criteria: Criteria) -> tuple[State, Offer]:
    """Return where a search begins, and what it offers: nothing where the joint carries nothing."""
    loose, told = within_tolerance(late.plant, criteria.tolerance)
    turned = late.turn.declared if late.turn else {}
    declared = [*offer.declared, *turned]
    zeroed = any(p.motion.record.zero is not None for p in late.inverses)
    only = () if late.idle else offer.only
    offered = replace(offer, only=only, declared=declared, stands_for=told | turned, zeroed=zeroed)
    try:
        begun = State(loose, decimate(late.whole, late.plant, criteria.rate))
    except NoValue:
        raise WorkbenchError(NO_VALUE) from None
    if begun.errors.errors.size < FEWEST:
        raise WorkbenchError(too_short(seconds(begun.problem), block_seconds(begun.problem), FEWEST))
    return begun, offered


def _standing(confirmed: Confirmed, verdict: Verdict) -> list[ScoredCandidate] | None:
    """Return what of the additions stays in the extended model with a cause; None where all of it does, or there is none."""
    if verdict.verdict != CAUSE:
        return None
    roles = dict(zip((j.candidate.key for j in confirmed.added), verdict.roles, strict=True))
    kept = [j for j in confirmed.added if roles[j.candidate.key] == CAUSE or _stays(j, roles)]
    return kept if len(kept) < len(confirmed.added) else None


def _evidence_of(
    selected: Selection, confirmed: Confirmed, late: Declared, inverses: Sequence[InverseDynamics], criteria: Criteria
) -> tuple[Evidence, Unexplained | None]:
    """Return the numbers that decide, and the place that says more than what was added does, if there is one."""
    answer, base = selected.answer, _before(selected)
    calm = max(answer.last.steady, min(confirmed.levels.values(), default=0.0))
    even = {p.motion.record.name: calm for p in inverses}
    states = [base, answer.last] if answer.added else [base]
    loaded()
    told = list(shared(lambda s: explainable(s, criteria), states))
    paid = traded(base, answer.last, even) if confirmed.added else None
    place = paid or (instead(base, answer.last, even) if confirmed.added else None)
    first, last = confirmed.fits[0], confirmed.fits[-1]
    steady = {name: min(x, max(base.steady, 1e-300)) for name, x in confirmed.levels.items()}
    evidence = Evidence(
        declared={"identification": first.identification, "validation": first.validation},
        floor=refuted_by(noise_floor(inverses, steady), last, inverses),
        before=told[0],
        after=told[-1],
        added=confirmed.weighed,
        place_instead=place is not None,
        clock=late.skew is not None,
        idle=late.idle is not None,
        lost=late.lost.size if late.lost else 0.0,
        traded=paid is not None,
    )
    return evidence, Unexplained(place, base.solution.cost**0.5) if place else None


def _before(selected: Selection) -> State:
    """Return the state that what was added is held against: with the free virgin curves, but for a formula that took their place and
    leaves more than they did; then as declared."""
    base = selected.base
    return base if base.errors.total >= selected.answer.last.errors.total else selected.declared


def _stays(j: ScoredCandidate, roles: Mapping[str, str]) -> bool:
    """Whether a refinement stays in the extended model: a fixed value that is right within its tolerance does not move."""
    return roles[j.candidate.key] == REFINEMENT and j.candidate.kind != CORRECTION

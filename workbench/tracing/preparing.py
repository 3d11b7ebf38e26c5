"""What is asked of a declared model and its records before any effect is tried, in order: each answer may change either.

counts that an encoder lost are put back ─► a slow log's friction turns between its samples ─► an axis that sticks does not count at rest ─► a clock that is late between two
encoders is held ─► declared friction may turn over a speed ─► whole records are fitted: does the joint then carry anything? ─► between free zeros it is deflected by its mean torque
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from workbench.finding import Finding
from workbench.identification.fit import end_of_search, fitted_on, identify
from workbench.identification.result import Fit
from workbench.inverse.carrying import wound_up
from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.prehistory import begun
from workbench.inverse.wording import idle
from workbench.plant import TWO_MASS, Plant
from workbench.tracing.criteria import Criteria
from workbench.tracing.decimation import decimate
from workbench.tracing.mending import Mended, mended
from workbench.tracing.skew import Skew, skew_of
from workbench.tracing.slow_log import SlowLog, slow_log
from workbench.tracing.smooth_turn import SmoothTurn, smooth_turn
from workbench.tracing.sticking import Sticking, holds_a_load, sticking

Only = Collection[str] | None


@dataclass(frozen=True, eq=False)
class Declared:
    """declared: the plant as declared. plant: with the clock that the angle between two encoders says is late, held. inverses: that
    count in all that follows. fit: of that plant on whole records, which every extended one is held against, None until all else is
    known. before: the fit of the declared plant, where there is such a clock. idle: a finding that the fit lets
    the joint carry nothing. lost: counts that an encoder loses, which are put back. sticks: where it does, if that is most of the
    residual. slow: where friction turns between the samples of the log. begun: the records as the declared model's friction
    starts in them, where that is open: a search looks at these, and each fit of whole records finds its own. turn: Coulomb friction
    that turns over a speed, where it does; then `declared` and `plant` have it so."""

    declared: Plant
    plant: Plant
    inverses: Sequence[InverseDynamics]
    fit: Fit | None = None
    skew: Skew | None = None
    before: Fit | None = None
    idle: Finding | None = None
    lost: Mended | None = None
    sticks: Sticking | None = None
    slow: SlowLog | None = None
    begun: Sequence[InverseDynamics] | None = None
    turn: SmoothTurn | None = None

    @cached_property
    def whole(self) -> Sequence[InverseDynamics]:
        """The identification records."""
        return fitted_on(self.begun or self.inverses)

    @cached_property
    def holds_a_load(self) -> bool:
        """Whether rest, which is most of what the declared model leaves, tells of a load."""
        return holds_a_load(self.plant, self.inverses)

    @cached_property
    def decimated(self) -> Sequence[InverseDynamics]:
        """The same at the lowest rate."""
        return decimate(self.whole)


def prepared(plant: Plant, inverses: Sequence[InverseDynamics], only: Only, criteria: Criteria) -> Declared:
    """Return a declared plant and its records as the search for effects meets them. only: names of the effects that are judged."""
    found = Declared(plant, plant, inverses)
    for ask in FIRST:
        found = ask(found, only, criteria)
    return found


def turned_back(d: Declared, only: Only, criteria: Criteria) -> Declared:
    """Return what is known of a model whose declared friction turned over a speed, with that friction as it is declared."""
    declared = d.turn.back(d.declared)
    before = identify(declared, d.inverses) if d.before else None
    return _fitted(replace(d, declared=declared, plant=d.turn.back(d.plant), turn=None, before=before), only, criteria)


class Rest:
    """Whether rest is most of what is left of records beside what a search found: asked once of each set of effects."""

    def __init__(self, d: Declared):
        self.declared = d
        self.known: dict[frozenset[str], Declared | None] = {}

    def __call__(self, found: Plant) -> Declared | None:
        """Return records that count where the axis moves, where rest is most of what is left beside `found`; None else."""
        held = frozenset(e.key for e in found.effects)
        if held not in self.known:
            self.known[held] = self._without(found)
        return self.known[held]

    def _without(self, found: Plant) -> Declared | None:
        d = self.declared
        sticks = None if d.sticks else sticking(found, d.inverses)
        if sticks is None or d.holds_a_load:
            return None
        before = identify(d.declared, sticks.inverses) if d.before else None
        fit, started = _fit(d.plant, sticks.inverses)
        sticks = replace(sticks, beside=True)
        return replace(d, inverses=sticks.inverses, sticks=sticks, before=before, fit=fit, begun=started)


def _put_back(d: Declared, only: Only, criteria: Criteria) -> Declared:
    lost = mended(d.plant, d.inverses, criteria.explainable)
    return replace(d, inverses=lost.inverses, lost=lost) if lost else d


def _turn_between(d: Declared, only: Only, criteria: Criteria) -> Declared:
    found = slow_log(d.plant, d.inverses, criteria.practical)
    return replace(d, inverses=found.inverses, slow=found) if found else d


def _leave_rest_out(d: Declared, only: Only, criteria: Criteria) -> Declared:
    sticks = sticking(d.plant, d.inverses)
    return replace(d, inverses=sticks.inverses, sticks=sticks) if sticks and not d.holds_a_load else d


def _hold_late_clock(d: Declared, only: Only, criteria: Criteria) -> Declared:
    """The angle between two encoders is asked before anything in torque."""
    if d.plant.kind != TWO_MASS or (only is not None and "clock_skew" not in only):
        return d
    skew = skew_of(d.decimated, d.plant)
    return replace(d, plant=skew.candidate.plant, skew=skew, before=identify(d.plant, d.inverses)) if skew else d


def _turn_smoothly(d: Declared, only: Only, criteria: Criteria) -> Declared:
    """What is declared is then friction that turns so: the errors before and after are of what is missing alone."""
    turn = smooth_turn(d.plant, d.inverses, criteria)
    if turn is None:
        return d
    declared = turn.of(d.declared)
    before = identify(declared, d.inverses) if d.before else None
    return replace(d, declared=declared, plant=turn.of(d.plant), turn=turn, before=before)


def _fitted(d: Declared, only: Only, criteria: Criteria) -> Declared:
    found, started = _fit(d.plant, d.inverses)
    if d.plant.kind != TWO_MASS:
        return replace(d, fit=found, begun=started)
    empty = idle(d.inverses, found.plant)
    wound = d.inverses if empty else wound_up(d.inverses, found.plant)
    if all(a is b for a, b in zip(wound, d.inverses, strict=True)):
        return replace(d, fit=found, begun=started, idle=empty)
    fit, started = _fit(d.plant, wound)
    return replace(d, fit=fit, begun=started, inverses=wound)


def _fit(plant: Plant, inverses: Sequence[InverseDynamics]) -> tuple[Fit, Sequence[InverseDynamics] | None]:
    """Return the fit of a plant from where its search has ended, and the records as its friction starts in them, None where that is as they are."""
    found = identify(plant, inverses, end_of_search(plant, fitted_on(inverses)), solved=True)
    if (started := begun(found.plant, inverses)) is None:
        return found, None
    return identify(plant, inverses, end_of_search(plant, fitted_on(started)), solved=True), started


FIRST = (_put_back, _turn_between, _leave_rest_out, _hold_late_clock, _turn_smoothly, _fitted)

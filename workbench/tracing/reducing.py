"""What effect a fitted one is by its values: LuGre without presliding is Stribeck's friction, a kinematic error of order 1 an eccentricity."""

from collections.abc import Mapping
from math import pi

from workbench.definition import TIME, TWO_COUNTS, Effect
from workbench.plant import TWO_MASS
from workbench.tracing.candidates import ADDITION
from workbench.tracing.criteria import Criteria
from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.state import Refitted, State


def reduced_to(j: ScoredCandidate, state: State | Refitted, criteria: Criteria) -> str | None:
    """Return the name of the simpler effect that a fitted addition is, "" for none at all, None where it is itself."""
    if not j.refitted or j.candidate.kind != ADDITION:
        return None
    return by_values(j.refitted.plant[j.candidate.key], state, criteria)


def by_values(effect: Effect, state: State | Refitted, criteria: Criteria) -> str | None:
    """Return the name of the simpler effect that a fitted one is on the records of a state, "" for none at all, None where it is itself."""
    if effect.port == TIME and state.plant.kind == TWO_MASS:
        return None  # a clock of one of two encoders is no delay of the drive
    counts = max(p.motion.counts for p in state.inverses)
    # a stiffness is nothing beside a stiffness: what is small is so beside what enters as it does, with its unit; a share is no coefficient of friction
    linear = {n: effect.parameters[n] for n in effect.linear}
    largest = {p.unit: max(abs(q.value) for q in linear.values() if q.unit == p.unit) for p in linear.values()}
    near = {
        n: criteria.neutral * (largest[p.unit] if n in linear else abs(p.value)) for n, p in effect.parameters.items()
    }
    # a clock that over all the records gains less than half a sample keeps pace
    span = max(p.motion.t[-1] for p in state.inverses) - min(p.motion.t[0] for p in state.inverses)
    step = min(p.motion.record.dt for p in state.inverses)
    near |= {n: 0.5 * step / span for n, p in effect.parameters.items() if p.scale == "drift"}
    # a delay is none that turns the fastest of the band by less than is of practical size
    near |= {n: max(near[n], _shortest(state, criteria)) for n, p in effect.parameters.items() if p.scale == "time"}
    around = {n: (p.value - near[n], p.value + near[n]) for n, p in effect.parameters.items()}
    # nor is a gap a gap that is short beside the presliding length
    length = effect.parameters["x0"].value if "x0" in effect.parameters else 0.0
    return simpler(effect, around, max(counts, 0.5 * criteria.neutral * length))


def _shortest(state: State | Refitted, criteria: Criteria) -> float:
    """Return the time, s, that turns the fastest of the band by what is of practical size."""
    return criteria.practical / (2.0 * pi * max(p.motion.filter.bandwidth for p in state.inverses))


def simpler(effect: Effect, intervals: Mapping[str, tuple[float, float]], counts: float) -> str | None:
    """Return the name of the simpler effect that this one is, "" where it is none at all, None where it is itself.

    intervals: inside parameter -> (low, high), SI; a parameter without one stands at its value. counts: the encoder's step, SI.
    A parameter is neutral where its interval holds the neutral value or, of TWO_COUNTS, reaches down to two counts. A composite
    of which every part is gone is none at all.
    """
    found = []
    for name, (neutral, left) in effect.reduces.items():
        value = effect.parameters[name].value
        low, high = intervals.get(name, (value, value))
        if low <= 2.0 * counts if neutral == TWO_COUNTS else low <= neutral <= high:
            found.append(left)
    if not found:
        return None
    return "" if len(effect.parts) > 1 and len(found) == len(effect.parts) else found[0]

"""What a plan promises of each parameter, beside what the records tell now; and why some are not determined."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from workbench.identification.result import Estimate
from workbench.planning import wording
from workbench.planning.lack import lack_of
from workbench.planning.selection import Plan

LEAST = 0.01  # share of a value below which nothing is promised: there the model's own picture of the axis ends


@dataclass(frozen=True)
class Prospect:
    """One parameter. now, then: half width of its 95 % interval, a share of its value (of one radian where it is a phase).

    now: by the records; then: promised of a record of the plan, LEAST at the best. why: what keeps it from the accuracy.
    """

    effect: str
    at: str
    parameter: str
    value: float
    unit: str
    now: float
    then: float
    reached: bool
    why: str
    sentence: str


def prospects(plan: Plan, known: Sequence[Estimate], accuracy: float) -> tuple[Prospect, ...]:
    """Return a prospect of every free parameter, as it is written outside. known: what the records tell of the same plant."""
    now = {(e.effect, e.at, e.parameter): e for e in known}
    found = []
    for e in plan.promised:
        if e.fixed:
            continue
        whole = _size(plan, e)
        then = max(_share(e, whole), LEAST)
        before = _share(now[e.effect, e.at, e.parameter], whole)
        reached = then <= max(accuracy, LEAST)
        why = "" if reached else wording.why(lack_of(plan, e, then, accuracy))
        sentence = wording.prospect(e, before, then, why, best=then <= LEAST)
        found.append(Prospect(e.effect, e.at, e.parameter, e.value, e.unit, before, then, reached, why, sentence))
    return tuple(found)


def _size(plan: Plan, e: Estimate) -> float:
    """Return what a parameter's interval is a share of: its value, or one radian of a phase."""
    return 1.0 if plan.plant[f"{e.effect}@{e.at}"].outside[e.parameter].unit == "rad" else abs(e.value)


def _share(e: Estimate, whole: float) -> float:
    """Return the half width of an interval over `whole`; infinite where there is none or nothing to compare with."""
    half = 0.5 * (e.high - e.low)
    return half / whole if half > 0.0 and whole > 0.0 else inf

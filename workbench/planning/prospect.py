"""What a plan promises of each parameter, beside what the records tell now; and why some are not determined."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from workbench.finding import capital, located
from workbench.identification.intervals import known_together
from workbench.identification.result import Estimate
from workbench.planning.information import names_of
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
        why = "" if reached else _reason(plan, e, then, accuracy)
        found.append(
            Prospect(
                e.effect,
                e.at,
                e.parameter,
                e.value,
                e.unit,
                before,
                then,
                reached,
                why,
                _sentence(e, before, then, why),
            )
        )
    return tuple(found)


def _size(plan: Plan, e: Estimate) -> float:
    """Return what a parameter's interval is a share of: its value, or one radian of a phase."""
    return 1.0 if plan.plant[f"{e.effect}@{e.at}"].outside[e.parameter].unit == "rad" else abs(e.value)


def _share(e: Estimate, whole: float) -> float:
    """Return the half width of an interval over `whole`; infinite where there is none or nothing to compare with."""
    half = 0.5 * (e.high - e.low)
    return half / whole if half > 0.0 and whole > 0.0 else inf


def _per_cent(part: float) -> str:
    return f"{100 * part:.2g} %" if part < 0.995 else "no better than its size"


def _sentence(e: Estimate, now: float, then: float, why: str) -> str:
    value = f"{e.value:.3g}" + ("" if e.unit in ("1", "") else f" {e.unit}")
    best = _per_cent(then) + (" or better" if then <= LEAST else "")
    text = f"{capital(located(e.effect, e.at))}, {e.meaning}: {value}, now known to {_per_cent(now)}, with this motion to {best}"
    return f"{text}; {why}." if why else f"{text}."


def _reason(plan: Plan, e: Estimate, then: float, accuracy: float) -> str:
    """Return why a parameter is not determined as well as was asked for, as a clause."""
    names, effect = names_of(plan.plant), plan.plant[f"{e.effect}@{e.at}"]
    mine = [k for k, n in enumerate(names) if n.key == effect.key]
    linear = [k for k in mine if names[k].parameter in effect.linear]
    if linear and all(effect.parameters[names[k].parameter].value == 0.0 for k in linear):
        return "the effect is zero as it is fitted, and what is not there has no shape and no share of itself"
    dark = [k for k in mine if plan.information.gram[k, k] == 0.0]
    if dark and len(dark) == len(mine):
        return "no motion within the limits shows it in the drive"
    for group, r in known_together(plan.covariance):
        if set(group) & set(mine):
            others = ", ".join(f"{names[k].key}.{names[k].parameter}" for k in group)
            return f"{others} are known only together (correlation up to {r:.3f}) by any motion within the limits"
    longer = (then / accuracy) ** 2 * plan.trajectory.time[-1]
    if not np.isfinite(longer) or longer > 3600.0:
        return "its part in the drive stays below the noise along every motion within the limits"
    return f"against this noise it would take {longer:.0f} s of such motion"

"""Why a plan does not determine a parameter as well as was asked for."""

from dataclasses import dataclass
from math import inf

import numpy as np

from workbench.identification.intervals import known_together
from workbench.identification.result import Estimate
from workbench.planning.information import names_of
from workbench.planning.selection import Plan

ABSENT, DARK, TOGETHER, BELOW_NOISE, LONGER = "absent", "dark", "together", "below noise", "longer"
LONGEST = (
    3600.0  # s of a motion, beyond which no record is asked for: half or twice of it is no motion of one's day either
)


@dataclass(frozen=True)
class Lack:
    """reason: ABSENT, the effect is zero as fitted; DARK, no motion shows it; TOGETHER, it is known only with `others`, up to a
    `correlation`; BELOW_NOISE; or LONGER, it would take these `seconds` of such motion."""

    reason: str
    others: tuple[str, ...] = ()
    correlation: float = 0.0
    seconds: float = inf


def lack_of(plan: Plan, e: Estimate, then: float, accuracy: float) -> Lack:
    """Return why a parameter is not determined as well as was asked for. then: promised, accuracy: asked for, shares of its value."""
    names, effect = names_of(plan.plant), plan.plant[f"{e.effect}@{e.at}"]
    mine = [k for k, n in enumerate(names) if n.key == effect.key]
    linear = [k for k in mine if names[k].parameter in effect.linear]
    if linear and all(effect.parameters[names[k].parameter].value == 0.0 for k in linear):
        return Lack(ABSENT)
    dark = [k for k in mine if plan.information.gram[k, k] == 0.0]
    if dark and len(dark) == len(mine):
        return Lack(DARK)
    for group, r in known_together(plan.covariance):
        if set(group) & set(mine):
            return Lack(TOGETHER, tuple(f"{names[k].key}.{names[k].parameter}" for k in group), r)
    longer = float((then / accuracy) ** 2 * plan.trajectory.time[-1])
    return Lack(BELOW_NOISE) if not np.isfinite(longer) or longer > LONGEST else Lack(LONGER, seconds=longer)

"""Whether two campaigns can be compared: of one axis, by one model, on records that show the same."""

from collections.abc import Sequence

import numpy as np

from workbench.campaign import Campaign
from workbench.difference.wording import other_counts, other_reach
from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.identification.fit import fitted_on
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import MASSES

APART = 2.0  # factor between what two campaigns cover from which on it is said
SIGNALS = (("speeds", "v"), ("accelerations", "a"), ("positions", "q"))


def check_models(before: Campaign, after: Campaign) -> None:
    """WorkbenchError where the two declare different plants, or a resolution or a kind of axis that differs."""
    a, b = before.plant, after.plant
    if (a.kind, a.rotary) != (b.kind, b.rotary):
        raise WorkbenchError(
            f"'{before.folder}' is {_kind(a)} and '{after.folder}' {_kind(b)}; these are not one axis."
        )
    mine, yours = {e.key for e in a.effects}, {e.key for e in b.effects}
    if mine != yours:
        only = [
            f"{key} by '{c.folder}' only"
            for c, keys in ((before, mine - yours), (after, yours - mine))
            for key in sorted(keys)
        ]
        raise WorkbenchError(
            f"the two campaigns declare different models: {', '.join(only)}; declare the same effects in both, so that the "
            "same parameters are compared."
        )


def _kind(plant) -> str:
    return f"a {'rotary' if plant.rotary else 'linear'} axis of {MASSES[plant.kind]}"


def doubts(
    before: Campaign, after: Campaign, first: Sequence[InverseDynamics], second: Sequence[InverseDynamics]
) -> tuple[Finding, ...]:
    """Say what the records of the two do not share: encoder, and ranges of speed, acceleration and position."""
    said = []
    for name in sorted(set().union(*(r.resolution for r in (*before.records, *after.records)))):
        steps = [max(r.resolution.get(name, 0.0) for r in c.records) for c in (before, after)]
        if steps[0] != steps[1]:
            said.append(other_counts(name, *steps))
    for what, signal in SIGNALS:
        reach = [_reach(fitted_on(inverses), signal) for inverses in (first, second)]
        if max(reach) > APART * min(reach):
            said.append(other_reach(what, *reach))
    return tuple(said)


def _reach(inverses: Sequence[InverseDynamics], signal: str) -> float:
    """Return what records cover of a signal: the span of positions, else the largest."""
    kept = [getattr(p.motion, signal)[p.motion.keep] for p in inverses]
    if signal == "q":
        return max(max(float(x.max()) for x in kept) - min(float(x.min()) for x in kept), 1e-300)
    return max(*(float(np.abs(x).max()) for x in kept), 1e-300)

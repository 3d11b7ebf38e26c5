"""A joint that has nearly no stiffness at rest has a gap, whichever law of hardening bends to its soft flanks."""

from collections.abc import Sequence

import numpy as np

from workbench.definition import FORCE
from workbench.inverse.bodies import POSITION
from workbench.inverse.dynamics import InverseDynamics
from workbench.kernel.step import build
from workbench.plant import Plant
from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.state import State

GAP = "backlash"
# Stiffness at rest over the largest, below which a joint has a gap. Of gaps the law that led had 0.21 and less, of joints that harden 0.33 and
# more. The one campaign on which it says something keeps its gap, halved or doubled
SLACK = 0.25
REACH, STEPS = (
    0.99,
    81,
)  # quantile of the deflection up to which a joint's curve is looked at, and its points: an odd number, one at rest


def bent_gap(present: ScoredCandidate, rest: Sequence[ScoredCandidate], last: State) -> bool:
    """Whether an addition is a gap whose flanks another law of the joint's stiffness bends: that law alone says both, and is no less a gap's.

    rest: the other additions; last: the state with all of them.
    """
    if present.candidate.effect != GAP or present.candidate.at != "joint" or not present.score.earns:
        return False
    bends = (j.candidate for j in rest if j.candidate.at == "joint")
    if not any(c.family == present.candidate.family for c in bends):
        return False
    return stiffness_at_rest(last.plant, last.inverses) < SLACK


def stiffness_at_rest(plant: Plant, inverses: Sequence[InverseDynamics]) -> float:
    """Return dT/dx at x = 0 over the largest dT/dx of a joint's laws of its deflection x alone, within the deflections of the records; no
    unit, 1 where the joint carries nothing."""
    free = (p for p in inverses if not p.motion.record.locked)
    seen = np.concatenate([p.bodies.joint(plant)[1][POSITION][p.motion.keep] for p in free] or [np.zeros(1)])
    reach = float(np.quantile(np.abs(seen - seen.mean()), REACH))
    x = np.linspace(-reach, reach, STEPS)
    torque = np.zeros(STEPS)
    for e in plant.effects:
        if e.at == "joint" and e.port == FORCE and tuple(e.reads) == ("q",) and not e.states:
            values = {n: p.value for n, p in e.parameters.items()}
            columns = build(e).run({"q": x}, values)
            torque += sum(w * c for w, c in zip([values[n] for n in e.linear] or [1.0], columns, strict=False))
    slope = np.diff(torque)
    middle = slope[STEPS // 2 - 1 : STEPS // 2 + 1]
    return float(middle.mean() / slope.max()) if slope.max() > 0.0 else 1.0

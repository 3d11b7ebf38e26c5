"""A constant force beside dry friction: a load, or friction that is larger one way than the other.

While an axis moves both are one number, and at rest friction holds either. What a load comes to has nothing to do with friction; an
asymmetry is a part of it.
"""

from collections.abc import Sequence

from workbench.effects.free_bank import NAME as FREE_CURVE
from workbench.plant import Plant
from workbench.tracing.candidates import ADDITION
from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.near_law import heights

OFFSET, ASYMMETRY = "constant_offset", "coulomb_asymmetry"
# Share of dry friction up to which a constant that is not declared is its asymmetry. Of twenty-four authors nobody left out a constant force; of 95 axes
# on which one is declared beside dry friction it is more than half of that on 60. Three asymmetries beside which none is declared, 0.20 to 0.33 of
# friction, were called a constant force. Halved, two of the three are; doubled, none changes
PART = 0.5


def one_sided(first: ScoredCandidate, level: Sequence[ScoredCandidate]) -> ScoredCandidate:
    """Return the asymmetry of friction in the place of a constant force, where it is among what explains the same, is at most PART of the dry
    friction at its place and goes along with it alone; the first judgement else. A joint carries a constant from one body to the other: of two masses
    the asymmetry may be the other one's, and that at the place of the constant is asked first."""
    if first.candidate.kind != ADDITION or first.candidate.effect != OFFSET:
        return first
    here_first = sorted(level, key=lambda j: j.candidate.at != first.candidate.at)
    for j in here_first:
        if j.candidate.effect == ASYMMETRY and j.refitted and j.score.earns:
            plant = j.refitted.plant
            share = abs(plant[j.candidate.key].parameters["coulomb_difference"].value)
            if share <= PART * _dry_friction(plant, j.candidate.at):
                return j
    return first


def asked_freely(best: ScoredCandidate, judgements: Sequence[ScoredCandidate]) -> list[ScoredCandidate]:
    """Return the judgements whose class' free form is to be asked beside what leads: of an asymmetry that is a constant force by its values none over position, of
    which such a force is a part; what else lives there is asked after it."""
    level = next((j for j in judgements if (j.candidate.effect, j.candidate.at) == (OFFSET, best.candidate.at)), None)
    if level is None or one_sided(level, [best]) is not best:
        return [*judgements]
    return [
        j for j in judgements if (j.candidate.family, j.candidate.at) != (level.candidate.family, level.candidate.at)
    ]


def _dry_friction(plant: Plant, at: str) -> float:
    """Return the dry friction at a place where it slides, in N*m or N: Coulomb friction, the height of a hysteresis or of a free virgin curve."""
    here = [e for e in plant.effects if e.at == at]
    named = (e.parameters[n].value for e in here for n in ("coulomb", "h0") if n in e.linear)
    return sum(named) + sum(sum(heights(e).values()) for e in here if e.name == FREE_CURVE)

"""Rivals of a cause: candidates that these records cannot tell from it, and the motion that would."""

from collections.abc import Sequence

from workbench.errors import WorkbenchError
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.tracing.candidates import ADDITION, without
from workbench.tracing.criteria import Criteria
from workbench.tracing.decimation import decimate
from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.ranking import alike
from workbench.tracing.reducing import reduced_to

PLANNED = (
    6.5  # rate over the evaluation bandwidth at which motions are compared: a coarser one parts what does not part
)
MOST = 4  # named with a cause


def rivals(
    found: ScoredCandidate,
    added: Sequence[ScoredCandidate],
    steps: Sequence[Sequence[ScoredCandidate]],
    criteria: Criteria,
    power: float,
) -> list[ScoredCandidate]:
    """Return the candidates that could not be told from an added one in the step in which it was chosen, best first.

    What was added is no rival, another law under its name neither: it explains something else, or is the cause. Nor is what by its values says the same: a clock that keeps pace is a delay.
    """
    level: dict[str, ScoredCandidate] = {}
    for judgements in steps:
        if any(j is found for j in judgements):
            for j in judgements:
                if j is found or not (j.refitted and j.score.earns and alike(found, j, criteria, power)):
                    continue
                if reduced_to(j, j.refitted, criteria) != found.candidate.effect:
                    level.setdefault(j.score.effect, j)
    taken = {n for j in added for n in (j.score.effect, j.candidate.name)}
    return [j for name, j in level.items() if name not in taken][:MOST]


def experiment(
    plant: Plant,
    declared: Plant,
    found: ScoredCandidate,
    rival: ScoredCandidate,
    whole: Sequence[InverseDynamics],
    rms: float,
) -> str:
    """Return, in a sentence, the motion that tells a cause from its first rival, or "" where none can be planned.

    plant, declared: the extended one and the one without. whole: inverse dynamics of the identification records as they are. rms: of
    the noise behind the evaluation filter.
    """
    from workbench.planning import envelope_of, load_rest, sensing_of, separate

    a, b = plant[found.candidate.key], rival.refitted.plant[rival.candidate.key]
    inverses = decimate(whole, least=PLANNED)
    bare = without(plant, found.candidate, declared)
    bare = bare.without(b.key) if b.key in {e.key for e in bare.effects} and rival.candidate.kind == ADDITION else bare
    try:
        return separate(
            bare, a, b, envelope_of(bare, inverses), sensing_of(inverses, rms, load_rest(plant, inverses), whole)
        ).sentence
    except WorkbenchError:
        return ""

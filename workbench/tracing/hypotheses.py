"""What effects that somebody names come to beside a model, each alone."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from workbench.definition import Effect
from workbench.identification.fit import identify
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.tracing.tracing import trace

Say = Callable[[str], None]


@dataclass(frozen=True)
class Tried:
    """A hypothesis beside a model: its held-out gain with one standard error, and the errors with it."""

    hypothesis: str
    effect: str
    gain: float
    scatter: float
    identification: float
    validation: float


def tried(
    plant: Plant, inverses: Sequence[InverseDynamics], hypotheses: Mapping[str, Effect], say: Say = lambda _: None
) -> tuple[Tried, ...]:
    """Return what each hypothesis (its words -> effect) comes to when it alone is added to `plant`.

    An effect that the trace offers anyway may be given with a label, so that it is judged with the values it carries.
    """
    own = {e.named: e for e in hypotheses.values()}
    ranked = {c.effect: c for c in trace(plant, inverses, say, most=1, only=tuple(own), own=tuple(own.values())).ranked}
    result = []
    for words, e in hypotheses.items():
        fit = identify(plant + e, inverses)
        one = ranked[e.named]
        result.append(Tried(words, e.named, one.gain, one.scatter, fit.identification, fit.validation))
    return tuple(result)

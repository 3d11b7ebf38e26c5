"""In which order whole records are asked of additions: one may need another, and what makes up for it in the meantime may take its place."""

from collections.abc import Sequence

from workbench.tracing.decide import NOT_BORNE_OUT, Verdict
from workbench.tracing.judge import ScoredCandidate


def later(added: Sequence[ScoredCandidate], verdict: Verdict) -> list[list[ScoredCandidate]]:
    """Return orders in which additions that are not borne out come behind the first of the others, and behind all of them: one may need
    another, and what makes up for it in the meantime may take its place. None where they come last."""
    out = [r == NOT_BORNE_OUT for r in verdict.roles]
    if out == sorted(out):
        return []
    others = [j for j, o in zip(added, out, strict=True) if not o]
    lost = [j for j, o in zip(added, out, strict=True) if o]
    last = [*others, *lost]
    return [last] if len(others) == 1 else [[*others[:1], *lost, *others[1:]], last]

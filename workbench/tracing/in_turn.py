"""In which order whole records are asked of additions: one may need another, and what makes up for it in the meantime may take its place."""

from collections.abc import Sequence
from dataclasses import replace

from workbench.tracing.decide import CAUSE, NOT_BORNE_OUT, Verdict
from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.weighing import Confirmed


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


def fewer_causes(verdict: Verdict, before: Verdict) -> bool:
    """Whether an order in which what was not borne out came earlier says less than the one before: it took from a cause, which is none any
    more, and is none itself. Then what was not borne out is left out."""
    return verdict.verdict == CAUSE and verdict.roles.count(CAUSE) < before.roles.count(CAUSE)


def by_each_other(first: Confirmed, said: Verdict, second: Confirmed, then: Verdict) -> Confirmed | None:
    """Return additions of which in either order only the last is borne out, each as it is weighed where it comes last; None where some is borne out in
    neither order, or all are in one.

    Beside a friction that falls as grease warms up, a drive that is late makes the validation record worse by itself, and so does the friction beside
    that drive; together they leave a fifth. said, then: what is decided of either order.
    """
    roles, others = (
        dict(zip((j.candidate.key for j in c.added), v.roles, strict=True)) for c, v in ((first, said), (second, then))
    )
    out, also = ({k for k, r in each.items() if r == NOT_BORNE_OUT} for each in (roles, others))
    if roles.keys() != others.keys() or not out or not also or out & also:
        return None
    if any(others[k] != CAUSE for k in out) or any(roles[k] != CAUSE for k in also):
        return None
    last = {j.candidate.key: w for j, w in zip(second.added, second.weighed, strict=True)}
    weighed = zip(first.added, first.weighed, strict=True)
    return replace(
        first,
        weighed=tuple(
            replace(last[j.candidate.key], together=True) if j.candidate.key in out else w for j, w in weighed
        ),
    )

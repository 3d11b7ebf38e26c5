"""What was added, weighed on whole records: its sizes, whether its values may be a machine's, whether a nearer law says it."""

from collections.abc import Sequence

from workbench.identify.result import Fit
from workbench.plant import Plant
from workbench.record import ROLES
from workbench.trace.criteria import Criteria
from workbench.trace.evidence import CORRECTION, Weighed
from workbench.trace.judge import Judgement
from workbench.trace.near_law import NAME
from workbench.trace.plausible import implausible
from workbench.trace.result import Refinement
from workbench.trace.selection import Selection


def weighed(
    selected: Selection, added: Sequence[Judgement], fits: Sequence[Fit], criteria: Criteria
) -> tuple[Weighed, ...]:
    """Return each addition with what whole records say of it. fits: of the declared plant and with one more of these each."""
    declared, found = fits[0].plant, []
    for i, j in enumerate(added):
        before, after = fits[i], fits[i + 1]
        last = fits[-1].plant
        present = j.suspect.key in {e.key for e in last.effects}
        found.append(
            Weighed(
                effect=j.suspect.name,
                at=j.candidate.at,
                kind=j.suspect.kind,
                before={r: getattr(before, r) for r in ROLES},
                after={r: getattr(after, r) for r in ROLES},
                changed=change(declared, last, j.suspect.key) if j.suspect.kind == CORRECTION and present else 0.0,
                tolerance=criteria.tolerance,
                law="free form" if j.suspect.stands else "catalogue",
                implausible=implausible(last[j.suspect.key], last, declared, selected.declared.passes)
                if present
                else "",
            )
        )
    return tuple(found)


def change(declared: Plant, plant: Plant, key: str) -> float:
    """Return the largest relative change of an effect's fixed values; of one that was declared as zero, 1."""
    new = plant[key].parameters
    changes = [
        abs(new[n].value / p.value - 1.0) if p.value != 0.0 else float(new[n].value != 0.0)
        for n, p in declared[key].parameters.items()
        if p.fixed
    ]
    return max(changes, default=0.0)


def curve_of(selected: Selection, before: Fit, after: Fit) -> list[Refinement]:
    """Return the refinements that the free virgin curves of the final fit are."""
    if before is after:
        return []
    return [
        Refinement(
            effect=law.declared.named,
            at=law.declared.at,
            kind="law",
            sentence=(
                f"The declared law of {law.declared.named.replace('_', ' ')} at the {law.declared.at} is only nearly right: with a "
                f"free virgin curve in its place the identification error goes from {100 * before.identification:.2f} % to "
                f"{100 * after.identification:.2f} %."
            ),
            parameters=tuple(e for e in after.estimates if (e.effect, e.at) == (NAME, law.declared.at)),
            size=max(before.identification**2 - after.identification**2, 0.0) ** 0.5,
        )
        for law in selected.refined
    ]

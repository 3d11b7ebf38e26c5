"""What leads a search without being certain over blocks, and is carried by validation: few blocks may hold all that shows a cause.

A force constant falls where a drive gives much, which a growing sine does in its last seconds alone; hard moves hold little else.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite

from workbench.identification.result import Fit
from workbench.tracing.choice import Choice
from workbench.tracing.full_rate import nested_fits
from workbench.tracing.judge import refitted_as
from workbench.tracing.near_law import as_declared
from workbench.tracing.orders import any_curve
from workbench.tracing.ranking import absurd
from workbench.tracing.weighing import with_curves


def by_validation(choice: Choice) -> Choice:
    """Return the choice with an effect that the validation record makes certain, where nothing was added: it takes `plain` of blocks that were not
    seen, though not for certain, and, fitted to the identification records, `held` of the validation record's residual power, beside the free
    virgin curves that stay, too; of several the one that takes most there. The choice itself where there is none, and without such a record.

    Of 122 axes to which nothing was added ten are asked, and one is carried so: a force constant that falls takes 0.64 there; what is no cause
    took 0.38 and less. With `held` halved a cushion and what another axis asks of a head are dressed so; doubled, none is carried.
    """
    declared, selected = choice.confirmed.fits[0], choice.selected
    if choice.confirmed.added or not selected.steps or not isfinite(declared.validation):
        return choice
    best, least = None, declared.validation
    for j in selected.steps[0].judgements:
        if j.score.earns or j.score.gain < choice.criteria.plain or j.theta is None:
            continue
        choice.progress(f"asking whether validation carries {j.candidate.key}")
        k = refitted_as(selected.base, j, choice.criteria)
        if k.state is None or absurd(k, selected.base) or any_curve(k, selected.base, choice.criteria):
            continue
        kept, fits = nested_fits(choice.late, [k], as_declared(k.state.plant, selected.laws), k.state.inverses)
        if kept and fits[-1].validation < least and _carried(fits, choice):
            best, least = (k, kept, fits), fits[-1].validation
    if best is None:
        return choice
    taken = choice.taking(*best)
    weighed = tuple(replace(a, chosen=True) for a in taken.confirmed.weighed)
    return replace(taken, confirmed=replace(taken.confirmed, weighed=weighed))


def _carried(fits: Sequence[Fit], choice: Choice) -> bool:
    """Whether the second of two fits leaves less than the first by `held` of the validation record's residual power, and with free virgin curves, too."""
    curves = [with_curves(f, choice.selected, choice.late.inverses) for f in fits]
    return all(
        after.validation**2 <= (1.0 - choice.criteria.held) * before.validation**2 for before, after in (fits, curves)
    )

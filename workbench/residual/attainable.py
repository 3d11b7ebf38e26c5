"""How far records repeat themselves and each other: what no model of the axis, however good, would leave less than."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.identification.result import Fit
from workbench.inverse.dynamics import InverseDynamics
from workbench.record import ROLES, VALIDATION
from workbench.residual.repeats import between, repeats


@dataclass(frozen=True)
class Attainable:
    """Over the rms of the drive: what does not repeat within a record, by role, and between the two records."""

    within: Mapping[str, float]
    share: Mapping[str, float]
    across: float


def attainable(fit: Fit, inverses: Sequence[InverseDynamics]) -> Attainable:
    """Return how far one identification and one validation record repeat themselves and each other, seen beside `fit`.

    `across` is what is left on the validation record by whoever takes what `fit` lacks from the identification record, as
    it was measured there in the same state.
    """
    found = {}
    for role in ROLES:
        m = next(p.motion for p in inverses if p.motion.record.role == role)
        s = fit.series[m.record.name]
        found[role] = m, s.residual, float(np.sqrt(np.mean(s.measured[s.keep] ** 2)))
    each = {role: repeats(m, r) for role, (m, r, _) in found.items()}
    whole = {role: rms for role, (*_, rms) in found.items()}
    (one, first, _), (other, second, _) = (found[role] for role in ROLES)
    return Attainable(
        {role: each[role].rms / whole[role] for role in ROLES},
        {role: each[role].share for role in ROLES},
        between(one, first, other, second).rms / whole[VALIDATION],
    )

"""The same plant fitted to the records of each role alone: what differs between them."""

from collections.abc import Sequence
from dataclasses import replace

from workbench.identification.fit import fitted_on, identify
from workbench.identification.result import Fit
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, ROLES


def refitted(plant: Plant, inverses: Sequence[InverseDynamics]) -> dict[str, Fit]:
    """Return role -> fit of the same plant to the records of that role alone."""
    fits = {}
    for role in ROLES:
        turned = [
            InverseDynamics(replace(p.motion, record=replace(p.motion.record, role=IDENTIFICATION)), times=p.times)
            for p in inverses
            if p.motion.record.role == role
        ]
        fits[role] = identify(plant, fitted_on(turned))
    return fits

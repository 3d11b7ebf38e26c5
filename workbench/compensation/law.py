"""A controller with a compensation: the two laws as one, in SX, with the states of both."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from workbench.compensation.compensator import READ, Compensator
from workbench.compensation.parts import asked, forces
from workbench.compensation.structure import PREFIX, Structure, states_of, structure, values_names, values_of
from workbench.control.law import Controller, Law
from workbench.errors import WorkbenchError
from workbench.simulation.dynamics import DIRECTION


@dataclass(frozen=True, eq=False)
class Compensated(Controller):
    """A controller with a compensation, which still knows what it is made of: for a file, or another machine."""

    base: Controller | None = None
    compensator: Compensator | None = None


def compensated(controller: Controller, compensator: Compensator) -> Compensated:
    """Return the controller with the compensation in its law; its numbers, and the compensation's gain, may differ a lane.

    The sum is limited to the drive's torque. The law's own limit knows nothing of what the compensation takes of it.
    """
    if any(n.startswith(f"{PREFIX}_") for n in controller.law.parameters):
        raise WorkbenchError(
            f"controller '{controller.name}' is compensated already; put all effects into one compensator, so that what they "
            "share is counted once."
        )
    made = structure(compensator)
    law = _law(controller.law, made)
    given = {n: getattr(controller, n) for n in ("tables", "table", "reversal", "velocity_filter")}
    parameters = {**controller.parameters, **values_of(compensator, made)}
    return Compensated(
        f"{controller.name}, compensated", law, parameters, **given, base=controller, compensator=compensator
    )


@lru_cache(maxsize=64)
def _law(base: Law, s: Structure) -> Law:
    def step(signals, z, p):
        seen = asked(s, signals, p)
        states, u = base.step(seen, z, p)
        after, force = forces(s, seen, z, p, u)
        return {**states, **after}, u + force

    def start(target, reading):
        own = base.start(target, reading) if base.start else {}
        return {**own, **{f"{PREFIX}_at_{at}": np.asarray(reading, dtype=float) for at in s.sides}}

    reads = dict.fromkeys(base.reads)
    for at in s.sides if s.source == READ else ():
        reads |= dict.fromkeys((f"{at}_y", f"{at}_vh") if at != "axis" else ())
    key = ", ".join(e.key for e in (*s.order, *s.maps) if e.name != DIRECTION and e.key not in s.silent)
    return replace(
        base,
        name=f"{base.name}; compensation of {key} ({s.source}, {s.delay} late{', low pass' * s.smooth})",
        parameters=(*base.parameters, *values_names(s)),
        step=step,
        states=(*base.states, *states_of(s)),
        start=start,
        reads=tuple(reads),
    )

"""The day's friction and gain: what one record's differ by from another's is no effect that a model lacks.

Oil, preload and the temperature of magnets differ from one record to the next, and no reference foretells by how much; yet a record is
known by its motion, so that an error in its level looks as if that motion foretold it. So does the bias that disturbances inside the loop
leave in a fit, which differs with what a record's motion is against them.
"""

import numpy as np

from workbench.identification.cross_validation import from_normal
from workbench.tracing.state import State

# Of the friction over all records, and of the drive, by which one record's may differ. The friction of two records of one robot axis on one
# day differs from their mean by 1.5 % (KR300, axis 1) and by 5 % (axis 3), that of other axes by 1 to 3 %; what differs by more changes.
# Halved or doubled, none of ten axes has another verdict.
LEVEL = 0.05


def without_the_days(state: State, residual: np.ndarray) -> list[np.ndarray]:
    """Return the residual of the drive (n,), record by record, without what its own level of the friction that is free, and of the drive, takes of
    it, each up to LEVEL.

    residual (N,): of all balances, stacked as the state's problem stacks them.
    """
    problem, solution = state.problem, state.solution
    rubs = [i for i, n in enumerate(problem.free_linear) if state.plant[n.key].family.startswith("friction")]
    friction = problem.drive_part(solution.phi[:, rubs] @ solution.c[rubs])
    left, own = problem.drive_part(residual), problem.drive_part(solution.residual)
    scale, found = problem.command_scale(state.plant), []
    for p, r, f, e in zip(state.inverses, left, friction, own, strict=True):
        drive = scale * p.motion.filter(p.motion.u)
        required = (drive if p.counts is None else np.where(p.counts[0], drive, 0.0))[p.motion.keep] - e
        columns = np.column_stack([f, required])
        room = np.full(2, LEVEL)
        found.append(r - columns @ from_normal(columns.T @ columns, columns.T @ r, -room, room))
    return found

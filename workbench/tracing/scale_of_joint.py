"""Loads of two masses, held against joints that carry as much.

The load's balance is of the joint's torque, and that is free: where errors of the deflection (a gear's wave, a gap, counts) are most of what is
left, a model gains by letting the joint carry little, with the motor's mass for the load's. So what a candidate leaves of the load's balance counts
as that of a joint that carries what the present one does, as a map of the command is held against commands (`Problem.command_scale`).
"""

import numpy as np

from workbench.identification.cross_validation import HeldOut
from workbench.identification.intervals import block_seconds
from workbench.identification.problem import Problem
from workbench.identification.solve import Solution

LEAST = 1e-9  # of the power that is carried, below which no joint is left to be scaled


def beside(
    present: tuple[Problem, Solution], problem: Problem, solution: Solution, errors: HeldOut
) -> tuple[HeldOut, float]:
    """Return (held-out errors, squared error) of a fit beside the present one, its loads as those of a joint that carries as much.

    errors: of the fit as it is. A joint that carries more stays what it is: the motor's balance holds it.
    """
    before, after = _carried(*present), _carried(problem, solution)
    if after >= before:
        return errors, solution.cost
    loads = np.zeros(solution.y.size)
    for rows in problem.load_rows:
        loads[rows] = solution.residual[rows] ** 2
    more = before / max(after, LEAST * before) - 1.0
    told = [float(loads[b].sum()) for b in problem.blocks(block_seconds(problem))]
    return HeldOut(errors.errors + more * np.array(told)), solution.cost + more * sum(told)


def _carried(problem: Problem, solution: Solution) -> float:
    """Return the power that the joint's forces of free linear parameters carry in the loads' balances, each record's about its mean, (N*m)^2 or N^2
    times samples; 0 of one mass, and where every load is locked."""
    own = [i for i, n in enumerate(problem.free_linear) if n.key.endswith("@joint")]
    if not own:
        return 0.0
    torques = (solution.phi[rows][:, own] @ solution.c[own] for rows in problem.load_rows)
    return sum(float(t.size * np.var(t)) for t in torques if t.size)

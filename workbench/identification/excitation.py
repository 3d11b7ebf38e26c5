"""Which parameters the records of a fit do not excite."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from workbench.definition import Effect
from workbench.identification.problem import Name, Problem
from workbench.identification.solve import Solution

FAINT = 0.5  # half width over value beyond which a parameter that stays below the noise is said to lack excitation
ABSENT, BELOW_NOISE, ONE_WAY, NO_REVERSAL = "absent", "below noise", "one way", "no reversal"


@dataclass(frozen=True, eq=False)
class Unexcited:
    """A free parameter that records do not excite, by one of four reasons.

    ABSENT: its column is zero. BELOW_NOISE: its part of the drive at its value, rms `contribution` (NaN of a shape parameter),
    stays below `noise`. ONE_WAY, NO_REVERSAL: its effect shows in the direction of motion. turns: reversals of the records.
    ways: in which they move, 0, 1 or 2.
    """

    effect: Effect
    parameter: str
    reason: str
    contribution: float
    noise: float
    turns: int
    ways: int


def unexcited(problem: Problem, solution: Solution, half: Mapping[Name, float], noise: float) -> list[Unexcited]:
    """Return which free parameters the records do not excite.

    A linear one: its column is zero; or the column at its value (the larger of declared and fitted) stays below the
    `noise`, the residual's rms, while its interval is wide or it has none. One of an effect with memory: no record
    reverses, or, of a linear one, all records together move one way.

    half: half widths of the 95 % intervals, of the parameters that have one.
    """
    turns, ways = _motion_of(problem)
    found = []
    for n in [*problem.free_linear, *problem.free_shape]:
        e, linear = problem.plant[n.key], n in problem.free_linear
        reason, share = _by_column(problem, solution, n, half, noise) if linear else ("", float("nan"))
        if not reason and _remembers(e):
            reason = (ONE_WAY if ways < 2 else "") if linear else (NO_REVERSAL if turns == 0 else "")
        if reason:
            found.append(Unexcited(e, n.parameter, reason, share, noise, turns, ways))
    return found


def _by_column(
    problem: Problem, solution: Solution, n: Name, half: Mapping[Name, float], noise: float
) -> tuple[str, float]:
    """Return (reason or "", rms of a linear parameter's part of the drive at its value)."""
    j = problem.free_linear.index(n)
    column, fitted = float(np.sqrt(np.mean(solution.phi[:, j] ** 2))), float(solution.c[j])
    share = column * max(abs(fitted), abs(problem.parameter(n).value))
    if column == 0.0:
        return ABSENT, share
    wide = half.get(n, np.inf) > FAINT * abs(fitted)
    return (BELOW_NOISE if 0.0 < share < noise and wide else ""), share


def _remembers(effect: Effect) -> bool:
    """Whether an effect acts through reversals of the motion: it sums increments up, or reads the direction."""
    return bool({"dq", "dir"} & set(effect.reads))


def _motion_of(problem: Problem) -> tuple[int, int]:
    """Return (reversals within the records, ways moved: 0, 1 or 2), of the position behind its dead band of a count."""
    turns, ways = 0, set()
    for p in problem.inverses:
        dq = p.motion.dq[p.motion.keep]
        way = np.sign(dq[dq != 0.0])
        turns += int(np.count_nonzero(np.diff(way)))
        ways |= set(way.tolist())
    return turns, len(ways)

"""What a search over the ladder asks of points of a family: figures, climbed as far as they decide, and what they cost."""

from dataclasses import dataclass

import numpy as np

from workbench.design.families.family import Family
from workbench.design.figures import FIGURES
from workbench.design.ladder import Ladder, climbed
from workbench.design.regret import References, cost, each, regret

BEYOND = 100.0  # what a point costs that |S| forbids
# Lanes of a part of the ladder, at least, after which points are given up that can cost less no more: each part is a call of its own. Half
# as many climb 3 % less, in more calls; no result depends on it.
TOGETHER = 1000
# Of the least that any member of a search leaves on a move, what no trial leaves less of on the average over all moves that it has not
# climbed. Six searches of the main study and two of the study of one mass end at the same numbers to the last bit as where only zeros bound.
# Of one of main, played again, 1.0 gives up none that was taken either; a bound by the references instead (0.8 of their time, 0.6 of their
# error) did: a table may leave less than they do.
LEAST = 0.9


@dataclass(frozen=True, eq=False)
class Tried:
    """points (p, numbers), figures (p, rungs, 2, 3), costs (p,): infinite of a point that was given up, whose figures are not all there."""

    points: np.ndarray
    figures: np.ndarray
    costs: np.ndarray


@dataclass(frozen=True, eq=False)
class Against:
    """Points of one family on a ladder, held against references. together: lanes of a part of the ladder, at least."""

    on: Ladder
    family: Family
    known: References
    together: int = TOGETHER

    def tried(
        self,
        points: np.ndarray,
        most: np.ndarray | float = np.inf,
        members: np.ndarray | None = None,
        rungs: np.ndarray | None = None,
    ) -> Tried:
        """Climb with points (p, numbers) as far as these may cost no more than `most`, one or (p,).

        members (m, all rungs, 2, 3): figures of points that are known. What cost them most is climbed first, and what they left at least
        is the least that is possible for what was not climbed: a cost falls with no figure, so with that it is the least that it can be,
        and a point beyond `most` is left there. rungs (r,): which are climbed, all where absent; of the others the figures are those
        of the first member.
        """
        on, most = self.on, np.broadcast_to(most, len(points))
        least = np.zeros((len(on.rungs), 2, 3)) if members is None else self._least(members)
        blocks = on.blocks  # of each rung, that are left
        found = np.zeros((len(points), len(on.rungs), 2, 3))
        if rungs is not None:
            found[:] = members[0]
            found[:, rungs] = 0.0
            blocks = np.where(np.isin(np.arange(len(on.rungs)), rungs), blocks, 0)
        beyond = self._beyond(points)
        left = np.flatnonzero(beyond <= most)
        for rung, block in self._parts(blocks, members, len(points)):
            might = np.where(blocks[:, None, None] > 0, np.maximum(found[left], least), found[left])
            left = left[cost(regret(on, might, self.known)) + beyond[left] <= most[left]]
            if not left.size:
                break
            new = climbed(on, self.family, points[left], *(np.tile(a, (left.size, 1)) for a in (rung, block)))
            np.maximum.at(found, (left[:, None], rung), new)
            blocks = blocks - np.bincount(rung, minlength=blocks.size)
        costs = np.full(len(points), np.inf)
        costs[left] = cost(regret(on, found[left], self.known)) + beyond[left]
        return Tried(points, found, costs)

    def costs(self, points: np.ndarray, figures: np.ndarray) -> np.ndarray:
        """Return what points with these figures cost, (p,)."""
        return cost(regret(self.on, figures, self.known)) + self._beyond(points)

    def _beyond(self, points: np.ndarray) -> np.ndarray:
        """Return what points (p,) cost for a sensitivity that is not allowed."""
        return np.where(self.family.sensitivity(points) > self.on.task.weights.sensitivity * 1.001, BEYOND, 0.0)

    def _least(self, members: np.ndarray) -> np.ndarray:
        """Return figures (rungs, 2, 3) that are the least that is possible on each move, where members have figures (m, rungs, 2, 3)."""
        low = LEAST * members.min(axis=0)
        low[..., FIGURES.index("overshoot")] = 0.0
        return np.where(np.isfinite(low), low, 0.0)

    def _parts(
        self, blocks: np.ndarray, members: np.ndarray | None, points: int
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return rungs (r,) and blocks of their phases, every first block before all others and before others what costs members most (the
        shortest where there are none), in parts of `together` lanes or more. blocks: how many of each rung are climbed."""
        on = self.on
        rung = np.repeat(np.arange(blocks.size), blocks)
        block = np.concatenate([np.arange(n) for n in blocks])
        dear = -on.samples if members is None else each(regret(on, members, self.known)).mean(axis=0)
        order = np.lexsort((-dear[rung], block > 0))
        rung, block = rung[order], block[order]
        before = np.cumsum(on.lanes(rung, block)[1]) * points
        cuts = np.flatnonzero(np.diff((before - 1) // self.together)) + 1
        return list(zip(np.split(rung, cuts), np.split(block, cuts), strict=True))

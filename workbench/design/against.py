"""What a search over the ladder asks of points of a family: figures, climbed as far as they decide, and what they cost."""

from dataclasses import dataclass

import numpy as np

from workbench.design.families.family import Family
from workbench.design.ladder import Ladder, climbed
from workbench.design.regret import References, cost, regret

BEYOND = 100.0  # what a point costs that |S| forbids
# Lanes of a part of the ladder, at least, after which points are given up that can cost less no more: with a third of it 4 % less is
# simulated in as much time, for each part is a call of its own. No result depends on it.
TOGETHER = 1500


@dataclass(frozen=True, eq=False)
class Tried:
    """points (p, numbers), figures (p, rungs, 2, 3), costs (p,)."""

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
        self, points: np.ndarray, most: np.ndarray | float = np.inf, rungs: np.ndarray | None = None, figures: np.ndarray | None = None
    ) -> Tried:  # fmt: skip
        """Climb with points (p, numbers) as far as these may cost no more than `most`, one or (p,).

        rungs (r,): which are climbed, all where absent; figures (all rungs, 2, 3): of the others. With zeros for what was not climbed a
        cost is the least that it can be, in floating point too, since it falls with no figure: a point beyond `most` is left there.
        """
        on = self.on
        rungs = np.arange(len(on.rungs)) if rungs is None else rungs
        found = np.zeros((len(points), len(on.rungs), 2, 3))
        if figures is not None:
            found[:] = figures
            found[:, rungs] = 0.0
        for rung, block in self._parts(rungs, len(points)):
            left = np.flatnonzero(cost(regret(on, found, self.known)) <= most)
            if not left.size:
                break
            new = climbed(on, self.family, points[left], *(np.tile(a, (left.size, 1)) for a in (rung, block)))
            np.maximum.at(found, (left[:, None], rung), new)
        return Tried(points, found, self.costs(points, found))

    def costs(self, points: np.ndarray, figures: np.ndarray) -> np.ndarray:
        """Return what points with these figures cost, (p,)."""
        beyond = self.family.sensitivity(points) > self.on.task.weights.sensitivity * 1.001
        return cost(regret(self.on, figures, self.known)) + np.where(beyond, BEYOND, 0.0)

    def _parts(self, rungs: np.ndarray, points: int) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return rungs (r,) and blocks of their phases, every first block before all others and the shortest rungs before longer ones, in
        parts of `together` lanes or more."""
        on = self.on
        rung = np.repeat(rungs, on.blocks[rungs])
        block = np.concatenate([np.arange(n) for n in on.blocks[rungs]])
        order = np.lexsort((on.samples[rung], block > 0))
        rung, block = rung[order], block[order]
        before = np.cumsum(on.lanes(rung, block)[1]) * points
        cuts = np.flatnonzero(np.diff((before - 1) // self.together)) + 1
        return list(zip(np.split(rung, cuts), np.split(block, cuts), strict=True))

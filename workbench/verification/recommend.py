"""Which controller to take: the least worst case among those that keep what was asked, with what is known of each beside it."""

from collections.abc import Mapping
from dataclasses import dataclass

from workbench.task.task import Task
from workbench.verification.candidates import Candidate, candidates
from workbench.verification.wording import recommendation


@dataclass(frozen=True, eq=False)
class Recommended:
    """name: of the controller to take. rows: every candidate, the best first. sentence: why."""

    name: str
    rows: tuple[Candidate, ...]
    sentence: str

    @property
    def row(self) -> Candidate:
        return self.rows[0]


def recommend(task: Task, tuned: Mapping[str, object], unit: str) -> Recommended:
    """Return which of the tuned controllers (name -> family, point, controller(lanes)) to take, and why. unit: of position, "rad" or "m"."""
    rows = candidates(task, tuned)
    return Recommended(rows[0].name, rows, recommendation(rows, unit))

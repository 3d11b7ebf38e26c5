"""The worst cases, kept with the exact draw of each, and replayed to the same bits."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.readers.files import regular
from workbench.robustness.cases import Cases
from workbench.robustness.document import number, of_work, work_of
from workbench.robustness.workload import KEPT, Block, Columns, Work
from workbench.simulation import Trajectories
from workbench.simulation.bodies import OUTPUT

FILE = "worst.json"
MOST_DRAWS = 2**31  # a seed is made of it


@dataclass(frozen=True, eq=False)
class Case:
    """One case of one controller. number: of the draw. values (k,): what varies, SI. metrics: name -> value."""

    controller: str
    number: int
    values: np.ndarray
    metrics: dict[str, float]


@dataclass(frozen=True, eq=False)
class Replayed:
    """A case run again. same: whether every metric has the same bits as when it was kept; metrics: those of now.
    trajectories: "q", "y", "u" (n, 1), of two masses "load.q" too. position (n,): what the target is about.
    """

    case: Case
    metrics: dict[str, float]
    same: bool
    trajectories: Trajectories
    position: np.ndarray
    target: float


def worst(cases: Cases, columns: Columns, count: int, by: str = "final_error") -> tuple[Case, ...]:
    """Return the cases with the largest `by` of each controller, the worst first; of equals the first drawn."""
    found = []
    for controller, metrics in columns.items():
        order = np.argsort(-np.nan_to_num(metrics[by], nan=np.inf), kind="stable")[:count]
        found += [
            Case(controller, int(i), cases.values[i], {n: float(metrics[n][i]) for n in KEPT}) for i in order
        ]  # fmt: skip
    return tuple(found)


def write(work: Work, found: tuple[Case, ...], path: Path) -> None:
    """Write cases and all that a replay needs."""
    names = [v.name for v in work.varied]
    content = of_work(work) | {
        "cases": [
            {
                "controller": c.controller,
                "draw": c.number,
                "values": dict(zip(names, c.values.tolist(), strict=True)),
                "metrics": {n: number(v) for n, v in c.metrics.items()},
            }
            for c in found
        ]
    }
    path.write_text(json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False) + "\n", encoding="utf-8")


def read(path: Path) -> tuple[Work, tuple[Case, ...]]:
    """Return the work and the cases of a file; WorkbenchError names it where it is missing or is none of ours."""
    try:
        content = json.loads(regular(path).read_text(encoding="utf-8"))
        work = work_of(content)
        names = [v.name for v in work.varied]
        cases = tuple(
            Case(
                c["controller"],
                _draw(c["draw"]),
                np.array([c["values"][n] for n in names], dtype=float),
                {n: float(c["metrics"][n]) for n in KEPT},
            )
            for c in content["cases"]
        )
        for c in cases:
            if c.controller not in work.controllers:
                raise WorkbenchError(
                    f"there is no controller '{c.controller}'; {nearest(str(c.controller), work.controllers)}"
                )
    except OSError as error:
        raise WorkbenchError(f"{path}: cannot be read ({error.strerror}); name a file of worst cases.") from error
    except (ValueError, KeyError, TypeError, OverflowError) as error:
        raise WorkbenchError(f"{path}: is not a file of worst cases ({error}); name one that a study wrote.") from error
    except WorkbenchError as error:
        raise WorkbenchError(f"{path}: {error}") from error
    return work, cases


def _draw(value: object) -> int:
    """Return the number of a draw; ValueError where no study draws so many."""
    found = int(value)
    if not 0 <= found < MOST_DRAWS:
        raise ValueError(f"draw {value} is none of 0 to {MOST_DRAWS - 1}")
    return found


def replay(work: Work, case: Case) -> Replayed:
    """Run one case again, alone, with its trajectory."""
    position = OUTPUT[work.task.plant.kind]
    block = Block(case.number, case.values[None, :])
    m = work.run(block, case.controller, tuple(dict.fromkeys(("q", "y", "u", position))))
    metrics = {n: float(getattr(m, n)[0]) for n in KEPT}
    same = all(_bits(metrics[n]) == _bits(case.metrics[n]) for n in KEPT)
    return Replayed(case, metrics, same, m.trajectories, m.trajectories[position][:, 0], float(work.task.step))


def _bits(value: float) -> bytes:
    return np.float64(value + 0.0).tobytes()  # one zero

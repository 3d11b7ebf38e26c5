"""What is run over the cases: a task, controllers by name, and what varies; a block of cases is one piece of work.

The same function runs a block on this machine and on a cluster's worker, and a case that is replayed is a block of one.
Lanes side by side, one lane alone and any number of threads give the same bits, so the numbers do too.
"""

import hashlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from workbench.compensation import Compensated
from workbench.control import Controller
from workbench.robustness.cases import Cases, Varied
from workbench.robustness.vary import applied, checked, extended
from workbench.simulation import Metrics, ScenarioArrays
from workbench.task.task import Task

BLOCK = 512  # cases a piece of work: a second's work or less, and enough of it to keep lanes and threads busy
KEPT = ("final_error", "time_1pct", "overshoot", "ripple")  # metrics of a case
PROBE = 32  # cases of a probe
PHASE = 0.5  # of the encoders, where it does not vary

Columns = dict[str, dict[str, np.ndarray]]  # controller -> metric -> (cases,)


@dataclass(frozen=True)
class Block:
    """first: number of its first case. values (n, k): what varies, SI."""

    first: int
    values: np.ndarray

    @property
    def count(self) -> int:
        return len(self.values)


@dataclass(frozen=True, eq=False)
class Work:
    """task: whose plant holds every effect that varies. controllers: name -> one that serves any number of lanes."""

    task: Task
    controllers: Mapping[str, Controller]
    varied: tuple[Varied, ...]

    def scenarios(self, block: Block, fields: dict[str, np.ndarray]) -> ScenarioArrays:
        """Return one lane a case: the task's step without further load, at this noise, with what the draws say."""
        own = {"noise": self.task.noise, "phase": PHASE} | fields
        return ScenarioArrays(
            block.count, target=self.task.step, seed=1 + block.first + np.arange(block.count), **own
        )  # fmt: skip

    def run(self, block: Block, controller: str, record=(), every: int = 1, threads: int | None = None) -> Metrics:
        """Return the metrics of one controller over a block."""
        plants, fields = applied(self.task.plant, self.varied, block.values)
        return self._run(plants, self.scenarios(block, fields), controller, record, every, threads)

    def _run(self, plants, scenarios, controller, record=(), every=1, threads=None) -> Metrics:
        on = self.task.on(plants)
        return on.run(self.controllers[controller], scenarios, record, every, threads)

    def columns(self, block: Block, threads: int | None = None) -> Columns:
        """Return the kept metrics of every controller over a block."""
        plants, fields = applied(self.task.plant, self.varied, block.values)
        scenarios = self.scenarios(block, fields)
        names, out = list(self.controllers), {}
        # Each block begins with another one, so that processes compile other kernels and not all the same.
        turn = block.first % max(len(names), 1)
        for name in names[turn:] + names[:turn]:
            m = self._run(plants, scenarios, name, threads=threads)
            out[name] = {k: np.asarray(getattr(m, k), dtype=float) for k in KEPT}
        return {name: out[name] for name in names}


def single(controller: Controller) -> Controller:
    """Return a controller of one lane as one for any number of lanes."""
    more = {"base": single(controller.base)} if isinstance(controller, Compensated) else {}
    values = {n: float(np.ravel(v)[0]) for n, v in controller.parameters.items()}
    tables = controller.tables
    if tables:
        tables = (tables[0 if controller.table is None else int(controller.table[0])],)
    filtered = controller.velocity_filter
    filtered = None if filtered is None else float(np.ravel(filtered)[0])
    return replace(controller, parameters=values, tables=tables, table=None, velocity_filter=filtered, **more)


def work(task: Task, factories: Mapping[str, Callable[[int], Controller]], varied: Iterable[Varied]) -> Work:
    """Return the work of a task. factories: controller name -> factory(lanes), as workbench.verification.compare takes them.

    Raises WorkbenchError for a name that does not exist or a distribution beyond what is physical.
    """
    varied = tuple(varied)
    checked(task.plant, varied)
    plant = extended(task.plant, varied)
    return Work(task.on(plant), {n: single(make(1)) for n, make in factories.items()}, varied)


def blocks(cases: Cases, size: int = BLOCK) -> list[Block]:
    """Return the cases in blocks. How they are cut changes no number."""
    return [Block(i, cases.values[i : i + size]) for i in range(0, cases.count, size)]


def joined(parts: Iterable[Columns]) -> Columns:
    """Return the columns of blocks, given in their order, as those of all cases."""
    parts = list(parts)
    return {c: {k: np.concatenate([p[c][k] for p in parts]) for k in parts[0][c]} for c in parts[0]}


def digest(columns: Columns) -> str:
    """sha256 over the bits of every number; of zeros there is one."""
    total = hashlib.sha256()
    for controller, metrics in columns.items():
        for name, values in metrics.items():
            total.update(f"{controller} {name} ".encode() + np.asarray(values + 0.0, dtype="<f8").tobytes())
    return total.hexdigest()


def probe(given: Work, block: Block) -> str:
    """Return the digest of a block's first cases: two machines whose probes are the same give the same numbers."""
    return digest(given.columns(Block(block.first, block.values[:PROBE]), threads=1))

"""The ladder of moves by which a gain table is judged: steps of many sizes, a slow sine across zero speed, a step of load.

Each rung runs one size one way, without or with a constant load: held at rest while the load comes on, then the step, then the
step back, which begins after a reversal. A move is one of these steps; its figures are about its own final value, the middle of what
it ends in, and the error is against the command. The band is 1 % of the step, or two counts where that is more: no controller
rests within less.
"""

from dataclasses import dataclass, replace

import numpy as np

from workbench.design.families.family import Family
from workbench.design.figures import FIGURES, step_figures
from workbench.simulation import ScenarioArrays, followed
from workbench.task.task import Task

SIZES, LEAST = 9, 10.0  # sizes, even in the logarithm, from so many counts to the study's own step
SHARE = 1e-5  # of the step: the smallest size where the encoder has no counts
HOLD = 0.06  # s, at rest before the first step under a load: its deflection dies out in a third of it
UNLOADED = 2  # samples, without one
REST, LASTS = 0.1, 1.5  # s, and of the time-optimal bound: how long each step is given
SINE, PERIOD = (
    10.0,
    1.0,
)  # amplitude over the smallest step, and s: slow enough that friction, not inertia, sets the error
LOAD = 0.05  # of the drive's limit: the load, where a study states none
# Steps of up to FEW counts are met at PHASES phases of the encoder, beyond at one. With one alone a reference for a step of ten
# counts is tuned to one landing: of three searches on the main study the worst then cost 16 % more than the best, with four 4 %.
PHASES, FEW = 4, 200.0
# Where gains of a short step serve that step alone (the rule "closing"), a table keeps up with what is tuned to its landings on the plant
# that it was tuned on, and on no other: with sixteen, four tables of the single mass come to 1.11 to 1.20 times their references' time on
# the assumed plant, with thirty-two to no less in half as much time again. Where the same gains end longer steps (the rule "error")
# sixteen take twice the time and part the searches of the main study by 5 %, as four do.
LANDING = 16
# Lanes of a run, about: half or twice as many take as long; with all of a search at once memory is what costs.
AT_ONCE = 3000
# By which friction and inertia are off at every phase but the first, at most: what is tuned to landings on exactly one plant meets others on the
# next. Judged on other landings of its own plant, tables of three searches of the single mass come to regrets in time of 1.50, 1.24 and 1.45
# without it, to 1.22, 1.27 and 1.19 with 0.02; to 1.33, 1.38 and 1.33 with half, to 1.19, 1.24 and 1.49 with twice as much.
OFF = 0.02
# As many landings as a search knows, times this, that it does not know, say which of its runs is the best; climbed by three points, they cost
# next to nothing.
OTHERS = 4
BLOCK = 4  # phases of a rung that are climbed together by what may be given up: half or twice as many take as long
GOLDEN, ROOTS = 0.6180339887498949, (0.4142135623730951, 0.7320508075688772)  # of low-discrepancy sequences


@dataclass(frozen=True)
class Move:
    """kind: "step", "sine" or "load". size: signed, rad or m. load: torque or force against positive motion. history: "rest",
    "reversal" """

    kind: str
    size: float
    load: float
    history: str = "rest"


@dataclass(frozen=True, eq=False)
class Ladder:
    """rungs: each the two moves of a run, or one. scenarios: factors (friction, inertia), the first nominal. task: plant, loop.

    half (rungs,): samples of each step. met: encoder phases of steps up to FEW counts. past: how many phases of the sequence are left out.
    """

    task: Task
    rungs: tuple[tuple[Move, ...], ...]
    scenarios: tuple[tuple[float, float], ...]
    half: np.ndarray
    met: int = PHASES
    past: int = 0

    @property
    def elsewhere(self) -> "Ladder":
        """The same moves at OTHERS times as many phases, none of which is one of this ladder's."""
        return replace(self, met=OTHERS * self.met, past=self.past + self.met)

    def at_landings(self, share: int) -> "Ladder":
        """Return the same moves at one of `share` of its phases, the first ones."""
        return replace(self, met=max(self.met // share, 1))

    @property
    def moves(self) -> tuple[Move, ...]:
        return tuple(m for rung in self.rungs for m in rung)

    @property
    def sizes(self) -> np.ndarray:
        """Sizes of the steps, (n,), rising."""
        return np.unique([abs(r[0].size) for r in self.rungs if r[0].kind == "step"])

    @property
    def hold(self) -> np.ndarray:
        """Samples before the first step, (rungs,): without a load nothing moves until then."""
        loaded = int(round(HOLD / self.task.loop.sample_time))
        return np.array([loaded if r[0].load else UNLOADED for r in self.rungs])

    @property
    def samples(self) -> np.ndarray:
        """Samples of each rung, (rungs,)."""
        return self.hold + 2 * self.half

    @property
    def rows(self) -> np.ndarray:
        """Number of each rung's first move, (rungs,)."""
        return np.concatenate([[0], np.cumsum([len(r) for r in self.rungs])[:-1]])

    @property
    def phases(self) -> np.ndarray:
        """Encoder phases that each rung is met at, (rungs,)."""
        few = FEW * self.task.loop.count
        return np.array([self.met if r[0].kind == "step" and abs(r[0].size) < few else 1 for r in self.rungs])

    @property
    def blocks(self) -> np.ndarray:
        """Blocks of BLOCK phases, or fewer, that each rung has, (rungs,)."""
        return -(-self.phases // BLOCK)

    def lanes(self, rung: np.ndarray, block: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return the first lane and how many lanes a point takes on rungs (n,), in one block (n,) of their phases or in all."""
        corners, phases = len(self.scenarios), self.phases[rung]
        if block is None:
            return 0 * rung, corners * phases
        return corners * BLOCK * block, corners * np.minimum(phases - BLOCK * block, BLOCK)

    def reference(self, rung: int, samples: int) -> np.ndarray:
        """Return the command over so many samples: to the size, and back."""
        move, t, hold = self.rungs[rung][0], np.arange(samples), self.hold[rung]
        if move.kind == "sine":
            return move.size * np.sin(2 * np.pi / PERIOD * self.task.loop.sample_time * np.maximum(t - hold, 0))
        if move.kind == "load":
            return np.zeros(samples)
        return np.where((t >= hold) & (t < hold + self.half[rung]), move.size, 0.0)


def ladder(
    task: Task, load: float | None = None, *, scenarios=None, sizes: int = SIZES, phases: int = PHASES
) -> Ladder:
    """Return the ladder of a task: its sizes both ways, without and with the load, a sine and a step of load.

    load: N*m or N; LOAD of the drive's limit where absent. scenarios: the corners of the task's frictions and inertias, and
    the nominal plant, where absent. phases: of the encoder, at which steps up to FEW counts are met.
    """
    load = LOAD * task.plant.limits.drive if load is None else load
    least = LEAST * task.loop.count or SHARE * task.step
    rungs, half = [], []

    def samples(size: float) -> int:
        return int(round((REST + LASTS * replace(task, step=size).bound()) / task.loop.sample_time))

    for size in np.geomspace(least, task.step, sizes):
        long = samples(float(size))
        for way in (1.0, -1.0):
            for torque in (0.0, load):
                rungs.append((Move("step", way * size, torque), Move("step", -way * size, torque, "reversal")))
                half.append(long)
    rungs += [(Move("load", 0.0, load),), (Move("sine", SINE * least, 0.0),)]
    half += [samples(least), int(round(PERIOD / 2.0 / task.loop.sample_time))]
    return Ladder(task, tuple(rungs), scenarios or corners(task), np.array(half), phases)


def corners(task: Task) -> tuple[tuple[float, float], ...]:
    """Return the nominal plant and the corners of the task's factors of friction and inertia."""
    ends = ((min(v), max(v)) for v in (task.frictions, task.inertias))
    frictions, inertias = (tuple(dict.fromkeys(e)) for e in ends)
    return tuple(dict.fromkeys(((1.0, 1.0), *((f, i) for f in frictions for i in inertias))))


def timed(on: Ladder) -> np.ndarray:
    """Return which moves have a time, (rungs, 2)."""
    return np.array([[moves[0].kind == "step"] * 2 for moves in on.rungs])


def all_rungs(on: Ladder, points: np.ndarray) -> np.ndarray:
    """Return (p, rungs): every point (p, numbers) on every rung."""
    return np.tile(np.arange(len(on.rungs)), (len(points), 1))


def climbed(
    on: Ladder, family: Family, points: np.ndarray, rungs: np.ndarray, blocks: np.ndarray | None = None, follow=followed
) -> np.ndarray:
    """Return figures (points, rungs a point, 2 moves, 3 FIGURES) of points (p, numbers), each on rungs (p, r), the worst over
    the scenarios; of a rung of one move the second is that move again. Infinite where it does not come to rest.

    blocks (p, r): which BLOCK of a rung's phases alone is climbed; all where absent. follow: what closes the loop, as `followed`."""
    rung, point = rungs.ravel(), np.repeat(np.arange(len(points)), rungs.shape[1])
    first, lanes = on.lanes(rung, None if blocks is None else blocks.ravel())
    out = np.empty((rung.size, 2, len(FIGURES)))
    order = np.lexsort((point, rung, on.samples[rung]))
    before = np.cumsum(lanes[order])
    for part in np.split(order, np.flatnonzero(np.diff((before - 1) // AT_ONCE)) + 1):
        out[part] = _climbed(on, family, points, point[part], rung[part], first[part], lanes[part], follow)
    return out.reshape(*rungs.shape, 2, len(FIGURES))


def _climbed(
    on: Ladder, family: Family, points: np.ndarray, point: np.ndarray, rung: np.ndarray, first: np.ndarray, lanes: np.ndarray, follow
) -> np.ndarray:  # fmt: skip
    """Return figures (n, 2, 3) of points[point], each on one rung, in so many lanes from the first on; point, rung, first, lanes (n,), by
    rung and rungs of like duration together."""
    begin = np.cumsum(lanes) - lanes
    pair = np.repeat(np.arange(rung.size), lanes)
    each, k = rung[pair], np.arange(pair.size) + (first - begin)[pair]
    friction, inertia = np.array(on.scenarios).T[:, k % len(on.scenarios)]
    load = np.array([moves[0].load for moves in on.rungs])[each]
    at = each + k + on.past * len(on.scenarios)
    phase, *factors = ((0.5 + a * at) % 1.0 for a in (GOLDEN, *ROOTS))
    friction, inertia = (
        v * np.where(k < len(on.scenarios), 1.0, np.exp(OFF * (2.0 * u - 1.0)))
        for v, u in zip((friction, inertia), factors, strict=True)
    )
    scenarios = ScenarioArrays(each.size, phase=phase, friction=friction, inertia=inertia, load=load)
    every, which = np.unique(each, return_inverse=True)
    samples = on.samples[every]
    known = np.stack([on.reference(r, int(samples.max())) for r in every], axis=1)
    used, at = np.unique(point, return_inverse=True)
    controller = family.controller(points[used], 1).taken(at[pair])
    q = follow(on.task.plant, on.task.loop, controller, scenarios, known, which, on.samples[each])
    out = np.empty((each.size, 2, len(FIGURES)))
    ends = np.append(np.flatnonzero(np.diff(each)) + 1, each.size)
    for start, end in zip([0, *ends[:-1]], ends, strict=True):
        r = int(each[start])
        out[start:end] = _figures_of(on, r, q[: on.samples[r], start:end])
    return np.maximum.reduceat(out, begin, axis=0)


def _figures_of(on: Ladder, rung: int, q: np.ndarray) -> np.ndarray:
    """Return figures (n, 2, 3) of positions q (samples, n) of one rung."""
    moves, hold, half = on.rungs[rung], int(on.hold[rung]), int(on.half[rung])
    if moves[0].kind != "step":
        first = hold + half // 2 if moves[0].kind == "sine" else 0  # what the start of a sine leaves has died out
        left = np.max(np.abs(q[first:] - on.reference(rung, len(q))[first:, None]), axis=0)
        left = np.where(np.isfinite(left), left, np.inf)
        return np.broadcast_to(np.stack([0.0 * left, left, 0.0 * left], axis=1)[:, None], (left.size, 2, 3))
    count, dt = on.task.loop.count, on.task.loop.sample_time
    parts = (q[hold - 1 : hold + half], moves[0].size), (q[hold + half - 1 : hold + 2 * half], 0.0)
    sizes = (m.size for m in moves)
    return np.stack(
        [step_figures(part, target, size, count, dt) for (part, target), size in zip(parts, sizes, strict=True)], axis=1
    )

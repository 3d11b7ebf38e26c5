"""The loop closed with what was found: the same cascade tuned on the declared and on the extended plant, and what differs.

Nothing is known of the bench's controller, so a loop is assumed: position P over velocity PI at the rate of the record, one
sample of delay, one of velocity filter, the record's encoder (of two masses the motor's, and the load is asked for the
step). The extended plant stands for the axis. What the declared model promises, and what gains tuned on it come to there,
is the price of what it lacks.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from workbench.cancellation.closed import Cancelled, cancelled, causes, take
from workbench.control import Controller
from workbench.description.friction import friction_of
from workbench.design.families.family import Family, cascade_family
from workbench.design.optimise import Tuned, optimise_all
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.record import Record
from workbench.simulation import Loop, Metrics, ScenarioArrays, simulate
from workbench.simulation.recorded import temperature_of
from workbench.task.task import PHASES, Task
from workbench.verification.assumed import judge, late, loop_of, task_of

DECLARED, EXTENDED = "declared", "extended"
FIGURES = ("rise", "time_1pct", "overshoot", "final_error")
TURNOVER = 0.2  # of the velocity loop, over its delays: where the search begins
RISE = (0.1, 0.9)  # shares of the step
OUTPUT = {ONE_MASS: "q", TWO_MASS: "load.q"}


@dataclass(frozen=True)
class Response:
    """A step under gains tuned on one model, run on another; the worst over encoder phases, SI.

    rise: s from 10 % to 90 %. time_1pct: s into 1 % to stay. overshoot: share of the step. final_error: in the last window.
    """

    tuned_on: str
    run_on: str
    rise: float
    time_1pct: float
    overshoot: float
    final_error: float


@dataclass(frozen=True)
class Followed:
    """A record's reference followed under the same gains, tuned on the declared model.

    position: rms of the motion of the declared plant less that of the extended one; drive: the same, over the rms of the
    drive. largest: tuned on -> largest |r - q| on the extended plant.
    """

    record: str
    position: float
    drive: float
    largest: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """responses: declared on declared (what is promised), declared on extended, extended on extended. time (n,) and
    signals[tuned_on, run_on] = (q, u), (n,) each, of one of the phases. gains: tuned on -> name -> value, SI."""

    loop: Loop
    start: float
    step: float
    gains: Mapping[str, Mapping[str, float]]
    responses: tuple[Response, ...]
    followed: Followed | None
    time: np.ndarray
    signals: Mapping[tuple[str, str], tuple[np.ndarray, np.ndarray]]
    cancelled: Cancelled | None = None

    @property
    def promised(self) -> Response:
        """What the declared model promises: tuned and run on it."""
        return self.responses[0]

    @property
    def tuned_on_declared(self) -> Response:
        """What becomes of it on the extended plant."""
        return self.responses[1]

    @property
    def tuned_on_extended(self) -> Response:
        """Tuned and run on the extended plant."""
        return self.responses[2]

    @property
    def change(self) -> dict[str, float]:
        """What tuning on the extended plant instead of the declared one changes on the extended plant, SI."""
        return {n: getattr(self.tuned_on_extended, n) - getattr(self.tuned_on_declared, n) for n in FIGURES}


def _family_of(task: Task) -> Family:
    """Return the cascades among which the one for the plant of a task is sought."""
    plant, loop = task.plant, task.loop
    _, inertia, _ = friction_of(plant)
    known = Loop(**{**vars(loop), "delay": loop.delay + late(plant)})
    linear = judge(plant, known, task.step)
    turnover = TURNOVER / (loop.sample_time + known.delay + loop.velocity_filter)
    start = (turnover / 4, inertia * turnover, inertia * turnover**2 / 20)
    fastest = min(plant.limits.speed, float(np.sqrt(2 * plant.limits.drive * task.step / inertia)))
    return cascade_family(linear, start, fastest)


def _tuned(tasks: Sequence[Task]) -> list[Tuned]:
    """Return the cascade tuned on the plant of each task."""
    return list(optimise_all([(task, _family_of(task), 1) for task in tasks]))


def rise_of(time: np.ndarray, q: np.ndarray, start: float, target: np.ndarray) -> np.ndarray:
    """Return the time from 10 % to 90 % of the step, (lanes,); infinite where 90 % is not reached."""
    share = (q - start) / (target - start)
    first, last = (_crossing(time, share, level) for level in RISE)
    return last - first


def _crossing(time: np.ndarray, share: np.ndarray, level: float) -> np.ndarray:
    """Return when each lane of share (n, lanes) first reaches a level, linear between samples; infinite for never."""
    k = np.maximum(np.argmax(share >= level, axis=0), 1)
    after, before = (np.take_along_axis(share, i[None, :], axis=0)[0] for i in (k, k - 1))
    with np.errstate(all="ignore"):
        at = time[k - 1] + (level - before) / (after - before) * (time[k] - time[k - 1])
    return np.where(share.max(axis=0) >= level, at, np.inf)


def _responded(task: Task, one: Tuned, names: tuple[str, str]) -> tuple[Response, Metrics]:
    """Return the step of a task under tuned gains. names: tuned on, run on."""
    scenarios = task.scenarios(phases=PHASES)
    m = task.run(one.controller(scenarios.lanes), scenarios, (OUTPUT[task.plant.kind], "u"))
    rise = rise_of(
        m.trajectories.time, m.trajectories[OUTPUT[task.plant.kind]], task.start, np.asarray(scenarios.target)
    )
    worst = (float(np.max(x)) for x in (rise, m.time_1pct, m.overshoot, m.final_error))
    return Response(*names, *worst), m


def _following(plants: Sequence[Plant], record: Record, loop: Loop, controllers: Sequence[Controller]) -> Followed:
    """Return what both plants make of a record's reference. plants, controllers: declared and extended."""
    reference, output = record.channels["reference"], OUTPUT[plants[0].kind]
    one = ScenarioArrays(1, start=float(reference[0]))

    def run(plant: Plant, controller: Controller) -> Metrics:
        duration = reference.size * loop.sample_time
        warm = temperature_of(plant, record)
        return simulate(
            plant, loop, controller, one, duration, (output, "u"), reference=reference, temperature=warm, lanes=1
        )

    declared, extended, tuned_on_extended = (run(plants[p], controllers[c]) for p, c in ((0, 0), (1, 0), (1, 1)))
    (q, u), (q1, u1) = ((m.trajectories[output], m.trajectories["u"]) for m in (declared, extended))
    largest = {DECLARED: float(extended.following_error[0]), EXTENDED: float(tuned_on_extended.following_error[0])}
    with np.errstate(all="ignore"):
        position = float(np.sqrt(np.mean((q - q1) ** 2)))
        drive = float(np.linalg.norm(u - u1) / np.linalg.norm(u1))
    return Followed(record.name, position, drive, largest)


def close(declared: Plant, extended: Plant, record: Record) -> ClosedLoop:
    """Return the loop of a record's axis with the declared and with the extended plant, tuned on each.

    Needs a limit of the drive (see `closing.lacking`). Raises WorkbenchError for a plant without forward dynamics.
    """
    loop = loop_of(record)
    tasks = {DECLARED: replace(task_of(declared, record, loop), lanes=PHASES)}
    tasks[EXTENDED] = tasks[DECLARED].on(extended)
    made = dict(zip(tasks, _tuned(list(tasks.values())), strict=True))
    pairs = ((DECLARED, DECLARED), (DECLARED, EXTENDED), (EXTENDED, EXTENDED))
    responses, signals = [], {}
    for names in pairs:
        response, m = _responded(tasks[names[1]], made[names[0]], names)
        responses.append(response)
        signals[names] = tuple(m.trajectories[n][:, 0] for n in (OUTPUT[extended.kind], "u"))
        time = m.trajectories.time
    followed = None
    if "reference" in record.channels:
        followed = _following((declared, extended), record, loop, [made[n].controller() for n in tasks])
    gains = {name: one.numbers for name, one in made.items()}
    task = tasks[DECLARED]
    compensation = _compensated(declared, tasks[EXTENDED], made[DECLARED], record)
    return ClosedLoop(loop, task.start, task.step, gains, tuple(responses), followed, time, signals, compensation)


def _compensated(declared: Plant, task: Task, one: Tuned, record: Record) -> Cancelled | None:
    """Return what cancelling the causes is worth under gains tuned on the declared plant; None where none can be."""
    can, left = causes(declared, task.plant)
    if not can:
        return None
    return cancelled(task, one.controller, can, left, rise_of, PHASES, record.channels.get("reference"))


def as_dict(closed: ClosedLoop) -> dict:
    """Return what trace.json holds of a closed loop, SI; infinite times (a loop that does not settle) are None."""

    def number(x: float) -> float | None:
        return x if isfinite(x) else None

    def plain(one: Mapping[str, object]) -> dict:
        return {n: number(x) if isinstance(x, float) else x for n, x in one.items()}

    def compensation(closed: ClosedLoop) -> dict | None:
        found = closed.cancelled
        if found is None:
            return None
        figures = [{"gain": g, **plain(v)} for g, v in found.figures.items()]
        advice = take(vars(closed.tuned_on_declared), vars(closed.tuned_on_extended), found)
        return {"effects": list(found.effects), "left": list(found.left), "figures": figures, "take": advice}

    followed = closed.followed
    return {
        "loop": plain(vars(closed.loop)),
        "step": {"start": closed.start, "size": closed.step},
        "controller": "position P over velocity PI",
        "gains": {name: dict(values) for name, values in closed.gains.items()},
        "responses": [plain(vars(r)) for r in closed.responses],
        "change": plain(closed.change),
        "compensation": compensation(closed),
        "followed": plain(vars(followed)) | {"largest": plain(followed.largest)} if followed else None,
    }

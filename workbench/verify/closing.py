"""The loop closed with what was found: the same cascade tuned on the declared and on the extended plant, and what differs.

Nothing is known of the bench's controller, so a loop is assumed: position P over velocity PI at the rate of the record, one
sample of delay, one of velocity filter, the record's encoder (of two masses the motor's, and the load is asked for the
step). The extended plant stands for the axis. What the declared
model promises of it, and what gains tuned on it come to there, is the price of what it lacks.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, isfinite

import numpy as np

from workbench.control import Controller
from workbench.effect import FORCE
from workbench.errors import WorkbenchError
from workbench.plant import ONE_MASS, SENSORS, TWO_MASS, Plant
from workbench.record import Record
from workbench.simulate import Loop, Metrics, ScenarioArrays, simulate
from workbench.verify.equivalent import equivalent_of, friction_of
from workbench.verify.families import cascade_family
from workbench.verify.linear import Judge, Linear, TwoMasses
from workbench.verify.optimise import Tuned, optimise
from workbench.verify.task import Task

DECLARED, EXTENDED = "declared", "extended"
FIGURES = ("rise", "time_1pct", "overshoot", "final_error")
SUBSTEP = 2.5e-4  # s, at most
STROKE = 0.5  # of the record's travel, that the step goes, from a quarter of it on
LASTS, REST = 5.0, 0.3  # of the time-optimal bound, and s beside, that a step is simulated for
TURNOVER = 0.2  # of the velocity loop, over its delays: where the search begins
COUNTS = 10.0  # of the amplitude at which presliding is described
RISE = (0.1, 0.9)  # shares of the step
OUTPUT = {ONE_MASS: "q", TWO_MASS: "load.q"}
PHASES = 8  # of the encoder, that a row is the worst of


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
class Closed:
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

    @property
    def promised(self) -> Response:
        """What the declared model promises: tuned and run on it."""
        return self.responses[0]

    @property
    def blind(self) -> Response:
        """What becomes of it on the extended plant."""
        return self.responses[1]

    @property
    def knowing(self) -> Response:
        """Tuned and run on the extended plant."""
        return self.responses[2]

    @property
    def change(self) -> dict[str, float]:
        """What tuning on the extended plant instead of the declared one changes on the extended plant, SI."""
        return {n: getattr(self.knowing, n) - getattr(self.blind, n) for n in FIGURES}


def lacking(plant: Plant, record: Record | None) -> str:
    """Return what a campaign lacks for its loop to be closed, as a sentence; "" where it lacks nothing."""
    if record is None:
        return "The loop is not closed: the campaign has no record to take a motion from."
    if not friction_of(plant)[1] > 0.0:
        return "The loop is not closed: the declared model has no inertia, so no gains can be tuned for it."
    if not isfinite(plant.limits.drive):
        return (
            "The loop is not closed: the campaign states no limit of the drive, and without one the fastest gains are "
            "infinite; state actuator_limit (and speed_limit) in campaign.toml."
        )
    return ""


def loop_of(record: Record) -> Loop:
    """Return the loop that is assumed at the rate of a record."""
    dt, counts = record.dt, (record.resolution.get(s, 0.0) for s in SENSORS)
    return Loop(dt, max(2, ceil(dt / SUBSTEP - 1e-9)), dt, dt, *counts)


def task_of(plant: Plant, record: Record, loop: Loop) -> Task:
    """Return the step that gains are tuned for: half of the record's travel, in the middle of it."""
    q = record.channels[SENSORS[plant.kind == TWO_MASS]]
    travel = float(np.ptp(q))
    task = Task(plant, loop, STROKE * travel, 1.0, start=float(q.min()) + (1.0 - STROKE) / 2 * travel)
    duration = LASTS * task.bound() + REST
    return Task(plant, loop, task.step, duration, start=task.start)


def late(plant: Plant) -> float:
    """Return by how much the plant's own command is late, s: its delay and its lag."""
    parameters = [p for e in plant.effects if e.at == "command" for p in e.parameters.items()]
    return float(sum(p.value for n, p in parameters if n in ("delay", "time_constant")))


def judge(plant: Plant, loop: Loop, step: float) -> Judge:
    """Return the linearisations that the gains must be robust on: sliding, and presliding at its stiffest.

    With two masses, the joint without and with what its friction adds near rest.
    """
    least = COUNTS * loop.resolution or 1e-5 * step
    omega = 1.0 / loop.sample_time / COUNTS
    if plant.kind == ONE_MASS:
        friction, inertia, viscous = friction_of(plant)
        spring = float(equivalent_of(friction, [least], [omega], loop.resolution).stiffness.max())
        return Linear(loop, inertia, max(viscous, 0.0), np.array([0.0, spring]))
    joint = equivalent_of(joint_alone(plant), [least, 1e3 * least], [omega, omega], loop.resolution)
    masses = {e.at: e.parameters["inertia"].value for e in plant.effects if e.name == "inertia"}
    if not ({"motor", "load"} <= set(masses) and joint.stiffness.min() > 0.0):
        raise WorkbenchError("a plant of two masses needs both inertias and a joint with a stiffness to be tuned for.")
    damping = sum(e.parameters["damping"].value for e in plant.effects if e.key == "linear_damping@joint")
    return TwoMasses(loop, masses["motor"], np.full(2, masses["load"]), joint.stiffness, float(damping))


def joint_alone(plant: Plant) -> Plant:
    """Return the forces of the joint on an axis of their own."""
    forces = [e for e in plant.effects if e.at == "joint" and e.port == FORCE]
    return Plant(ONE_MASS, tuple(replace(e, at="axis", places=("axis",)) for e in forces), plant.rotary, plant.geometry)


def tuned(task: Task) -> Tuned:
    """Return the cascade tuned on the plant of a task."""
    plant, loop = task.plant, task.loop
    _, inertia, _ = friction_of(plant)
    known = Loop(**{**vars(loop), "delay": loop.delay + late(plant)})
    linear = judge(plant, known, task.step)
    turnover = TURNOVER / (loop.sample_time + known.delay + loop.velocity_filter)
    start = (turnover / 4, inertia * turnover, inertia * turnover**2 / 20)
    fastest = min(plant.limits.speed, float(np.sqrt(2 * plant.limits.drive * task.step / inertia)))
    return optimise(task, cascade_family(linear, start, fastest))


def rise_of(time: np.ndarray, q: np.ndarray, start: float, target: np.ndarray) -> np.ndarray:
    """Return the time from 10 % to 90 % of the step, (lanes,); infinite where 90 % is not reached."""
    share = (q - start) / (target - start)
    first, last = (crossing(time, share, level) for level in RISE)
    return last - first


def crossing(time: np.ndarray, share: np.ndarray, level: float) -> np.ndarray:
    """Return when each lane of share (n, lanes) first reaches a level, linear between samples; infinite for never."""
    k = np.maximum(np.argmax(share >= level, axis=0), 1)
    after, before = (np.take_along_axis(share, i[None, :], axis=0)[0] for i in (k, k - 1))
    with np.errstate(all="ignore"):
        at = time[k - 1] + (level - before) / (after - before) * (time[k] - time[k - 1])
    return np.where(share.max(axis=0) >= level, at, np.inf)


def responded(task: Task, one: Tuned, names: tuple[str, str]) -> tuple[Response, Metrics]:
    """Return the step of a task under tuned gains. names: tuned on, run on."""
    scenarios = task.scenarios(phases=PHASES)
    m = task.run(one.controller(scenarios.lanes), scenarios, (OUTPUT[task.plant.kind], "u"))
    rise = rise_of(
        m.trajectories.time, m.trajectories[OUTPUT[task.plant.kind]], task.start, np.asarray(scenarios.target)
    )
    worst = (float(np.max(x)) for x in (rise, m.time_1pct, m.overshoot, m.final_error))
    return Response(*names, *worst), m


def following(plants: Sequence[Plant], record: Record, loop: Loop, controllers: Sequence[Controller]) -> Followed:
    """Return what both plants make of a record's reference. plants, controllers: declared and extended."""
    reference, output = record.channels["reference"], OUTPUT[plants[0].kind]
    one = ScenarioArrays(1, start=float(reference[0]))

    def run(plant: Plant, controller: Controller) -> Metrics:
        duration = reference.size * loop.sample_time
        return simulate(plant, loop, controller, one, duration, (output, "u"), reference=reference)

    declared, extended, knowing = (run(plants[p], controllers[c]) for p, c in ((0, 0), (1, 0), (1, 1)))
    (q, u), (q1, u1) = ((m.trajectories[output], m.trajectories["u"]) for m in (declared, extended))
    largest = {DECLARED: float(extended.following_error[0]), EXTENDED: float(knowing.following_error[0])}
    with np.errstate(all="ignore"):
        position = float(np.sqrt(np.mean((q - q1) ** 2)))
        drive = float(np.linalg.norm(u - u1) / np.linalg.norm(u1))
    return Followed(record.name, position, drive, largest)


def close(declared: Plant, extended: Plant, record: Record) -> Closed:
    """Return the loop of a record's axis with the declared and with the extended plant, tuned on each.

    Needs a limit of the drive (see `lacking`). Raises WorkbenchError for a plant without forward dynamics.
    """
    loop = loop_of(record)
    tasks = {DECLARED: task_of(declared, record, loop)}
    tasks[EXTENDED] = tasks[DECLARED].on(extended)
    made = {name: tuned(task) for name, task in tasks.items()}
    pairs = ((DECLARED, DECLARED), (DECLARED, EXTENDED), (EXTENDED, EXTENDED))
    responses, signals = [], {}
    for names in pairs:
        response, m = responded(tasks[names[1]], made[names[0]], names)
        responses.append(response)
        signals[names] = tuple(m.trajectories[n][:, 0] for n in (OUTPUT[extended.kind], "u"))
        time = m.trajectories.time
    followed = None
    if "reference" in record.channels:
        followed = following((declared, extended), record, loop, [made[n].controller() for n in tasks])
    gains = {name: one.numbers for name, one in made.items()}
    task = tasks[DECLARED]
    return Closed(loop, task.start, task.step, gains, tuple(responses), followed, time, signals)


def as_dict(closed: Closed) -> dict:
    """Return what trace.json holds of a closed loop, SI; infinite times (a loop that does not settle) are None."""

    def number(x: float) -> float | None:
        return x if isfinite(x) else None

    def plain(one: Mapping[str, object]) -> dict:
        return {n: number(x) if isinstance(x, float) else x for n, x in one.items()}

    followed = closed.followed
    return {
        "loop": plain(vars(closed.loop)),
        "step": {"start": closed.start, "size": closed.step},
        "controller": "position P over velocity PI",
        "gains": {name: dict(values) for name, values in closed.gains.items()},
        "responses": [plain(vars(r)) for r in closed.responses],
        "change": plain(closed.change),
        "followed": plain(vars(followed)) | {"largest": plain(followed.largest)} if followed else None,
    }

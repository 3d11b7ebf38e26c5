"""Controllers over one cycle of a periodic reading: the command's harmonics, by the law's own step.

The reading is y = sum Re q_k exp(i k f) over the phase f = w t with odd k, its filtered velocity vh likewise; theta = w Ts, and
the target is at zero. What a law does at a sample is evaluated at every phase: a schedule looks up its gains by the stroke
since the last reversal that the loop has found, and states are stepped along the phase until they repeat. The command obeys
the drive's limit.

A reversal is found a few encoder counts after it, and gains jump there. So the phases of such a law begin where one is found
and end where the next one is, half a cycle later: within, its command is smooth, and beyond, it is the same with its sign turned.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from types import MappingProxyType

import casadi as ca
import numpy as np

from workbench.control import Controller, Law, gains_at
from workbench.control.notched import behind, numbers_of
from workbench.definition import namespace
from workbench.errors import WorkbenchError
from workbench.kernel.arrays import evaluate
from workbench.limit_cycle.waves import along, clipped, found_after, harmonics_of, passed, shifted, turning
from workbench.simulation import Loop
from workbench.simulation.binding import BACK
from workbench.simulation.stage import Stage, stage

CYCLES = 2  # that states are stepped until they repeat
SIGNALS = ("r", "y", "e", "vh", "dt", "limit", "count", "back", "stroke", "share", "reversal")
MEMORY = ("stroke", "share", "reversal")  # signals that know the last reversal

# (q (..., n), vh (..., n), orders (n,), theta (...), phases of a cycle, even) -> harmonics of u (..., n); complex amplitudes
Command = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray, int], np.ndarray]


@dataclass(frozen=True)
class Dials:
    """Two numbers of a law that a region is drawn over: their names."""

    first: str
    second: str


DIALS = (Dials("kv", "ki"), Dials("kp", "kd"))


def dials(controller: Controller) -> Dials:
    """Return what is turned of a controller; WorkbenchError where it has no such gains, or reads two encoders."""
    law = controller.law
    for pair in DIALS:
        if {pair.first, pair.second} <= {*law.parameters, *law.columns} and not law.both:
            return pair
    raise WorkbenchError(
        f"limit cycles are not predicted for the law '{law.name}': one encoder, and gains {' or '.join(f'{d.first}, {d.second}' for d in DIALS)} "
        "are needed."
    )


def turned(controller: Controller, first: float, second: float) -> Controller:
    """Return a controller with the numbers of its two dials multiplied."""
    of = dials(controller)
    factor = {of.first: first, of.second: second}
    tables = tuple(
        replace(t, columns={n: c * factor.get(n, 1.0) for n, c in t.columns.items()}) for t in controller.tables
    )
    parameters = {n: v * factor.get(n, 1.0) for n, v in controller.parameters.items()}
    return replace(controller, parameters=parameters, tables=tables)


@lru_cache(maxsize=64)
def _stage(law: Law, looks_up: bool) -> Stage:
    """Return a law's step, or where it looks up, as a program of named values."""
    signals = {n: ca.SX.sym(n) for n in (*SIGNALS, *law.columns)}
    states = {n: ca.SX.sym(n) for n in law.states}
    numbers = {n: ca.SX.sym(n) for n in law.parameters}
    after, out = (law.amplitude if looks_up else law.step)(
        namespace(**signals), namespace(**states), namespace(**numbers)
    )
    given = signals | {f"z.{n}": v for n, v in states.items()} | {f"p.{n}": v for n, v in numbers.items()}
    return stage("law", given, {"out": out, **{f"z.{n}": v for n, v in after.items()}})


@lru_cache(maxsize=64)
def remembers(law: Law) -> bool:
    """Whether a law looks up by what it remembers of the last reversal."""
    if law.amplitude is None:
        return False
    signals = {n: ca.SX.sym(n) for n in SIGNALS}
    states = {n: ca.SX.sym(n) for n in law.states}
    after, out = law.amplitude(
        namespace(**signals), namespace(**states), namespace(**{n: ca.SX.sym(n) for n in law.parameters})
    )
    return bool(ca.depends_on(ca.vertcat(out, *after.values()), ca.vertcat(*(signals[n] for n in MEMORY))))


def command(controller: Controller, limit: float, loop: Loop) -> Command:
    """Return the command's harmonics over a cycle, of a controller of one lane on a drive with this limit."""
    dials(controller)
    law, notch = controller.law.before or controller.law, numbers_of(controller)
    known = {"r": 0.0, "limit": limit, "count": loop.count, "share": 0.5, "reversal": 0.0, "stroke": 0.0}
    known["back"] = BACK * loop.count if controller.reversal is None else controller.reversal
    known |= {f"p.{n}": float(np.ravel(v)[0]) for n, v in controller.parameters.items()}
    back = comes_back(controller, loop)

    def harmonics(q, vh, orders, theta, phases):
        halved = remembers(law)
        turn, top = turning(q, orders) if halved else (np.zeros(q.shape[:-1]), None)
        first = turn + found_after(q, orders, turn, back, theta) if halved else turn
        n = phases // 2 if halved else phases
        width = 2.0 * np.pi / phases
        y, rate = (along(h, orders, first, width, n + halved) for h in (q, vh))
        now = known | {"y": y, "e": -y, "vh": rate, "dt": loop.sample_time * width / theta[..., None]}
        if halved:
            now |= {"stroke": np.abs(top[..., None] - y), "reversal": np.where(np.arange(n + 1) == 0, 1.0, 0.0)}
        if law.amplitude is not None:
            now |= looked_up(now, y.shape)
        u = stepped(now, np.broadcast_shapes(y.shape, rate.shape), (theta - width)[..., None])
        u = u if notch is None else passed(u[..., :n], theta, partial(behind, notch), halved)
        u = u if halved else np.concatenate([u, u[..., :1]], axis=-1)
        return harmonics_of(clipped(u, limit), first + width / 2.0, orders, width)

    def looked_up(given, shape):
        # where a schedule looks up hangs on the reading alone: a law that asked for the speed would get none
        begun = (
            law.start(0.0, given["y"][..., 0]) if law.start is not None else {}
        )  # at rest, and released where the cycle turns
        at = _stepped(_stage(law, True), given | {"vh": np.nan, "dt": np.nan}, shape, begun)[0]
        columns = gains_at(controller.tables[0], np.nan_to_num(at.ravel()))
        return {n: c.reshape(shape) for n, c in zip(law.columns, columns, strict=True)}

    def stepped(given, shape, later):
        step = _stage(law, False)
        u, states = _stepped(step, given, shape, centred=True)
        if states:  # a state acts a sample late, not a phase
            u = _values(step, given | {n: shifted(v, later / 2.0) for n, v in states.items()})["out"]
        return np.broadcast_to(u, shape)

    return harmonics


def comes_back(controller: Controller, loop: Loop) -> float:
    """Return how far a motion comes back until a reversal is found, rad or m: the mean over where encoder counts lie."""
    count = loop.count
    back = BACK * count if controller.reversal is None else controller.reversal
    return (np.floor(back / count) + 0.5) * count if count else back


def _values(made: Stage, given: dict) -> dict:
    return dict(zip(made.outputs, evaluate(made.program, [given[n] for n in made.inputs])[0], strict=True))


def _stepped(
    made: Stage, given: dict, shape: tuple[int, ...], begun: Mapping = MappingProxyType({}), centred: bool = False
):
    """Return (output, state -> its values) over the phases; states are stepped until they repeat.

    begun: state -> its first value, zero where absent. centred: a cycle about the target leaves no mean in a state, which a free integral would keep from its start.
    """
    names = [n for n in made.outputs if n != "out"]
    if not names:
        return np.broadcast_to(_values(made, given)["out"], shape), {}
    along = {n: np.empty(shape) for n in ("out", *names)}
    start = {n: np.zeros(shape[:-1]) + begun.get(n.removeprefix("z."), 0.0) for n in names}
    read = {n: given[n] for n in made.inputs if n in given}
    moving = {n: v for n, v in read.items() if np.ndim(v)}
    for _ in range(CYCLES):
        now = start
        for k in range(shape[-1]):
            here = read | {n: v[..., k % v.shape[-1]] for n, v in moving.items()}
            for n in names:
                along[n][..., k] = now[n]
            values = _values(made, here | now)
            along["out"][..., k] = values["out"]
            now = {n: values[n] for n in names}
        start = {n: v - along[n].mean(axis=-1) if centred else v for n, v in now.items()}
    return along["out"], {n: along[n] for n in names}

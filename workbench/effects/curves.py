"""Free-form laws: what any law of a family could take, as a table over the family's coordinate.

Such an effect simulates, is described, identified and exported as any other. It is in no catalogue: its knots come from
data. It stands beside the declared effects of its place, and is what its family takes beyond them: where one of these is
free and lies in the span of the table (Coulomb friction is a level, viscous friction a line), an end of it is held at zero.
"""

from collections.abc import Sequence
from functools import cache

from workbench.definition import FORCE, Effect
from workbench.effects.elementary import absolute
from workbench.effects.table import (
    SOURCE,
    free,
    free_level,
    held_knots,
    increasing,
    levels,
    names,
    table,
    wave_parameters,
    waves,
    without,
)
from workbench.parameter import Parameter

ANYWHERE = ("axis", "motor", "load", "joint")
OFFSET = ("constant_offset", "offset")


@cache  # one function a count of knots, under which programs and columns are kept
def _of_speed(count: int):
    def step(s, z, p):
        speed = absolute(s.v)
        return {}, table(p, speed, "odd", count) * s.dir + table(p, speed, "even", count) * absolute(s.dir)

    return step


def friction_over_speed(speeds: Sequence[float], declared: Sequence[Effect] = (), at: str = "axis") -> Effect:
    """T = f(|v|) dir + g(|v|) |dir|: friction f + g forward and f - g backward, both tables over speed.

    speeds (n >= 3,): knots above 0, x/s; below the first f is held, so that it is the Coulomb level there.
    """
    knots = increasing(speeds, "speeds", True)
    n = len(knots)
    odd, even = names("odd", n), names("even", n)
    made = Effect(
        name="friction_over_speed",
        cause="friction that depends on speed and direction by no catalogued law",
        formula="T = f(|v|) dir + g(|v|) |dir|",
        source=SOURCE,
        port=FORCE,
        family="friction over speed",
        parameters=levels("odd", n, "friction, mean of both directions,")
        | levels("even", n, "friction, half its difference between the directions,")
        | held_knots(knots, "x/s", "speed"),
        linear=(*odd, *even),
        reads=("v", "dir"),
        step=_of_speed(n),
        places=ANYWHERE,
        at=at,
        traced=False,
        knots=names("knot", n),
    )
    zero = [odd[0]] if free_level(declared, at) else []
    zero += [odd[-1]] if free(declared, at, ("viscous_friction", "viscous"), ("linear_damping", "damping")) else []
    zero += [even[0]] if free(declared, at, OFFSET, ("coulomb_asymmetry", "coulomb_difference")) else []
    asymmetric = ("coulomb_asymmetry", "viscous_difference"), ("viscous_asymmetry", "viscous_difference")
    zero += [even[-1]] if free(declared, at, *asymmetric) else []
    return without(made, zero)


@cache
def _of_position(count: int, orders: int):
    def step(s, z, p):
        return {}, table(p, s.q, "force", count, onward=True) + waves(p, s.q, orders)

    return step


def force_over_position(
    positions: Sequence[float], declared: Sequence[Effect] = (), at: str = "axis", orders: Sequence[float] = ()
) -> Effect:
    """T = f(q) + sum_i A_i sin(k_i q + p_i): a table over the travel, and waves too short for it. At a joint, over its deflection.

    positions (n >= 3,): x; beyond them f goes on along its chord. orders: k_i in 1/x, held: of a travel of many periods a table would need many knots a period.
    """
    knots = increasing(positions, "positions", False)
    n, joint = len(knots), at == "joint"
    force, whole = names("force", n), held_knots(knots, "x", "stroke")
    periodic = wave_parameters(orders)
    made = Effect(
        name="force_over_position",
        cause=("a joint whose torque depends on its deflection" if joint else "a force that depends on position")
        + " by no catalogued law",
        formula="T = f(q) + sum Ai sin(ki q + pi)" if orders else "T = f(q)",
        source=SOURCE,
        port=FORCE,
        family="joint stiffness" if joint else "force over position",
        parameters=levels("force", n, "force") | periodic | whole,
        linear=(*force, *(w for w in periodic if not w.startswith("order"))),
        reads=("q",),
        step=_of_position(n, len(orders)),
        holds=("conservative",),
        places=ANYWHERE,
        at=at,
        traced=False,
        knots=(*whole, *names("order", len(orders))),
    )
    zero = [force[0]] if free(declared, at, OFFSET, ("cable_spring", "preload"), ("cable_spring", "rest")) else []
    zero += [force[-1]] if free(declared, at, ("cable_spring", "stiffness"), ("linear_stiffness", "stiffness")) else []
    return without(made, zero)


@cache
def _of_position_and_way(count: int, orders: int):
    def step(s, z, p):
        return {}, (table(p, s.q, "friction", count) + waves(p, s.q, orders)) * s.dir

    return step


def friction_over_position(
    positions: Sequence[float], declared: Sequence[Effect] = (), at: str = "axis", orders: Sequence[float] = ()
) -> Effect:
    """T = (f(q) + sum_i A_i sin(k_i q + p_i)) dir, as force_over_position."""
    knots = increasing(positions, "positions", False)
    made = _friction(
        "friction_over_position", "friction that depends on position by no catalogued law",
        "T = (f(q) + sum Ai sin(ki q + pi)) dir" if orders else "T = f(q) dir", "friction over position",
        held_knots(knots, "x", "stroke"), ("q", "dir"), _of_position_and_way(len(knots), len(orders)), declared, at,
        wave_parameters(orders),
    )  # fmt: skip
    return made


@cache
def _of_time_and_way(count: int):
    def step(s, z, p):
        return {}, table(p, s.t, "friction", count) * s.dir

    return step


def friction_over_time(times: Sequence[float], declared: Sequence[Effect] = (), at: str = "axis") -> Effect:
    """T = f(t) dir, a table over the bench clock that runs on from record to record. times (n >= 3,): s."""
    knots = increasing(times, "times", False)
    return _friction(
        "friction_over_time", "friction whose level changes while the axis is measured", "T = f(t) dir",
        "friction over time", held_knots(knots, "s"), ("t", "dir"), _of_time_and_way(len(knots)), declared, at,
    )  # fmt: skip


@cache
def _of_load(count: int):
    def step(s, z, p):
        return {}, table(p, absolute(s.tau), "friction", count, onward=True) * s.dir

    return step


def friction_over_load(loads: Sequence[float], declared: Sequence[Effect] = (), at: str = "axis") -> Effect:
    """T = f(|tau|) dir, a table over the load that the contact carries, beyond it along its chord. loads (n >= 3,): above 0, F."""
    knots = increasing(loads, "loads", True)
    made = _friction(
        "friction_over_load", "friction that depends on the load carried by no catalogued law", "T = f(|tau|) dir",
        "friction over load", held_knots(knots, "F"), ("tau", "dir"), _of_load(len(knots)), declared, at,
    )  # fmt: skip
    return without(
        made, names("friction", len(knots))[-1:] if free(declared, at, ("load_dependent_friction", "mu")) else ()
    )


def _friction(
    name, cause, formula, family, knots: dict[str, Parameter], reads, step, declared, at, more=None
) -> Effect:
    """A table times the direction; its first level is a free declared friction's."""
    n, more = len(knots), more or {}
    made = Effect(
        name=name,
        cause=cause,
        formula=formula,
        source=SOURCE,
        port=FORCE,
        family=family,
        parameters=levels("friction", n, "friction") | more | knots,
        linear=(*names("friction", n), *(w for w in more if not w.startswith("order"))),
        reads=reads,
        step=step,
        places=ANYWHERE,
        at=at,
        traced=False,
        knots=(*knots, *(w for w in more if w.startswith("order"))),
    )
    return without(made, made.linear[:1] if free_level(declared, at) else ())


@cache
def _of_time(count: int):
    def step(s, z, p):
        return {}, table(p, s.t, "force", count)

    return step


def force_over_time(times: Sequence[float], declared: Sequence[Effect] = (), at: str = "axis") -> Effect:
    """T = f(t), a table over the bench clock: a drive's offset, or a load, that wanders. times (n >= 3,): s."""
    knots = increasing(times, "times", False)
    n = len(knots)
    made = Effect(
        name="force_over_time",
        cause="a force, or the offset of the drive's channel, that wanders while the axis is measured",
        formula="T = f(t)",
        source=SOURCE,
        port=FORCE,
        family="force over time",
        parameters=levels("force", n, "force") | held_knots(knots, "s"),
        linear=names("force", n),
        reads=("t",),
        step=_of_time(n),
        places=ANYWHERE,
        at=at,
        traced=False,
        knots=names("knot", n),
    )
    return without(made, made.linear[:1] if free(declared, at, OFFSET) else ())

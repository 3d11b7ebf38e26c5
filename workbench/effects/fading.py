"""Fading memory: a force that forgets exponentially over the distance travelled (Dahl's friction)."""

from collections.abc import Sequence

from workbench.border import Border
from workbench.definition import FORCE, TWO_COUNTS, Effect, effect
from workbench.effects.elementary import absolute, exp, sign0
from workbench.parameter import Parameter


def _parameters(tags: Sequence[str]) -> tuple[dict[str, Parameter], dict[str, Parameter]]:
    """Return (inside, outside) of elements, each of which remembers ten times as far as the one before it."""
    inside, outside = {}, {}
    for i, t in enumerate(tags):
        first = 1e-3 * 10.0**i
        inside[f"h{t}"] = Parameter(0.0, "F", "height: the force when it slides", lower=0.0)
        inside[f"x0{t}"] = Parameter(first, "x", "distance over which it forgets", lower=1e-12, scale="stroke")
        outside[f"A{t}"] = Parameter(0.0, "F/x", "stiffness at rest", lower=0.0)
        outside[f"alpha{t}"] = Parameter(1.0 / first, "1/x", "rate of forgetting over distance", lower=1e-12)
    return inside, outside


@effect
def fading_memory(elements: int = 1) -> Effect:
    """dT/dt + alpha |dq/dt| T - A dq/dt = 0, summed over elements; inside h = A/alpha and x0 = 1/alpha.

    Exact step over |dq|: z <- s + (z - s) exp(-|dq|/x0), s = sgn(dq), T = h z. Rate independent: what fades, fades over
    distance, not over time. The virgin curve is h (1 - exp(-x/x0)), but reversals do not obey Masing's rule: after one, the
    force approaches the other side in the same length x0, not in twice that, and earlier reversals are not wiped out.
    """
    tags = ["" if elements == 1 else f"_{i}" for i in range(1, elements + 1)]

    def step(s, z, p):
        way, after, force = sign0(s.dq), {}, 0.0
        for t in tags:
            before = getattr(z, f"z{t}")
            after[f"z{t}"] = way + (before - way) * exp(-absolute(s.dq) / getattr(p, f"x0{t}"))
            force = force + getattr(p, f"h{t}") * after[f"z{t}"]
        return after, force

    inside, outside = _parameters(tags)

    def inward(o):
        heights = {f"h{t}": o[f"A{t}"] / o[f"alpha{t}"] for t in tags}
        return heights | {f"x0{t}": 1.0 / o[f"alpha{t}"] for t in tags}

    def outward(i):
        stiff = {f"A{t}": i[f"h{t}"] / i[f"x0{t}"] for t in tags}
        return stiff | {f"alpha{t}": 1.0 / i[f"x0{t}"] for t in tags}

    return Effect(
        name="fading_memory",
        cause="friction, as of a flexspline and its teeth, that forgets over the distance travelled since a reversal",
        formula="dT/dt + alpha |dq/dt| T = A dq/dt",
        source="Dahl 1968; as memory model of harmonic drives, Dhaouadi, Ghorbel, Gandhi 2003",
        port=FORCE,
        family="friction with memory",
        reduces={"x0": (TWO_COUNTS, "coulomb_friction")} if elements == 1 else {},
        parameters=inside,
        linear=tuple(f"h{t}" for t in tags),
        states={f"z{t}": 1 for t in tags},
        reads=("dq",),
        step=step,
        holds=("passive", "rate independent", "odd"),
        places=("axis", "motor", "load", "joint"),
        rare=True,
        border=Border(parameters=outside, inward=inward, outward=outward),
    )

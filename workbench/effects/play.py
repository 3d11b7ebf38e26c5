"""The elementary operators of hysteresis: play, stop, and banks of plays (Prandtl-Ishlinskii) with their exact inverse."""

from collections.abc import Sequence

from workbench.definition import FORCE, TWO_COUNTS, Effect, effect
from workbench.effects.elementary import clip, maximum, minimum
from workbench.errors import WorkbenchError
from workbench.parameter import Parameter

EVERYWHERE = ("axis", "motor", "load", "joint")


def _radius(value: float = 1e-3, meaning: str = "half width of the play") -> Parameter:
    return Parameter(value, "x", meaning, lower=1e-12, scale="stroke")


@effect
def stop() -> Effect:
    """T = k w, w <- clip(w + dq, -r, r): one spring that slips at the deflection r. x - play = stop, exactly."""

    def step(s, z, p):
        w = clip(z.w + s.dq, -p.radius, p.radius)
        return {"w": w}, p.stiffness * w

    return Effect(
        name="stop",
        cause="one contact that deflects as a spring until it slips",
        formula="T = k w, w <- clip(w + dq, -r, r)",
        source="Krasnosel'skii and Pokrovskii 1989",
        port=FORCE,
        family="friction with memory",
        reduces={"radius": (TWO_COUNTS, "coulomb_friction")},
        parameters={
            "stiffness": Parameter(0.0, "F/x", "stiffness before it slips", lower=0.0),
            "radius": _radius(meaning="deflection at which it slips"),
        },
        linear=("stiffness",),
        states={"w": 1},
        reads=("dq",),
        virgin=lambda x, p: p.stiffness * minimum(x, p.radius),
        step=step,
        holds=("passive", "rate independent", "odd", "masing"),
        places=EVERYWHERE,
        traced=False,
    )


@effect
def play() -> Effect:
    """T = k y, y <- clip(y, x - r, x + r), x the distance from the start; kept as x - y, so no position is needed.

    Its loop is run through the other way: by itself it gives energy (a force needs it with a negative weight beside a
    spring as large, which together are a stop).
    """

    def step(s, z, p):
        w = clip(z.w + s.dq, -p.radius, p.radius)
        y = z.y + (s.dq - (w - z.w))
        return {"w": w, "y": y}, p.stiffness * y

    return Effect(
        name="play",
        cause="lost motion: the far side follows only once a gap is taken up",
        formula="T = k y, y <- clip(y, x - r, x + r)",
        source="Krasnosel'skii and Pokrovskii 1989",
        port=FORCE,
        family="friction with memory",
        parameters={"stiffness": Parameter(0.0, "F/x", "stiffness behind the play"), "radius": _radius()},
        linear=("stiffness",),
        states={"w": 1, "y": 1},
        reads=("dq",),
        virgin=lambda x, p: p.stiffness * maximum(x - p.radius, 0.0),
        step=step,
        holds=("rate independent", "odd", "masing"),
        places=EVERYWHERE,
        traced=False,
    )


def play_bank(radii: Sequence[float], weights: Sequence[float] = ()) -> Effect:
    """Prandtl-Ishlinskii operator: T = c0 x + sum c_i play_i(x), x the distance from the start.

    radii (n,): r_i in SI, above 0 and increasing. weights (n + 1,): c_0, c_1, ... in F/x; the values of the effect.
    """
    wrong = [b for a, b in zip((0.0, *radii), radii, strict=False) if not b > a]
    if wrong:
        raise WorkbenchError(f"play radii must increase from above 0; {wrong[0]:g} does not.")
    names, held = [f"c{i}" for i in range(len(radii) + 1)], tuple(f"r{i}" for i in range(1, len(radii) + 1))

    def step(s, z, p):
        x = z.x + s.dq
        after, force = {"x": x}, p.c0 * x
        for i in range(1, len(radii) + 1):
            r = getattr(p, f"r{i}")
            y = clip(getattr(z, f"y{i}"), x - r, x + r)
            after[f"y{i}"], force = y, force + getattr(p, f"c{i}") * y
        return after, force

    made = Effect(
        name="play_bank",
        cause="many contacts that stick and slip, each after its own deflection",
        formula="T = c0 x + sum ci play_i(x)",
        source="Kuhnen 2003 (modified Prandtl-Ishlinskii operator)",
        port=FORCE,
        family="friction with memory",
        parameters={
            n: Parameter(0.0, "F/x", f"weight of play {i}" if i else "weight of x") for i, n in enumerate(names)
        }
        | {
            n: Parameter(r, "x", f"radius of play {i}", fixed=True)
            for i, (n, r) in enumerate(zip(held, radii, strict=True), 1)
        },
        knots=held,
        linear=tuple(names),
        states={"x": 1} | {f"y{i}": 1 for i in range(1, len(radii) + 1)},
        reads=("dq",),
        step=step,
        holds=("rate independent", "odd", "masing"),
        places=EVERYWHERE,
        traced=False,
    )
    return made(**dict(zip(names, weights, strict=True))) if weights else made


def inverse(radii: Sequence[float], weights: Sequence[float]) -> tuple[list[float], list[float]]:
    """Return radii and weights of the play bank that undoes another: its output's increments in, x back.

    With slopes S_i = c_0 + ... + c_i, all above 0: r'_i = sum_j<=i c_j (r_i - r_j), c'_0 = 1/c_0 and
    c'_i = -c_i/(S_i S_(i-1)) (Kuhnen 2003). WorkbenchError where a slope is not above 0: then there is no inverse.
    """
    reach = [0.0, *radii]
    slopes = [sum(weights[: i + 1]) for i in range(len(weights))]
    if not all(s > 0.0 for s in slopes):
        raise WorkbenchError(
            f"a play bank with a slope of {min(slopes):g} after some play has no inverse; every sum of leading weights "
            "must be above 0."
        )
    undone = [sum(c * (r - e) for c, e in zip(weights[:i], reach[:i], strict=True)) for i, r in enumerate(reach)][1:]
    turned = [-c / (s * before) for c, s, before in zip(weights[1:], slopes[1:], slopes[:-1], strict=True)]
    return undone, [1.0 / weights[0], *turned]

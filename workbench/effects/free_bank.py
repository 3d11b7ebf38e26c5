"""The free-form law of friction with memory: Maxwell stops of held slips, whose stiffnesses are free and not negative."""

from collections.abc import Sequence
from functools import cache
from math import exp

import casadi as ca

from workbench.definition import FORCE, Effect
from workbench.effects.elementary import clip, minimum
from workbench.effects.table import at as of
from workbench.effects.table import increasing, names
from workbench.errors import WorkbenchError
from workbench.parameter import Parameter

# Where a bank has its slips: a factor of 1.8 between two, so that the virgin curve between them errs by less than 2 % of its
# height. Twice as many cost twice the time and are known less well one by one; half as many err by 6 %.
COUNTS = (1.0, 2.0, 3.2, 5.6, 10.0, 18.0, 32.0, 56.0, 100.0)  # encoder counts, in the place of Coulomb friction
NAME = "hysteresis_bank"
LENGTHS = tuple(0.01 * 3000.0 ** (i / 13) for i in range(14))  # presliding lengths: 0.01 to 30


@cache
def _of_slips(count: int):
    def step(s, z, p):
        slip = ca.vertcat(*of(p, "slip", count))
        x = clip(z.x + s.dq, -slip, slip)
        return {"x": x}, ca.dot(ca.vertcat(*of(p, "k", count)), x), {"dir": ca.dot(ca.vertcat(*of(p, "way", count)), x)}

    return step


@cache
def _virgin(count: int):
    def virgin(x, p):
        return sum(k * minimum(x, d) for k, d in zip(of(p, "k", count), of(p, "slip", count), strict=True))

    return virgin


def _springs(slips: Sequence[float], heights: Sequence[float]) -> list[float]:
    """Return k_i >= 0 of the bank whose virgin curve passes through (slip, height) and is level after the last."""
    x, y = [0.0, *slips], [0.0, *heights]
    slopes = [(y[i + 1] - y[i]) / (x[i + 1] - x[i]) for i in range(len(slips))] + [0.0]
    return [max(a - b, 0.0) for a, b in zip(slopes[:-1], slopes[1:], strict=True)]


def hysteresis_bank(slips: Sequence[float], heights: Sequence[float], height: float = 0.0, at: str = "axis") -> Effect:
    """T = sum k_i x_i, x_i <- clip(x_i + dq, -D_i, D_i), k_i >= 0 free, D_i held; dir = sum c_i x_i.

    slips (n >= 3,): D_i, above 0, x. heights (n,): the normalised virgin curve that `dir` keeps, concave, ending at 1; times
    `height` (F) it is where the stiffnesses begin.
    """
    slips = increasing(slips, "slips", True)
    n = len(slips)
    ways = _springs(slips, heights)
    stiff, held, way = names("k", n), names("slip", n), names("way", n)
    parameters = {
        k: Parameter(height * w, "F/x", f"stiffness of element {i}", lower=0.0)
        for i, (k, w) in enumerate(zip(stiff, ways, strict=True), 1)
    }
    for i, (d, slip) in enumerate(zip(held, slips, strict=True), 1):
        parameters[d] = Parameter(slip, "x", f"slip of element {i}", lower=1e-15, fixed=True, scale="stroke")
    for i, (c, w) in enumerate(zip(way, ways, strict=True), 1):
        parameters[c] = Parameter(w, "1/x", f"share of element {i} in the direction", lower=0.0, fixed=True)
    return Effect(
        name=NAME,
        cause="asperities that deflect before they slip, by a virgin curve of no catalogued law",
        formula="T = sum ki xi, xi <- clip(xi + dq, -Di, Di)",
        source="Iwan 1966; Lampaert, Al-Bender, Swevers 2003",
        port=FORCE,
        family="friction with memory",
        parameters=parameters,
        linear=stiff,
        states={"x": n},
        reads=("dq",),
        provides=("dir",),
        virgin=_virgin(n),
        step=_of_slips(n),
        holds=("passive", "rate independent", "odd", "masing"),
        places=("axis", "motor", "load", "joint"),
        at=at,
        traced=False,
        knots=(*held, *way),
    )


def _direction_of(effect: Effect | None, slips: Sequence[float]) -> list[float]:
    """Return the normalised virgin curve of a friction at slips (n,): of its presliding length, else of a stop of slips[1]."""
    values = {n: p.value for n, p in effect.parameters.items()} if effect is not None else {}
    if "x0" in values:
        curve = [1.0 - exp(-((s / values["x0"]) ** values.get("d", 1.0))) for s in slips]
        return [*curve[:-1], 1.0]
    return [min(s / slips[1], 1.0) for s in slips]


def _height_of(effect: Effect | None) -> float:
    """Return a friction's force when sliding, F."""
    values = {n: p.value for n, p in effect.parameters.items()} if effect is not None else {}
    heights = [values[n] for n in ("coulomb", "h0", "h") if n in values]
    return heights[0] if heights else values.get("sigma0", 0.0) * values.get("x0", 0.0)


def bank_beside(slips: Sequence[float], declared: Sequence[Effect] = (), at: str = "axis") -> Effect:
    """Return the bank of these slips that takes the place of the friction declared at a place, with its height and direction."""
    there = [e for e in declared if e.at == at and (e.name == "coulomb_friction" or ("dir" in e.provides and e.linear))]
    giver = next((e for e in there if e.provides), there[0] if there else None)
    return hysteresis_bank(slips, _direction_of(giver, slips), _height_of(giver), at)


def slips_of(effect: Effect, counts: float = 0.0) -> tuple[float, ...]:
    """Return the slips of a bank in the place of a friction: 1 to 100 encoder counts of Coulomb's, else 0.01 to 30 x0."""
    if effect.name == "coulomb_friction":
        if not counts > 0.0:
            raise WorkbenchError(
                "a bank in the place of Coulomb friction has its slips in encoder counts; state the encoder's resolution."
            )
        return tuple(counts * c for c in COUNTS)
    if "x0" not in effect.parameters:
        raise WorkbenchError(
            f"effect '{effect.name}' has no presliding length 'x0', so there is no bank of held slips in its place; "
            "known: coulomb_friction, presliding_hysteresis, fading_memory, lugre_friction."
        )
    return tuple(effect.parameters["x0"].value * c for c in LENGTHS)


def free_bank(effect: Effect, counts: float = 0.0) -> Effect:
    """Return the bank that takes a declared friction's place, with its height, and its direction for others to read.

    effect: Coulomb friction (slips of 1 to 100 encoder counts) or one with a presliding length x0 (slips of 0.01 to 30 x0).
    counts: the encoder's step, SI. Direction is exact for Coulomb's two counts, else within 2 % of the declared one.
    """
    return bank_beside(slips_of(effect, counts), (effect,), effect.at)

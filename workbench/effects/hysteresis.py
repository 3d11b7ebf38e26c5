"""Hysteresis by Maxwell slip: stop operators in parallel, their stiffnesses derived from a virgin curve.

Each element is a spring that slips at its own deflection, x_i <- clip(x_i + dq, -D_i, D_i). A bank with the virgin curve
y(x) holds Masing's rule: after a reversal the curve is y stretched by two (Al-Bender, Lampaert, Swevers 2005).
"""

import casadi as ca

from workbench.border import Border
from workbench.definition import FORCE, TWO_COUNTS, Effect, effect, namespace
from workbench.effects.elementary import clip, exp, expm1, log, minimum, power
from workbench.parameter import Parameter

ELEMENTS = 24
SMALL = (0.003, 0.01, 0.025)  # three knots below the first equidistributed one: loss at micro-radian amplitudes
HEIGHT = Parameter(0.0, "F", "height: Coulomb friction when sliding", lower=0.0)
WRITTEN = Border(  # the virgin curve as it is written outside, h0 (1 - exp(-a x^d))
    parameters={
        "h0": HEIGHT,
        "a": Parameter(1e3, "1/x^d", "rate of the virgin curve", lower=1e-12),
        "d": Parameter(1.0, "1", "exponent of the virgin curve", lower=0.3, upper=1.0, fixed=True),
    },
    inward=lambda o: {"h0": o["h0"], "x0": o["a"] ** (-1.0 / o["d"]), "d": o["d"]},
    outward=lambda i: {"h0": i["h0"], "a": i["x0"] ** -i["d"], "d": i["d"]},
)


def knots(elements: int = ELEMENTS, small: tuple[float, ...] = SMALL) -> tuple[float, ...]:
    """Return the arguments c_i = (D_i/x0)^d at which the curve 1 - exp(-c) is interpolated, increasing.

    c_i = -2 ln(1 - i/(N + 1/2)) equidistributes sqrt(|y''|), the optimum for a piecewise linear interpolation (de Boor
    1978); the largest error is about h0/(2 N^2).
    """
    spread = [-2.0 * log(1.0 - i / (elements + 0.5)) for i in range(1, elements + 1)]
    return tuple(c for c in small if c < 0.5 * spread[0]) + tuple(spread)


def bank(c: tuple[float, ...], x0, d):
    """Return (k, D): stiffnesses in 1/x and slip deflections, of a bank of height one, as CasADi vectors.

    The height at knot i is 1 - exp(-c_i) whatever x0 and d are, and exactly one at the last, so that sum k D = 1.
    """
    heights = [0.0] + [1.0 - exp(-v) for v in c[:-1]] + [1.0]
    rises = ca.DM([after - before for before, after in zip(heights[:-1], heights[1:], strict=True)])
    slips = x0 * power(ca.DM(list(c)), 1.0 / d)
    slopes = ca.vertcat(rises / (slips - ca.vertcat(0.0, slips[:-1])), 0.0)
    return slopes[:-1] - slopes[1:], slips


@effect
def presliding_hysteresis(elements: int = ELEMENTS) -> Effect:
    """Virgin curve y(x) = h0 (1 - exp(-(x/x0)^d)), d <= 1, Masing's rule; saturates at h0, the Coulomb friction.

    d <= 1 keeps the curve concave, all elements stiff and the bank passive. Outside it is written h0 (1 - exp(-a x^d)).
    """
    c = knots(elements)

    def virgin(x, p):
        return -p.h0 * expm1(-power(x / p.x0, p.d))  # no cancellation at small strokes

    def derive(p):
        k, slip = bank(c, p.x0, p.d)
        return namespace(h0=p.h0, k=k, slip=slip)

    def step(s, z, p):
        x = clip(z.x + s.dq, -p.slip, p.slip)
        direction = ca.dot(p.k, x)
        return {"x": x}, p.h0 * direction, {"dir": direction}

    return Effect(
        name="presliding_hysteresis",
        cause="asperities of bearings and teeth deflect before they slip: friction with memory of past reversals",
        formula="virgin curve h0 (1 - exp(-a x^d)), Masing's rule",
        source="Al-Bender, Lampaert, Swevers 2005; Tjahjowidodo, Al-Bender, Van Brussel 2013",
        port=FORCE,
        family="friction with memory",
        reduces={"x0": (TWO_COUNTS, "coulomb_friction")},
        parameters={
            "h0": HEIGHT,
            "x0": Parameter(1e-3, "x", "presliding length", lower=1e-12, scale="stroke"),
            "d": Parameter(1.0, "1", "exponent of the virgin curve", lower=0.3, upper=1.0, fixed=True, scale="number"),
        },
        linear=("h0",),
        states={"x": len(c)},
        reads=("dq",),
        provides=("dir",),
        derive=derive,
        virgin=virgin,
        step=step,
        holds=("passive", "rate independent", "odd", "masing"),
        places=("axis", "motor", "load", "joint"),
        border=WRITTEN,
    )


def maxwell_slip(slips: tuple[float, ...], *, searched: bool = False) -> Effect:
    """Maxwell slip with stiffnesses from data: T = sum k_i x_i, x_i <- clip(x_i + dq, -D_i, D_i), k_i >= 0.

    slips: the deflections D_i in SI; held, so that the fit is a non-negative least squares, unless `searched`.
    """
    springs = [f"k{i}" for i in range(1, len(slips) + 1)]
    limits = [f"slip{i}" for i in range(1, len(slips) + 1)]

    def step(s, z, p):
        every = vars(p)
        slip = ca.vertcat(*(every[n] for n in limits))
        x = clip(z.x + s.dq, -slip, slip)
        return {"x": x}, ca.dot(ca.vertcat(*(every[n] for n in springs)), x)

    def virgin(x, p):
        every = vars(p)
        return sum(every[k] * minimum(x, every[d]) for k, d in zip(springs, limits, strict=True))

    stiff = {n: Parameter(0.0, "F/x", f"stiffness of element {i}", lower=0.0) for i, n in enumerate(springs, 1)}
    slip = {
        n: Parameter(v, "x", f"slip deflection of element {i}", lower=1e-12, fixed=not searched, scale="stroke")
        for i, (n, v) in enumerate(zip(limits, slips, strict=True), 1)
    }
    return Effect(
        name="maxwell_slip",
        cause="asperities that deflect before they slip, each at its own deflection",
        formula="T = sum k_i x_i, x_i <- clip(x_i + dq, -D_i, D_i)",
        source="Iwan 1966; Lampaert, Al-Bender, Swevers 2003",
        port=FORCE,
        family="friction with memory",
        parameters=stiff | slip,
        linear=tuple(springs),
        states={"x": len(slips)},
        reads=("dq",),
        virgin=virgin,
        step=step,
        holds=("passive", "rate independent", "odd", "masing"),
        places=("axis", "motor", "load", "joint"),
    )

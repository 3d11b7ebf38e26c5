"""Stiffness: of a joint in its deflection, or of a spring to ground in the axis' position."""

from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import absolute, clip, power, sign0
from workbench.parameter import Parameter


@effect
def linear_stiffness() -> Effect:
    """T = k x: x the joint's deflection; of one mass its position, against a spring to ground that is relaxed at zero.

    A joint holds together, k >= 0; to ground k < 0 too: a magnet that draws the body away from the middle. On one mass a trace
    offers `cable_spring`, which is the same with a rest position.
    """

    def step(s, z, p):
        return {}, p.stiffness * s.q

    return Effect(
        name="linear_stiffness",
        cause="elastic wind-up of the flexspline, coupling or belt; on one mass a spring to ground, or a magnet (k < 0)",
        formula="T = k x",
        source="Hooke's law",
        port=FORCE,
        family="joint stiffness",
        parameters={"stiffness": Parameter(0.0, "F/x", "stiffness", lower=0.0)},
        linear=("stiffness",),
        reads=("q",),
        step=step,
        holds=("conservative", "odd"),
        places=("axis", "motor", "load", "joint"),
        stated=("axis", "motor", "load"),
        signed_at={"stiffness": ("axis", "motor", "load")},
        at="joint",
    )


@effect
def cubic_stiffness() -> Effect:
    """T = k3 x^3: of a joint in its deflection, of one mass beside a declared spring to ground. k3 > 0 hardens; k3 < 0 softens, as a magnetic
    coupling does up to its pull-out, and a magnet's pull to ground grows faster than the way."""

    def step(s, z, p):
        return {}, p.k3 * (s.q * s.q * s.q)

    return _bent(
        name="cubic_stiffness",
        cause="more teeth in mesh as torque grows: the joint hardens (k3 < 0: a magnetic coupling or an elastomer softens); on one mass a "
        "flexure that stretches as it bends",
        formula="T = k3 x^3",
        source="Tuttle and Seering 1996",
        reduces={"k3": (0.0, "")},
        parameters={"k3": Parameter(0.0, "F/x^3", "cubic stiffness", lower=0.0)},
        linear=("k3",),
        step=step,
        signed_at={"k3": ("axis", "joint")},
    )


@effect
def power_law_stiffness() -> Effect:
    """T = T1 (|x|/x1)^n sgn(x), n > 1: hardening by another power than the third; x1 is a reference, T1 the torque there."""

    def step(s, z, p):
        return {}, p.torque * sign0(s.q) * power(absolute(s.q) / p.deflection, p.exponent)

    return _bent(
        name="power_law_stiffness",
        cause="contacts that come to bear one after another: the joint hardens, by a power of its deflection",
        formula="T = T1 (|x|/x1)^n sgn(x)",
        source="Hertz 1882 (n = 1.5); Tuttle and Seering 1996 (n = 3)",
        parameters={
            "torque": Parameter(0.0, "F", "torque at the reference deflection", lower=0.0),
            "deflection": Parameter(1e-3, "x", "reference deflection", lower=1e-12, fixed=True),
            "exponent": Parameter(2.0, "1", "exponent of the deflection", lower=1.1, upper=7.0, scale="exponent"),
        },
        linear=("torque",),
        step=step,
        traced=False,
        nearest="cubic_stiffness",
        knots=("deflection",),
    )


@effect
def piecewise_stiffness() -> Effect:
    """T = k1 x inside |x| <= x_thr, and k1 x + k2 (x - x_thr sgn x) outside: there the slope is k1 + k2, not k2.

    Of a joint in its deflection; of one mass a bumper or a stop that is met on both sides, by a flexure (beside a declared spring to
    ground) or by a slide (k1 = 0).
    """

    def step(s, z, p):
        return {}, p.k1 * s.q + p.k2 * (s.q - clip(s.q, -p.threshold, p.threshold))

    return _bent(
        name="piecewise_stiffness",
        cause="teeth and bearing take the load one after another: the joint is soft about zero and stiffer beyond; on one mass a bumper that is met",
        formula="T = k1 x + k2 (|x| - x_thr)+ sgn(x)",
        source="Kircanski and Goldenberg 1997; manufacturers' three-segment stiffness",
        reduces={"k1": (0.0, "backlash"), "k2": (0.0, "linear_stiffness")},
        parameters={
            "k1": Parameter(0.0, "F/x", "stiffness about zero", lower=0.0),
            "k2": Parameter(0.0, "F/x", "what the stiffness is more outside the threshold"),
            "threshold": Parameter(1e-3, "x", "deflection at which the stiffness changes", lower=1e-12, scale="stroke"),
        },
        linear=("k1", "k2"),
        step=step,
        alone="k1",
    )


@effect
def three_slope_stiffness() -> Effect:
    """T = k1 x, to which each of two thresholds adds a slope: k1 + k2 beyond the first, k1 + k2 + k3 beyond the second.

    Data sheets of strain wave gears state K1, K2 and K3 with the torques T1 and T2 between them: k2 = K2 - K1, k3 = K3 - K2.
    """

    def step(s, z, p):
        nearer = p.share * p.threshold
        first, second = (s.q - clip(s.q, -x, x) for x in (nearer, p.threshold))
        return {}, p.k1 * s.q + (p.k2 * first + p.k3 * second)

    return _bent(
        name="three_slope_stiffness",
        cause="teeth and bearing take the load one after another: three slopes, as data sheets of strain wave gears state them",
        formula="T = k1 x + (k2 (|x| - s x_thr)+ + k3 (|x| - x_thr)+) sgn(x)",
        source="Kircanski and Goldenberg 1997; manufacturers' three-segment stiffness",
        reduces={"k3": (0.0, "piecewise_stiffness")},
        parameters={
            "k1": Parameter(0.0, "F/x", "stiffness about zero", lower=0.0),
            "k2": Parameter(0.0, "F/x", "what the stiffness is more outside the first threshold"),
            "k3": Parameter(0.0, "F/x", "what it is more again outside the second threshold"),
            "threshold": Parameter(1e-3, "x", "deflection of the second change", lower=1e-12, scale="stroke"),
            "share": Parameter(
                0.5, "1", "deflection of the first change, over it", lower=1e-3, upper=1.0, scale="number"
            ),
        },
        linear=("k1", "k2", "k3"),
        step=step,
        alone="k1",
        traced=False,
        nearest="piecewise_stiffness",
    )


def _bent(alone: str = "", **own) -> Effect:
    """Return the effect of a stiffness that changes with deflection. alone: its parameter that is a declared spring's, beside one. own: what else is
    its own."""
    return Effect(
        **own,
        port=FORCE,
        family="joint stiffness",
        reads=("q",),
        holds=("conservative", "odd"),
        places=("axis", "joint"),
        beside={"axis": ("linear_stiffness", alone)},
        at="joint",
    )

"""Two laws of the review that the catalogue has not: waves of a gear that fade under load, and two compliances with the friction
between them."""

from workbench.definition import ANGLE, FORCE, Effect
from workbench.effects.elementary import absolute, clip, cos, exp, sign0, sin, where
from workbench.parameter import Parameter

FLAT = 1e-3  # rad, deflection over which fading is counted
LARGEST = 1.5  # phi up to which the law is followed, as in the catalogue's multi_body_compliance
# Of Newton's method, with bisection beside: at the values here four come to rounding and three leave 2e-11 of a radian; as many again
# are for the values that a fit passes.
STEPS = 8


def waves_under_load(multiples: tuple[float, ...], ratio: float) -> Effect:
    """x_eff = x + sum_i (a_i sin(k_i q_m) + b_i cos(k_i q_m)) / (1 + e (x/1 mrad)^2), k_i = multiples_i ratio: waves of several
    orders a turn of the motor, rad, that fade as the joint is deflected. e = 0: they do not."""

    def step(s, z, p):
        error = 0.0
        for i, m in enumerate(multiples, 1):
            angle = m * ratio * s.motor_q
            error = error + getattr(p, f"sine_{i}") * sin(angle) + getattr(p, f"cosine_{i}") * cos(angle)
        loaded = s.q / FLAT
        return {}, s.q + error / (1.0 + p.fading * loaded * loaded)

    terms = {
        f"{word}_{i}": Parameter(0.0, "x", f"{word} amplitude of {m:g} waves a turn of the motor")
        for i, m in enumerate(multiples, 1)
        for word in ("sine", "cosine")
    }
    return Effect(
        name="waves_under_load",
        cause="a gear's error of several orders, less of which is left where more teeth carry",
        formula="x_eff = x + sum (ai sin(ki q_m) + bi cos(ki q_m))/(1 + e (x/1 mrad)^2)",
        source="the review's trigonometric model, whose amplitudes it says to fall with load",
        port=ANGLE,
        family="angle over angle",
        parameters=terms | {"fading": Parameter(0.0, "1", "fading at 1 mrad of deflection", lower=0.0, upper=100.0)},
        reads=("q", "motor_q"),
        step=step,
        places=("joint",),
        at="joint",
        traced=False,
    )


def compliances_in_series() -> Effect:
    """x = x_f atan(T/T_f) + x_w (1 - exp(-c |T_w|/T_f)) sgn(T_w), T_w = T - T_fr dir, solved for T: multi_body_compliance with friction.

    The flexspline carries T; the wave generator, seen from the output, less by the friction between them. dir is that of winding
    up: a play operator's of half the width `reversal`. x_f = (1 - share) x0, x_w = share x0/c, so that x0/T_f is the compliance
    unloaded and share the generator's part of it. Monotone in phi = atan(T/T_f), so Newton's steps between bounds end.
    """

    def step(s, z, p):
        behind = clip(z.behind, s.q - p.reversal, s.q + p.reversal)
        rubbed = p.friction * (s.q - behind) / p.reversal
        x_f, x_w = (1.0 - p.share) * p.x0, p.share * p.x0 / p.c
        low, high = (clip((s.q + side * x_w) / x_f, -LARGEST, LARGEST) for side in (-1.0, 1.0))
        phi = 0.5 * (low + high)
        for _ in range(STEPS):
            cosine = cos(phi)
            carried = sin(phi) / cosine - rubbed
            soft = exp(-p.c * absolute(carried))
            over = x_f * phi + x_w * (1.0 - soft) * sign0(carried) - s.q
            low, high = where(over > 0.0, low, phi), where(over > 0.0, phi, high)
            stepped = phi - over / (x_f + x_w * p.c * soft / (cosine * cosine))
            out = (stepped < low) + (stepped > high)
            phi = where(out, 0.5 * (low + high), stepped)
        return {"behind": behind}, p.torque * sin(phi) / cos(phi)

    return Effect(
        name="compliances_in_series",
        cause="flexspline and wave generator in series, with the friction of the teeth between them",
        formula="x = x_f atan(T/T_f) + x_w (1 - exp(-c |T_w|/T_f)) sgn(T_w), T_w = T - T_fr dir",
        source="Zhang, Ahmad, Liu 2015, with |T_w|",
        port=FORCE,
        family="joint stiffness",
        parameters={
            "torque": Parameter(0.0, "F", "T_f: torque at which the flexspline is twice as stiff", lower=0.0),
            "x0": Parameter(3e-3, "x", "T_f times the compliance of both, unloaded", lower=1e-12, scale="stroke"),
            "share": Parameter(0.5, "1", "the wave generator's share of that compliance", lower=0.0, upper=0.99),
            "c": Parameter(1.0, "1", "T_f over T_w", lower=1e-3, upper=1e3, scale="number"),
            "friction": Parameter(0.0, "1", "T_fr over T_f", lower=0.0, upper=1.0),
            "reversal": Parameter(2e-4, "x", "half of the deflection over which it turns", lower=1e-9, fixed=True),
        },
        linear=("torque",),
        states={"behind": 1},
        reads=("q",),
        step=step,
        places=("joint",),
        at="joint",
        traced=False,
    )

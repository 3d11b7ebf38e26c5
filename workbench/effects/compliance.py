"""Multi-body compliance: flexspline and wave generator in series, each stiffer the more it carries."""

from workbench.border import Border
from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import absolute, clip, cos, exp, maximum, minimum, sign0, sin, where
from workbench.parameter import Parameter

HALLEY = 7  # safeguarded steps: fixed, so that the instructions are the same for every deflection
FURTHEST = 2.0  # by what factor a step is longer or shorter than Newton's
LARGEST = 1.5  # phi up to which the law is followed: there the flexspline is 200 times as stiff as unloaded


@effect
def multi_body_compliance() -> Effect:
    """x = x_f atan(T/T_f) + x_w (1 - exp(-c |T|/T_f)) sgn(T), solved for T.

    Flexspline K_f (1 + (T/T_f)^2), with x_f = T_f/K_f; wave generator, seen from the output, K_w exp(|T|/T_w), with
    x_w = T_w/K_w and c = T_f/T_w: its stiffness takes |T|. With phi = atan(T/T_f) the deflection is solved by Halley's
    method between bounds that always hold the root. Domain: the arctangent ends at x_f pi/2 (+ x_w), where the law is
    infinitely stiff; from phi = 1.5 on it goes on with its slope there.
    """

    def step(s, z, p):
        def deflection(phi):
            """Deflection at phi >= 0, its slope, and the slope's."""
            cosine = cos(phi)
            tangent = sin(phi) / cosine
            soft = exp(-p.c * tangent)
            turn = p.x_w * p.c * soft / (cosine * cosine)
            value = p.x_f * phi + p.x_w * (1.0 - soft)
            return value, p.x_f + turn, turn * (2.0 * tangent - p.c / (cosine * cosine))

        x = absolute(s.q)
        end, end_slope, _ = deflection(LARGEST)
        inside = minimum(x, end)
        low = clip((inside - p.x_w) / p.x_f, 0.0, LARGEST)
        high = clip(inside / p.x_f, 0.0, LARGEST)
        # the better of two starts: the chord of the whole, which is exact at 0, and the stiff side's bound
        phi = maximum(low, minimum(high, inside / (p.x_f + p.x_w * p.c)))
        for _ in range(HALLEY):
            value, slope, bend = deflection(phi)
            over = value > inside
            low, high = where(over, low, phi), where(over, phi, high)
            newton = (value - inside) / slope
            next_phi = phi - newton / clip(1.0 - 0.5 * newton * bend / slope, 1.0 / FURTHEST, FURTHEST)
            out = (next_phi < low) + (next_phi > high)
            phi = where(out, 0.5 * (low + high), next_phi)
        beyond = (x - inside) / end_slope / (cos(LARGEST) ** 2)
        return {}, p.torque * sign0(s.q) * (sin(phi) / cos(phi) + beyond)

    def inward(o):
        t, soft = o["flexspline_torque"], o["generator_torque"]
        return {
            "torque": t,
            "x_f": t / o["flexspline_stiffness"],
            "x_w": soft / o["generator_stiffness"],
            "c": t / soft,
        }

    def outward(i):
        t = i["torque"]
        return {
            "flexspline_torque": t,
            "flexspline_stiffness": t / i["x_f"],
            "generator_torque": t / i["c"],
            "generator_stiffness": t / i["c"] / i["x_w"],
        }

    return Effect(
        name="multi_body_compliance",
        cause="flexspline and wave generator in series, both of which stiffen as more teeth come into mesh",
        formula="x = (T_f/K_f) atan(T/T_f) + (T_w/K_w) (1 - exp(-|T|/T_w)) sgn(T)",
        source="Zhang, Ahmad, Liu 2015",
        port=FORCE,
        family="joint stiffness",
        rare=True,  # strain-wave gears alone have both compliances; two springs and a cubic are the commoner picture of any joint
        parameters={
            "torque": Parameter(0.0, "F", "T_f: torque at which the flexspline is twice as stiff", lower=0.0),
            "x_f": Parameter(1e-3, "x", "T_f over the flexspline's stiffness", lower=1e-12, scale="stroke"),
            "x_w": Parameter(5e-4, "x", "largest deflection of the wave generator", lower=1e-12, scale="stroke"),
            "c": Parameter(1.0, "1", "T_f over T_w", lower=1e-3, upper=1e3, scale="number"),
        },
        linear=("torque",),
        reads=("q",),
        step=step,
        holds=("conservative", "odd"),
        places=("joint",),
        at="joint",
        border=Border(
            parameters={
                "flexspline_stiffness": Parameter(1e4, "F/x", "flexspline stiffness, unloaded", lower=1e-12),
                "flexspline_torque": Parameter(10.0, "F", "torque at which it has doubled", lower=1e-12),
                "generator_stiffness": Parameter(1e5, "F/x", "wave-generator stiffness at the output", lower=1e-12),
                "generator_torque": Parameter(10.0, "F", "torque at which it has grown e-fold", lower=1e-12),
            },
            inward=inward,
            outward=outward,
        ),
    )

"""The nonlinear program of one amplitude, in CasADi: built once, solved for every amplitude by its parameters.

In units of the sample (torque J/Ts^2 per displacement) no plant scales it. With the natural frequency w_n^2 = Kp + k_e and
the free final time tau = w_n T as variables, most limits are bounds:

    minimise    log tau - log w_n                        T, when the response enters the band to stay
    over        log w_n    >= that of Kp = 0, of the error; <= of the drive
                log tau    >= that of the overshoot
    subject to  Kd = 2 zeta w_n - b - loss/w_n >= 0      zeta(tau): see `curve`
                log(Kp/w_n) + log(peak speed) <= log(limit/A)
                Re(conj(d_i) (1 + L(theta_i))) >= 1/Ms   linear in Kp and Kd

|1 + L| >= 1/Ms is a region with a hole, on whose far side loops are unstable. Its half-plane along d_i = the direction of
1 + L of a stable loop lies within it and is exact where the solution meets it; `solve` turns d_i until it does (convex-
concave procedure: Hast, Astrom, Bernhardsson, Boyd 2013).
"""

from functools import cache

import numpy as np

from workbench.tuning.curve import DEGREE, clenshaw

FREQUENCIES = 48
OPTIONS = {
    "print_time": False,
    "calc_lam_p": False,
    "error_on_fail": False,
    "ipopt": {
        "print_level": 0,
        "sb": "yes",
        "max_iter": 100,
        "tol": 1e-8,
        "acceptable_iter": 0,
        "mu_init": 1e-8,
        "bound_push": 1e-9,
        "bound_frac": 1e-9,
        "bound_relax_factor": 0.0,
        "nlp_scaling_method": "none",
    },
}


def half_planes(position: np.ndarray, speed: np.ndarray, kp: np.ndarray, kd: np.ndarray) -> np.ndarray:
    """Return (n, f, 3): rows [1, Kp, Kd] . row = Re(conj(d) (1 + L)), d the direction of 1 + L at (kp, kd), L = Kp position
    + Kd speed, responses (n, f)."""
    back = 1.0 + kp[:, None] * position + kd[:, None] * speed
    back = back.conj() / np.abs(back)
    return np.stack([back.real, (back * position).real, (back * speed).real], axis=-1)


@cache
def solver(frequencies: int = FREQUENCIES):
    """Return the compiled problem over x = [log w_n, log tau].

    p = [stiffness, loss, damping, weight, range of log tau (2), Chebyshev coefficients (2 x), half-planes row by row];
    weight 1: shortest time. 0: largest w_n, which says how small the error can be.
    g = [Kd/w_n, log of the peak speed over A/Ts, Re(conj(d) (1 + L)) at each frequency]
    """
    import casadi as ca

    x, p, ends = ca.SX.sym("x", 2), ca.SX.sym("p", 4), ca.SX.sym("ends", 2)
    shapes, rows = ca.SX.sym("shapes", DEGREE + 1, 2), ca.SX.sym("rows", 3, frequencies)
    stiffness, loss, damping, weight = ca.vertsplit(p)
    omega, place = ca.exp(x[0]), (2.0 * x[1] - ends[0] - ends[1]) / (ends[1] - ends[0])
    zeta, speed = ca.exp(clenshaw(ca.vertsplit(shapes[:, 0]), place)), clenshaw(ca.vertsplit(shapes[:, 1]), place)
    kp = omega**2 - stiffness
    kd = 2.0 * zeta * omega - damping - loss / omega
    g = ca.vertcat(kd / omega, ca.log(kp) - x[0] + speed, rows.T @ ca.vertcat(1.0, kp, kd))
    f = weight * x[1] - x[0]
    nlp = {"x": x, "p": ca.vertcat(p, ends, ca.vec(shapes), ca.vec(rows)), "f": f, "g": g}
    return ca.nlpsol("gains", "ipopt", nlp, OPTIONS)

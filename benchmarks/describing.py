"""How long a thousand describing functions take, beside their closed form and an adaptive quadrature."""

from math import cos, expm1, pi

import numpy as np
from scipy.integrate import quad
from scipy.special import ive

from benchmarks._timing import milliseconds
from workbench.definition import find
from workbench.description import equivalent

H0, A0 = 0.15, 636.0  # N*m, 1/rad
AMPLITUDES = np.geomspace(1e-5, 1.0, 1000)  # rad


def closed() -> None:
    """Bessel functions, vectorised; they know d = 1 only."""
    z = A0 * AMPLITUDES / 2.0
    _ = 2.0 * H0 * A0 * ive(1, z) / z, 4.0 * H0 * A0 / pi * np.sqrt(pi / (2.0 * z)) * ive(1.5, z)


def adaptive() -> None:
    """scipy's quad of the two integrals, to the same 1e-10, one amplitude after the other."""

    def y(u):
        return -H0 * expm1(-A0 * u)

    for a in AMPLITUDES:
        quad(lambda t, a=a: y(a / 2.0 * (1.0 - cos(t))) * cos(t), 0.0, pi, epsabs=0.0, epsrel=1e-10, limit=200)
        quad(lambda u, a=a: y(u) - u / a * y(a), 0.0, a, epsabs=0.0, epsrel=1e-10, limit=200)


def main() -> None:
    """Print milliseconds for 1000 amplitudes, and ratios to the integrals of the workbench."""
    effect = find("presliding_hysteresis")(h0=H0, x0=1.0 / A0)
    ours = milliseconds(lambda: equivalent(effect, AMPLITUDES), 101)
    print(f"{AMPLITUDES.size} describing functions of one virgin curve, k_e and c_e w, median:")
    for name, time in (
        ("workbench, any exponent d", ours),
        ("Bessel closed form, d = 1", milliseconds(closed, 101)),
        ("scipy quad to 1e-10", milliseconds(adaptive, 3)),
    ):
        print(f"  {name:<28}{time:10.3f} ms {time / ours:10.2f} x")


if __name__ == "__main__":
    main()

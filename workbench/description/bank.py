"""The describing function of a bank of stop operators in closed form: what a Maxwell-slip bank of n elements does."""

import numpy as np

from workbench.description.result import Equivalent, positive


def bank_equivalent(k: np.ndarray, slip: np.ndarray, amplitudes) -> Equivalent:
    """Return the first harmonic of sum_i k_i x_i, x_i <- clip(x_i + dq, -D_i, D_i), under q = A cos(w t); exact.

    k (m,): stiffnesses, N*m/rad or N/m. slip (m,): D_i, rad or m. amplitudes (n,): A, rad or m, zero to peak. An element
    that does not slip (A <= D) is a spring. Else, with psi = acos(1 - 2 D/A), the angle that it travels before it slips,

        k_e = k (psi - sin(2 psi)/2)/pi,   c_e w = k (4 D/(pi A)) (1 - D/A)

    where the loss is the area of the parallelogram loop, 4 k D (A - D), over pi A^2. The elements add, since each meets the
    same motion (Al-Bender, Symens, Swevers, Van Brussel 2004). psi is computed as 2 asin(sqrt(D/A)), which keeps its
    digits where A is much larger than D.
    """
    amplitudes = positive(amplitudes)
    share = np.minimum(np.asarray(slip, dtype=float) / amplitudes[:, None], 1.0)
    psi = 2.0 * np.arcsin(np.sqrt(share))
    stiffness = (psi - np.sin(2.0 * psi) / 2.0) / np.pi
    loss = 4.0 / np.pi * share * (1.0 - share)
    k = np.asarray(k, dtype=float)
    return Equivalent(amplitudes, (k * stiffness).sum(axis=1), (k * loss).sum(axis=1))

"""The spectrum of a residual over position, in which what is periodic in an angle is a line, and its peaks."""

from collections.abc import Sequence

import numpy as np

from workbench.inverse.dynamics import InverseDynamics

BINS = 1 << 14  # of position, for the spectrum over angle
PEAKS = 4  # orders named at most, the largest first


def order_spectrum(
    inverses: Sequence[InverseDynamics], residuals: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return (orders, amplitude): |sum r exp(-i k q)| 2/N over all records, k in 1/x up to half the bins.

    residuals: (n,) each, zero where nothing counts. Padded four times, so that a peak is found within a quarter of the
    resolution 2 pi/travel.
    """
    low = min(float(p.motion.q.min()) for p in inverses)
    high = max(float(p.motion.q.max()) for p in inverses)
    width = max(high - low, 1e-300) / BINS
    total = np.zeros(BINS)
    for p, r in zip(inverses, residuals, strict=True):
        index = np.clip(((p.motion.q - low) / width).astype(int), 0, BINS - 1)
        # a dwell would put many samples into one bin: weigh samples by the distance they cover
        weight = np.abs(p.motion.v) * p.motion.dt / width
        total += np.bincount(index, weights=r * np.minimum(weight, 1.0), minlength=BINS)
    spectrum = np.abs(np.fft.rfft(total, 4 * BINS))
    orders = 2 * np.pi * np.arange(spectrum.size) / (4 * BINS * width)
    return orders, 2 * spectrum / max(np.count_nonzero(total), 1)


def peaks(orders: np.ndarray, amplitude: np.ndarray, travel: float, most: float = np.inf) -> list[float]:
    """Return the orders of the largest local maxima with at least one period in the travel, and no higher than `most`."""
    middle = orders[1:-1]
    inside = np.flatnonzero(
        (amplitude[1:-1] > amplitude[:-2])
        & (amplitude[1:-1] >= amplitude[2:])
        & (middle * travel > 2 * np.pi)
        & (middle <= most)
    )
    best = sorted(inside + 1, key=lambda i: -amplitude[i])[: 4 * PEAKS]
    chosen: list[float] = []
    for i in best:  # a lobe of a larger peak is no order of its own
        if all(abs(orders[i] - c) * travel > 4 * np.pi for c in chosen):
            chosen.append(float(orders[i]))
    return chosen[:PEAKS]

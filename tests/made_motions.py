"""Motions in closed form for tests that measure what a fit says of noise."""

import numpy as np

SINES = ((1.0, 0.4), (0.2, 1.7), (0.03, 5.0))  # rad, Hz: slow and fast, large and small


def sines(rng: np.random.Generator, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (q, v, a), (n,) each: SINES, each within a tenth of its frequency and with a phase of its own."""
    q, v, a = np.zeros((3, t.size))
    for amplitude, frequency in SINES:
        w, phase = 2 * np.pi * frequency * rng.uniform(0.9, 1.1), rng.uniform(0, 2 * np.pi)
        q += amplitude * np.sin(w * t + phase)
        v += amplitude * w * np.cos(w * t + phase)
        a -= amplitude * w**2 * np.sin(w * t + phase)
    return q, v, a

"""From the rate of the integration to that of a log, the low pass under which errors are compared, and noise."""

from functools import cache

import numpy as np


@cache
def decimation(per_sample: int) -> np.ndarray:
    """A low pass of linear phase, eight samples long, flat to a quarter of the log rate: Blackman's window on a sinc."""
    n = np.arange(-4 * per_sample, 4 * per_sample + 1)
    taps = np.sinc(0.8 / per_sample * n) * np.blackman(n.size)
    return taps / taps.sum()


def decimated(x: np.ndarray, per_sample: int) -> np.ndarray:
    """Samples at the log rate, group delay compensated. The signal goes on as it begins and ends."""
    taps = decimation(per_sample)
    half = taps.size // 2
    padded = np.concatenate([np.full(half, x[0]), x, np.full(half, x[-1])])
    size = 1 << (padded.size + taps.size - 1).bit_length()
    smooth = np.fft.irfft(np.fft.rfft(padded, size) * np.fft.rfft(taps, size), size)[2 * half : 2 * half + x.size]
    return smooth[::per_sample].copy()


def low_pass(x: np.ndarray, rate: float, band: float, derivative: int = 0) -> np.ndarray:
    """1/(1 + (f/band)^8) without phase; about 0.1 s at the ends are not to be used."""
    pad = min(round(0.5 * rate), x.size - 1)
    extended = np.concatenate([2 * x[0] - x[pad:0:-1], x, 2 * x[-1] - x[-2 : -pad - 2 : -1]])
    f = np.fft.rfftfreq(extended.size, 1 / rate)
    spectrum = np.fft.rfft(extended) * (2j * np.pi * f) ** derivative / (1 + (f / band) ** 8)
    return np.fft.irfft(spectrum, extended.size)[pad : pad + x.size]


def noise(rng, n: int, rms: float, rate: float, band: float, memory: float = 0.0) -> np.ndarray:
    """Noise (n,) of this rms in the band: white at the log rate, or with a correlation that falls by e in `memory` s."""
    f = np.linspace(0.0, rate / 2, 8001)
    keep = np.exp(-1 / (memory * rate)) if memory > 0.0 else 0.0
    power = (1 - keep) ** 2 / (1 - 2 * keep * np.cos(2 * np.pi * f / rate) + keep**2)
    scale = rms / np.sqrt(np.mean(power / (1 + (f / band) ** 8) ** 2))
    white = scale * rng.standard_normal(n)
    if keep == 0.0:
        return white
    f = np.fft.rfftfreq(n, 1 / rate)
    return np.fft.irfft(np.fft.rfft(white) * (1 - keep) / (1 - keep * np.exp(-2j * np.pi * f / rate)), n)

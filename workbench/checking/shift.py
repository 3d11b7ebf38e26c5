"""By how much the drive in a log is shifted in time against the motion that it causes."""

from dataclasses import replace

import numpy as np

from workbench.checking.balance import Balance

# A drive answers within a millisecond (sampling, computation, pulse widths, current loop): what is later is the log's.
LATE = 1.5e-3  # s, and as many samples
FARTHEST = 50e-3  # s
BETTER = 0.7  # of the residual that is left at the best shift: a smaller gain is any model's lack
LEAST = 0.05  # share of the drive's power that may be left at the best shift: else it is something else that is wrong
INERTIAL = 0.3  # share of the drive that inertia must have: only there is a moment sharp
# Share of a record's power, below which a half of it says nothing of the shift of the whole. Of 18 axes of which a record looks shifted, two lack a law and
# a line shakes one. Halved, a true delay is not said of one record; doubled, none changes
QUIET = 0.1


def _lags(b: Balance) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (shifts (k,) in samples, residual powers (k,), parameters (p, k)): the drive taken that much later."""
    far = min(round(FARTHEST / b.dt), b.drive.size // 4)
    size = 1 << (2 * b.drive.size - 1).bit_length()
    forward = np.fft.rfft(b.drive - np.mean(b.drive), size)
    spectra = np.conj(np.fft.rfft(b.columns, size, axis=0)) * forward[:, None]
    correlation = np.fft.irfft(spectra, size, axis=0)
    shifts = np.arange(-far, far + 1)
    moments = correlation[shifts % size].T
    parameters = b.solved(moments)
    return shifts, b.power - np.einsum("pk,pk->k", moments, parameters), parameters


def delay(b: Balance, inertia: str) -> float:
    """Return the s by which the drive comes late in the log, 0 where no shift is plainly better.

    inertia: name of the column whose share says whether a moment is sharp.
    """
    shifts, left, parameters = _lags(b)
    zero, best = int(np.flatnonzero(shifts == 0)[0]), int(np.argmin(left))
    if inertia not in b.names or best in (0, shifts.size - 1):
        return 0.0
    late = abs(shifts[best]) * b.dt
    sharp = b.share(inertia, parameters[:, best]) > INERTIAL
    plain = late > max(LATE, 1.5 * b.dt) and left[best] < min(BETTER * left[zero], LEAST * b.power) and sharp
    return float(shifts[best] * b.dt) if plain and _in_halves(b, int(shifts[best])) else 0.0


def _in_halves(b: Balance, shift: int) -> bool:
    """Whether each half of a record, by itself, leaves less of a drive taken so many samples later: a line of the spectrum beside slow moves
    has a moment of its own in either.
    """
    for half in (h for h in b.halves() if h.power >= QUIET * b.power):
        shifts, left, _ = _lags(half)
        if abs(shift) <= shifts[-1] and not left[shift + shifts[-1]] < left[shifts[-1]]:
            return False
    return True


def realigned(b: Balance, late: float) -> Balance:
    """Return the balance with the drive moved back by `late` s; samples that would wrap round are left out."""
    shift = round(late / b.dt)
    if not shift:
        return b
    inside = slice(abs(shift), b.drive.size - abs(shift))
    return replace(b, drive=np.roll(b.drive, -shift)[inside], columns=b.columns[inside])

"""The time axis of a record: it increases, at one rate, or it is resampled and that is said."""

from collections.abc import Callable, Mapping

import numpy as np

from workbench.errors import UnsoundRecord
from workbench.finding import Finding
from workbench.readers import wording

# Samples of a record. Doubled, two measured axes (a master arm, a base joint) whose logs are cut at every turn are refused; of fewer the evaluation
# filter leaves next to nothing
FEWEST = 50
TOLERANCE = 0.01  # of the median step
LONGEST_GAP = 10  # median steps; what lies in a longer gap is not measured, and a straight line is not it
GAP = 1.5  # median steps, from which a sample is missing; what of it counts, the evaluation band says
WORTH = 0.1  # of a log: what is shorter between two gaps is left out, so that no log makes more than ten records
DECIMALS = 9  # of a second, the finest that a stamp is rounded to; a nanosecond lies within any rate's 1 %
THIRDS = 20  # by which the step of rounded stamps is narrowed down, to a thousandth of what a digit at a record's end makes of it


def uniform(
    name: str,
    time: np.ndarray,
    channels: Mapping[str, np.ndarray],
    place: Callable[[int], str],
    *,
    resample: bool = False,
) -> tuple[np.ndarray, Mapping[str, np.ndarray], Finding | None]:
    """Return time, channels and a finding where they were resampled.

    time: (n,) s. channels: name -> (n,). place: sample number -> "file, row". Every step must be within 1 % of the median
    step, or the stamps be those of one rate, rounded to the digits that they were written with: then the rate's own are
    returned. With resample=True, channels are interpolated linearly at the median step from the first sample on, and the
    finding (kind "resampled", subject `name`) says how many steps were off and the longest. Raises UnsoundRecord with
    file and row for time that does not increase, a step that is off, and a gap longer than ten steps.
    """
    steps = _increasing(name, time, place)
    median = float(np.median(steps))
    off = np.flatnonzero(np.abs(steps - median) > TOLERANCE * median)
    if not off.size:
        return time, channels, None
    if (even := unrounded(time)) is not None:
        return even, channels, None
    worst = int(np.argmax(steps))
    if steps[worst] > LONGEST_GAP * median:
        raise UnsoundRecord(
            f"{place(worst + 1)}: a gap of {steps[worst]:.6g} s in time, {steps[worst] / median:.0f} median steps of "
            f"{median:.6g} s; split the record there into two files, or into two records by 'until' and 'from'"
            + (", of which each is long enough." if resample else ", or allow resampling (--resample), which does."),
            "dropped samples",
            name,
        )
    if not resample:
        k = int(off[0])
        raise UnsoundRecord(
            f"{place(k + 1)}: the time step is {steps[k]:.6g} s and the median step {median:.6g} s, more than 1 % apart "
            f"({off.size} of {steps.size} steps are); log at one rate, or allow resampling (--resample).",
            "dropped samples",
            name,
        )
    return _resampled(name, time, channels, median, off.size)


def stretches(time: np.ndarray) -> list[slice]:
    """Return the samples between gaps of more than ten median steps in a clock (n,), s: of each stretch that is worth a record; all of them
    where none is, or where there is no gap."""
    steps = np.diff(time)
    median = float(np.median(steps)) if steps.size else 0.0
    cuts = [int(k) + 1 for k in np.flatnonzero(steps > LONGEST_GAP * median)] if median > 0.0 else []
    found = [slice(a, b) for a, b in zip([0, *cuts], [*cuts, time.size], strict=True)]
    worth = [s for s in found if s.stop - s.start >= max(FEWEST, WORTH * time.size)]
    return worth or [slice(0, time.size)]


def gaps(time: np.ndarray) -> tuple[tuple[float, float], ...]:
    """Return the spans, s, between samples of a clock (n,) that are more than GAP median steps apart."""
    steps = np.diff(time)
    return tuple((float(time[k]), float(time[k + 1])) for k in np.flatnonzero(steps > GAP * np.median(steps)))


def _increasing(name: str, time: np.ndarray, place: Callable[[int], str]) -> np.ndarray:
    """Return the steps (n - 1,) of a time that increases; UnsoundRecord of one that does not, or is too short."""
    if time.size < FEWEST:
        raise UnsoundRecord(
            f"{place(time.size - 1)}: the record ends after {time.size} samples; at least {FEWEST} are needed, so "
            "measure longer.",
            "short record",
            name,
        )
    with np.errstate(over="ignore"):  # an infinite step is a gap
        steps = np.diff(time)
    back = np.flatnonzero(steps <= 0)
    if back.size:
        k = int(back[0]) + 1
        raise UnsoundRecord(
            f"{place(k)}: time does not increase ({time[k - 1]:.9g} s, then {time[k]:.9g} s); sort the rows, or split "
            "the record where the clock restarts.",
            "time",
            name,
        )
    return steps


def unrounded(time: np.ndarray) -> np.ndarray | None:
    """Return the instants (n,) of one rate of which `time` holds the roundings to its last decimal, or None where it does not.

    A log of 1200 Hz with five decimals has steps of 0.83 and 0.84 ms. No stamp may lie farther from its instant than half of the last digit, so that a
    sample that was dropped, or late by a digit, is none of this.
    """
    digit = next(
        (
            10.0**-k
            for k in range(DECIMALS)
            if np.allclose(time * 10.0**k, np.round(time * 10.0**k), rtol=0.0, atol=1e-4)
        ),
        None,
    )
    if digit is None:
        return None
    number = np.arange(time.size)
    step = _evenest(time, digit)
    # a rate or a period is a round number as a rule, and then it is that one
    for each in (1.0 / float(f"{1.0 / step:.4g}"), float(f"{step:.4g}"), step):
        off = time - each * number
        if np.ptp(off) <= 1.01 * digit:
            return each * number + 0.5 * (off.min() + off.max())
    return None


def _evenest(time: np.ndarray, digit: float) -> float:
    """Return the step, s, whose multiples come nearest to stamps (n,) by the largest distance: a straight line of least squares leans where ties
    round up in one half of a record and down in the other. The distance is convex in the step."""
    number, mean = np.arange(time.size), float(np.mean(np.diff(time)))
    low, high = (mean + way * 2.0 * digit / (time.size - 1) for way in (-1.0, 1.0))
    for _ in range(THIRDS):
        a, b = low + (high - low) / 3.0, high - (high - low) / 3.0
        low, high = (low, b) if np.ptp(time - a * number) < np.ptp(time - b * number) else (a, high)
    return 0.5 * (low + high)


def _resampled(name, time, channels, step, off):
    # The last instant is kept where rounding alone would lose it.
    count = int(np.floor((time[-1] - time[0]) / step + 1e-6)) + 1
    even = np.minimum(time[0] + step * np.arange(count), time[-1])
    longest = float(np.diff(time).max())
    finding = wording.resampled(name, step, off, time.size - 1, longest, len(gaps(time)))
    return even, {n: np.interp(even, time, c) for n, c in channels.items()}, finding

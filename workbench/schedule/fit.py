"""fit_schedule: from gains at amplitudes to a schedule at knots; fewest_knots: the shortest one that is close enough."""

from dataclasses import replace

import numpy as np

from workbench.control import grid
from workbench.errors import WorkbenchError
from workbench.schedule import shape, wording
from workbench.schedule.table import Schedule
from workbench.threads import one_thread
from workbench.tuning.gains import check_gains

REVERSAL = 2.5  # encoder counts: three back are a reversal; between counts, so that no rounding decides
DENSE = 8  # amplitudes a segment at which the schedule is held against the tuned gains
PER_OCTAVE = (1, 2, 4, 8, 16)


@one_thread
def fit_schedule(
    gains,
    *,
    loop,
    per_octave: int = 4,
    lowest: float | None = None,
    highest: float | None = None,
    monotone: bool = True,
    slope: tuple[float, float] = (-2.5, 0.5),
    tolerance: float = 0.02,
    rule: str = "frozen",
    plant_digest: str = "",
    plant_lines: tuple[str, ...] = (),
) -> Schedule:
    """Return the schedule whose gains, linear between knots, are closest to tuned ones in the least squares of their logs.

    gains: amplitude, kp, kd (n,) and, where it has it, binding (n names each), SI; between amplitudes they are taken straight
    in log-log. loop: sample_time, s, and resolution, rad or m. per_octave: knots an octave, a power of two. lowest, highest:
    range of amplitudes, within that of `gains` (default: all of it); the knots enclose it. monotone: gains never rise with
    amplitude. slope: bounds of d log gain/d log amplitude from knot to knot. Where the sensitivity stops the tuned gains
    they are not exceeded. tolerance: a larger interpolation error is a finding.
    WorkbenchError: no such knots, range or shape; gains that are not positive.
    """
    _checked(gains, slope, tolerance)
    lowest, highest = _within(gains, lowest, highest)
    knots = grid(lowest, highest, per_octave)
    kp, kd, error, at = _fitted(gains, knots, lowest, highest, monotone, slope)
    findings = ()
    if error > tolerance:
        findings = (wording.coarse(error, at, tolerance, knots.size, monotone),)
    return Schedule(
        knots,
        kp,
        kd,
        per_octave,
        rule,
        REVERSAL * loop.resolution,
        loop.sample_time,
        plant_digest,
        tuple(plant_lines),
        error,
        findings,
    )


def fewest_knots(gains, *, loop, tolerance: float = 0.02, lowest=None, highest=None, **options) -> Schedule:
    """Return the schedule of fewest knots whose interpolation error is at most `tolerance`, over lowest to highest.

    Knots an octave are doubled until they are close enough; knots at the small end, where gains hardly change, are then left
    out as long as they stay so. Other arguments as fit_schedule. WorkbenchError where the finest grid is not close enough.
    """
    for per_octave in PER_OCTAVE:
        best = fit_schedule(
            gains, loop=loop, per_octave=per_octave, tolerance=tolerance, lowest=lowest, highest=highest, **options
        )
        if best.interpolation_error <= tolerance:
            break
    else:
        raise WorkbenchError(
            f"{PER_OCTAVE[-1]} knots an octave leave {best.interpolation_error:.2%} to the tuned gains, more than "
            f"{tolerance:.2%}; the shape (monotone, slope) does not allow them. Allow more, or tune at more amplitudes."
        )
    low, high = _within(gains, lowest, highest)
    monotone, slope = options.get("monotone", True), options.get("slope", (-2.5, 0.5))
    fewest, most = 0, best.knots.size - 2  # knots that may go, knots that may not
    while fewest < most:
        gone = (fewest + most + 1) // 2
        kp, kd, error, _ = _fitted(gains, best.knots[gone:], low, high, monotone, slope)
        if error <= tolerance:
            fewest, kept = gone, (kp, kd, error)
        else:
            most = gone - 1
    if fewest == 0:
        return best
    return replace(best, knots=best.knots[fewest:], kp=kept[0], kd=kept[1], interpolation_error=kept[2])


def _fitted(gains, knots, lowest: float, highest: float, monotone: bool, slope):
    """Return (kp, kd, error, amplitude of the error): the fit over the range, and its distance from the tuned gains."""
    dense = _dense_set(gains, knots, lowest, highest)
    step = np.diff(np.log(knots))
    low, high = slope[0] * step, (min(slope[1], 0.0) if monotone else slope[1]) * step
    stopped = _stopped(gains, dense)
    inside = np.clip(dense, knots[0], knots[-1])
    fitted, errors = [], []
    for column in (gains.kp, gains.kd):
        wanted = np.exp(np.interp(np.log(dense), np.log(gains.amplitude), np.log(column)))
        found = shape.fit(knots, inside, wanted, low, high, stopped)
        fitted.append(np.minimum.accumulate(found) if monotone else found)
        errors.append(np.abs(shape.interpolation(knots, inside) @ fitted[-1] / wanted - 1.0))
    worst = np.maximum(*errors)
    return *fitted, float(worst.max()), float(dense[worst.argmax()])


def _dense_set(gains, knots: np.ndarray, lowest: float, highest: float) -> np.ndarray:
    """Return amplitudes (n,), increasing: DENSE a segment, and those of the gains, within lowest to highest."""
    share = np.arange(DENSE) / DENSE
    inner = (knots[:-1, None] + np.diff(knots)[:, None] * share).ravel()
    before = np.geomspace(lowest, knots[0], DENSE) if lowest < knots[0] else np.empty(0)
    every = np.concatenate([before, inner, gains.amplitude, [lowest, highest]])
    return np.unique(every[(every >= lowest) & (every <= highest)])


def _stopped(gains, dense: np.ndarray) -> np.ndarray:
    """Return where the sensitivity stops the gains at the tuned amplitudes on both sides, (n,) of bool."""
    binding = getattr(gains, "binding", None) or ((),) * gains.amplitude.size
    held = np.array(["sensitivity" in b for b in binding])
    i = np.clip(np.searchsorted(gains.amplitude, dense, side="right") - 1, 0, gains.amplitude.size - 2)
    return held[i] & held[i + 1]


def _checked(gains, slope, tolerance: float) -> None:
    """Raise WorkbenchError unless gains are positive at two or more amplitudes, and slope and tolerance make sense."""
    check_gains(gains.amplitude, gains.kp, gains.kd)
    if gains.amplitude.size < 2 or not ((gains.kp > 0.0).all() and (gains.kd > 0.0).all()):
        raise WorkbenchError("a schedule needs positive gains at two or more amplitudes.")
    if not slope[0] < slope[1] or not slope[0] < 0.0:
        raise WorkbenchError(
            f"slope bounds are {slope[0]:g} to {slope[1]:g}; the lower must be negative and below the upper."
        )
    if not tolerance > 0.0:
        raise WorkbenchError(f"the tolerance of the schedule is {tolerance:g}; it must be positive.")


def _within(gains, lowest: float | None, highest: float | None) -> tuple[float, float]:
    """Return the range of amplitudes; WorkbenchError where it is empty or no gains were tuned for it."""
    first, last = float(gains.amplitude[0]), float(gains.amplitude[-1])
    lowest, highest = first if lowest is None else float(lowest), last if highest is None else float(highest)
    if not first <= lowest < highest <= last:
        raise WorkbenchError(
            f"schedule from {lowest:g} to {highest:g}: it must lie within the amplitudes of the gains, {first:g} to {last:g}."
        )
    return lowest, highest

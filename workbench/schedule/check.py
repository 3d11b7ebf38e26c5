"""What a schedule is worth between its knots, where nothing was tuned, and whether moving gains feed energy in."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from workbench.control.notched import behind
from workbench.finding import Finding
from workbench.schedule import wording
from workbench.schedule.table import Schedule
from workbench.threads import one_thread
from workbench.tuning import sampled
from workbench.tuning.axis import Axis

LOOSE = 1.005  # of the sensitivity limit: what tuning itself allows
NODES = 400


@dataclass(frozen=True)
class BetweenKnots:
    """amplitude, sensitivity_peak, spectral_radius (n,), on the exact sampled loop; the worst of each, and where."""

    amplitude: np.ndarray
    sensitivity_peak: np.ndarray
    spectral_radius: np.ndarray
    findings: tuple[Finding, ...]

    @property
    def worst_sensitivity(self) -> tuple[float, float]:
        """(peak, amplitude)"""
        return self._worst(self.sensitivity_peak)

    @property
    def worst_radius(self) -> tuple[float, float]:
        """(spectral radius, amplitude)"""
        return self._worst(self.spectral_radius)

    def _worst(self, values: np.ndarray) -> tuple[float, float]:
        i = int(values.argmax())
        return float(values[i]), float(self.amplitude[i])


@one_thread
def between_knots(
    schedule: Schedule,
    equivalent_at: Callable[[np.ndarray], object],
    inertia: float,
    loop,
    *,
    viscous: float = 0.0,
    sensitivity: float = 2.0,
    points: int = 8,
) -> BetweenKnots:
    """Return sensitivity peak and stability of the linear axis under scheduled gains, at `points` amplitudes a segment, the
    schedule's notch in the loop.

    equivalent_at(amplitudes (n,)) -> amplitude, stiffness, loss (n,), SI, as workbench.description gives them. inertia:
    kg*m^2 or kg. viscous: N*m*s/rad or N*s/m. A peak above `sensitivity` by 0.5 %, or an eigenvalue outside the unit circle,
    is a finding.
    """
    share = np.arange(points) / points
    amplitude = np.append(
        (schedule.knots[:-1, None] + np.diff(schedule.knots)[:, None] * share).ravel(), schedule.knots[-1]
    )
    axis = Axis.of(equivalent_at(amplitude), inertia, viscous, loop).behind(schedule.numbers)
    kp, kd = schedule.gains(amplitude)
    kp, kd = kp / axis.unit_kp, kd / axis.unit_kd
    motion = axis.steps(kp)
    peak, _ = sampled.sensitivity_peak(kp, kd, motion, axis.clock)
    radius = sampled.spectral_radius(kp, kd, motion, axis.clock)
    out = BetweenKnots(amplitude, peak, radius, ())
    findings = () if out.worst_radius[0] < 1.0 else (wording.unstable(*out.worst_radius),)
    if out.worst_sensitivity[0] > sensitivity * LOOSE:
        findings = (*findings, wording.exceeded(*out.worst_sensitivity, sensitivity))
    return replace(out, findings=findings)


@dataclass(frozen=True)
class Passivity:
    """amplitude, damping, pumping (n,), N*m/rad or N/m: c_e w + w (b + Kd), and the quadrature kq of a moving Kp."""

    amplitude: np.ndarray
    damping: np.ndarray
    pumping: np.ndarray
    findings: tuple[Finding, ...]


def pumping(schedule: Schedule, amplitude: np.ndarray) -> np.ndarray:
    """Return kq (n,), the negative damping of gains that fall along the stroke, exact for gains linear between knots.

        kq = (2/pi) Int_0^pi Kp(s) cos(f) sin(f) df,  s/2 = A (1 - cos f)/2 = A x
           = (4/pi) Int_0^1 Kp(A x) (1 - 2 x) dx

    with Kp looked up at half the stroke s since the reversal. The integrand is quadratic in each segment, for which Simpson's
    rule is exact.
    """
    out = np.empty(amplitude.size)
    for i, a in enumerate(amplitude):
        x = np.concatenate([[0.0], schedule.knots[schedule.knots < a] / a, [1.0]])
        middle, width = (x[1:] + x[:-1]) / 2.0, np.diff(x)
        ends, centre = (schedule.gains(a * p)[0] * (1.0 - 2.0 * p) for p in (x, middle))
        out[i] = 4.0 / np.pi * (width * (ends[:-1] + 4.0 * centre + ends[1:]) / 6.0).sum()
    return out


def _damped(schedule: Schedule, kp: np.ndarray, kd: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Return the quadrature (n,) of a law at w: w Kd, and with a notch N behind it Im N (Kp + i w Kd), which lags below its centre."""
    passed = 1.0 if schedule.numbers is None else behind(schedule.numbers, omega * schedule.sample_time)
    return np.imag(passed * (kp + 1j * omega * kd))


def passivity(
    schedule: Schedule, equivalent_at: Callable[[np.ndarray], object], inertia: float, *, viscous: float = 0.0
) -> Passivity:
    """Return whether damping outweighs what moving gains feed in: c_e w + w (b + Kd) - kq > 0 at each knot.

    w = sqrt((Kp + k_e)/J); Kp is its mean over a half cycle weighted by cos^2, Kd that weighted by sin^2, as the first harmonic
    of the command has them. Gains that are frozen between reversals feed nothing in. Arguments as between_knots.
    """
    amplitude = schedule.knots
    equivalent = equivalent_at(amplitude)
    angle = np.pi * (np.arange(NODES) + 0.5) / NODES
    moving = schedule.rule == "following"
    kp, kd = schedule.gains(
        amplitude[:, None] * (1.0 - np.cos(angle)) / 2.0 if moving else amplitude[:, None] + 0.0 * angle
    )
    weight = 2.0 / NODES * np.sin(angle) ** 2
    omega = np.sqrt(((kp * 2.0 / NODES * np.cos(angle) ** 2).sum(axis=1) + equivalent.stiffness) / inertia)
    damping = (
        equivalent.loss
        + omega * viscous
        + _damped(schedule, (kp * 2.0 / NODES * np.cos(angle) ** 2).sum(axis=1), kd @ weight, omega)
    )
    fed = pumping(schedule, amplitude) if moving else np.zeros(amplitude.size)
    i = int((fed / damping).argmax())
    said = wording.passive(float(damping[i]), float(fed[i]), float(amplitude[i]), moving=moving)
    return Passivity(amplitude, damping, fed, (said,))

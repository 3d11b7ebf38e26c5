"""Gains within what a measured frequency response allows: modes that the model of one mass does not have."""

from dataclasses import dataclass, replace

import numpy as np

from workbench.frequency import Response, sensitivity_peak
from workbench.tuning import sampled, wording
from workbench.tuning.gains import Gains
from workbench.tuning.goal import TuningGoal
from workbench.tuning.tuning import tune

ROUNDS = 4  # of tuning below a cap on Kp, each closer to what the response allows
BELOW = 0.98  # of what the response allows: Kd is the program's own, and need not fall with Kp as it is taken to
SLOWEST, STEPS, HALVINGS = (
    0.02,
    80,
    16,
)  # of the search for s: where it begins, its grid, and how the first fault is closed in
APPROXIMATE = 0.01  # by which the measured |S| may exceed the bound: the hold is not exact on a measured response


def law_of(kp: float, kd: float, response: Response, clock: sampled.Clock) -> np.ndarray:
    """Return the response of u = Kp e - Kd vh on the sampled loop, position to drive: held over a sample, and delayed."""
    theta = response.omega * clock.sample_time
    held = np.sinc(theta / (2 * np.pi)) * np.exp(-1j * theta * (0.5 + clock.whole + clock.part))
    return (kp + kd / clock.sample_time * sampled.difference(theta, clock)) * held


@dataclass(frozen=True)
class Place:
    """One amplitude, SI: the gains there, the axis' equivalent stiffness and loss, and its inertia."""

    kp: float
    kd: float
    stiffness: float
    loss: float
    inertia: float

    def beside(self, omega: np.ndarray) -> np.ndarray:
        """Return what acts beside the response, drive over position: k_e + i w loss/w_n, w_n that of these gains.

        One and the same for all slower gains: only of one plant does a path of gains that never meets -1 tell stability.
        """
        natural = np.sqrt((self.kp + self.stiffness) / self.inertia)
        return self.stiffness + 1j * omega * self.loss / natural


def _slower(place: Place, response: Response, clock: sampled.Clock, sensitivity: float) -> float:
    """Return the largest s <= 1 for which (s'^2 Kp, s' Kd), as damped and slower by s', keep |S| within bounds for all s' <= s.

    The loop of a small s is stable, and no s' up to it meets -1 at a line: so that of s is stable too.
    """

    beside = place.beside(response.omega)

    def kept(s: float) -> bool:
        law = law_of(s**2 * place.kp, s * place.kd, response, clock)
        return sensitivity_peak(response, law, beside) <= sensitivity * (1.0 + APPROXIMATE)

    steps = np.geomspace(SLOWEST, 1.0, STEPS)
    first = next((k for k, s in enumerate(steps) if not kept(s)), None)
    if first is None:
        return 1.0
    low, high = steps[max(first - 1, 0)], steps[first]
    for _ in range(HALVINGS):
        middle = (low * high) ** 0.5
        low, high = (middle, high) if kept(middle) else (low, middle)
    return float(low)


def tune_within(
    response: Response, equivalent, inertia: float, viscous: float, goal: TuningGoal, loop, **options
) -> Gains:
    """Return gains as `tune` does that also keep |S| <= goal.sensitivity at every coherent line of a measured response.

    The description's stiffness and loss act beside the response at each amplitude. Where gains would not keep it, Kp is capped and the amplitude tuned again below the cap. Arguments and errors otherwise as of `tune`.
    """
    clock = sampled.Clock.of(loop)
    gains = tune(equivalent, inertia, viscous, goal, loop, **options)
    free, cap = gains, np.full(gains.kp.size, np.inf)
    for _ in range(ROUNDS):
        each = zip(gains.kp, gains.kd, equivalent.stiffness, equivalent.loss, strict=True)
        share = np.array([_slower(Place(*one, inertia), response, clock, goal.sensitivity) for one in each])
        over = share < 1.0
        if not over.any():
            break
        cap[over] = np.minimum(cap[over], BELOW * share[over] ** 2 * gains.kp[over])
        gains = tune(equivalent, inertia, viscous, goal, loop, most_kp=cap, **options)
    capped = np.isfinite(cap)
    if not capped.any():
        return gains
    share = np.where(capped, gains.kp / free.kp, np.inf)
    return replace(gains, findings=(*gains.findings, wording.limited(response.record, share, gains.amplitude)))

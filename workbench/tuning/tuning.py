"""tune: from an axis described over amplitude to PD gains at each amplitude, verified on the exact sampled loop."""

import numpy as np

from workbench.errors import WorkbenchError
from workbench.finding import SENSITIVITY_EXCEEDED, UNSTABLE, Finding
from workbench.threads import one_thread
from workbench.tuning import response, sampled, wording
from workbench.tuning.axis import Axis
from workbench.tuning.gains import Gains
from workbench.tuning.goal import TuningGoal
from workbench.tuning.margins import margins as control_margins
from workbench.tuning.solve import EXACT, Solution, solve
from workbench.tuning.start import damped, stable_box, start

ACTIVE = 2e-4  # relative distance from a limit, below which it stops the gains


class OutOfReach(WorkbenchError):
    """No gains keep the goal. lowest: the amplitude from which on some do, rad or m; None where there is none."""

    def __init__(self, sentence: str, lowest: float | None):
        super().__init__(sentence)
        self.lowest = lowest


@one_thread
def tune(
    equivalent,
    inertia: float,
    viscous: float,
    goal: TuningGoal,
    loop,
    *,
    margins: bool = True,
    begin=None,
    most_kp=None,
) -> Gains:
    """Return the PD gains of each amplitude that bring the linear axis into the band soonest, to stay.

        J y'' + (loss/w_n + b + Kd) y' + (k_e + Kp) y = Kp r,   w_n = sqrt((Kp + k_e)/J)

    equivalent: amplitude A, stiffness k_e and loss c_e w, arrays (n,), rad or m, and N*m/rad or N/m. inertia: J, kg*m^2 or
    kg. viscous: b, N*m*s/rad or N*s/m. loop: an object with sample_time, delay and velocity_filter, s. margins: also ask
    python-control for gain and phase margin. begin: (kp, kd) SI, (n,) each, where the program starts instead of where the
    limits meet. most_kp: the largest Kp at each amplitude, SI, (n,), where something else limits it too. The problem is
    stated in `tune.problem`; limits are those of `goal`, and the sampled loop is exact.

    WorkbenchError: arrays that are no description over increasing amplitudes; OutOfReach: no gains keep the goal (which limit).
    """
    axis = Axis.of(equivalent, inertia, viscous, loop)
    got, findings = _solved(axis, goal, begin, most_kp)
    motion = axis.steps(got.kp)
    peak, _ = sampled.sensitivity_peak(got.kp, got.kd, motion, axis.clock)
    radius = sampled.spectral_radius(got.kp, got.kd, motion, axis.clock)
    gain, phase = np.full((2, peak.size), np.nan)
    if margins:
        gain, phase = control_margins(got.kp, got.kd, motion, axis.clock)
    zeta = axis.zeta(got.kp, got.kd)
    return Gains(
        amplitude=axis.amplitude,
        kp=got.kp * axis.unit_kp,
        kd=got.kd * axis.unit_kd,
        time=response.enter_time(zeta, goal.band) / axis.omega(got.kp) * axis.clock.sample_time,
        overshoot=response.overshoot(zeta),
        sensitivity_peak=peak,
        spectral_radius=radius,
        gain_margin=gain,
        phase_margin=phase,
        error_ratio=axis.stiffness / (axis.stiffness + got.kp),
        binding=_binding(axis, goal, got, peak),
        findings=(*findings, *_doubts(axis, goal, got, peak, radius)),
    )


def _solved(axis: Axis, goal: TuningGoal, begin, most_kp) -> tuple[Solution, tuple[Finding, ...]]:
    """Return the fastest gains, on the axis' own scale, with a finding where the error had to be let go. Arguments as of `tune`."""
    box = stable_box(axis)
    if most_kp is not None:
        box = np.minimum(box[0], np.asarray(most_kp, dtype=float) / axis.unit_kp), box[1]
    kp0, kd0, possible = start(axis, goal, box)
    if not possible.all():
        raise _out_of_reach(axis, goal, possible)
    at = kp0, kd0
    if begin is not None:
        at = tuple(np.asarray(b, dtype=float) / u for b, u in zip(begin, (axis.unit_kp, axis.unit_kd), strict=True))
    got = solve(axis, goal, box, *at, first=(kp0, kd0))
    return got, _allow_error(axis, goal, box, got)


def _allow_error(axis: Axis, goal: TuningGoal, box, got) -> tuple[Finding, ...]:
    """Solve again where the error is too large, as far as gains reach it; else keep the fastest gains, with a finding."""
    least = axis.stiffness * (1.0 / goal.error - 1.0)
    short = np.flatnonzero(got.kp < least * (1.0 - ACTIVE))
    if not short.size:
        return ()
    part, inside = axis.take(short), (box[0][short], box[1][short])
    stiffest = solve(part, goal, inside, got.kp[short], got.kd[short], weight=0.0)
    reach = stiffest.solved & (stiffest.kp >= least[short])
    if reach.any():
        rows, again = short[reach], np.flatnonzero(reach)
        new = solve(
            part.take(again),
            goal,
            (inside[0][again], inside[1][again]),
            stiffest.kp[again],
            stiffest.kd[again],
            least_kp=least[rows],
        )
        got.kp[rows], got.kd[rows], got.solved[rows] = new.kp, new.kd, new.solved
    lost = np.flatnonzero(~reach)
    if not lost.size:
        return ()
    best = part.stiffness[lost] / (part.stiffness[lost] + stiffest.kp[lost])
    return (wording.dropped(part.amplitude[lost], best, axis.amplitude.size, goal.error),)


def _binding(axis: Axis, goal: TuningGoal, got, peak: np.ndarray) -> tuple[tuple[str, ...], ...]:
    """The limits that are met, within ACTIVE, at each amplitude."""
    zeta, omega = axis.zeta(got.kp, got.kd), axis.omega(got.kp)
    speed = axis.amplitude * got.kp / omega * response.speed_ratio(zeta) / axis.clock.sample_time
    met = {
        "overshoot": zeta <= response.damping_for(goal.allowed) * (1.0 + ACTIVE),
        "drive": got.kp * axis.unit_kp * axis.amplitude >= goal.drive * (1.0 - ACTIVE),
        "speed": speed >= goal.speed * (1.0 - ACTIVE),
        "error": np.abs(got.kp - axis.stiffness * (1.0 / goal.error - 1.0)) <= ACTIVE * got.kp,
        "sensitivity": peak >= goal.sensitivity * (1.0 - 2.0 * EXACT),
        "damping": got.kd <= 1e-6 * zeta * omega,
    }
    return tuple(tuple(name for name, where in met.items() if where[i]) for i in range(peak.size))


def _doubts(axis: Axis, goal: TuningGoal, got, peak: np.ndarray, radius: np.ndarray) -> list[Finding]:
    """What verification found wrong, worst first in each kind."""
    wrong = {
        UNSTABLE: (~(radius < 1.0), radius),
        SENSITIVITY_EXCEEDED: (peak > goal.sensitivity * 1.005, peak),
        wording.NOT_CONVERGED: (~got.solved, (~got.solved).astype(float)),
    }
    return [
        wording.doubted(kind, where, size, axis.amplitude, goal.sensitivity)
        for kind, (where, size) in wrong.items()
        if where.any()
    ]


def _out_of_reach(axis: Axis, goal: TuningGoal, possible: np.ndarray) -> OutOfReach:
    """Say which limit no gains keep at the first impossible amplitude, although Kp is near zero, and what would mend it."""
    i = int(np.argmin(possible))
    part = axis.take([i])
    kp = np.array([1e-9])
    kd = damped(part, kp, response.damping_for(goal.allowed))
    motion = part.steps(kp)
    peak, _ = sampled.sensitivity_peak(kp, kd, motion, axis.clock)
    stable = sampled.spectral_radius(kp, kd, motion, axis.clock)[0] < 1.0
    fault = f"the sensitivity peak is {peak[0]:.3g}, above {goal.sensitivity:g}" if stable else "the loop is unstable"
    first = int(np.flatnonzero(~possible)[-1]) + 1
    lowest = float(axis.amplitude[first]) if first < possible.size else None
    above = f", or tune from {lowest:.3g} on only" if lowest else ""
    allow = "a higher sensitivity" if goal.overshoot >= goal.band else "a higher overshoot or sensitivity"
    return OutOfReach(
        f"no gains keep the goal at amplitude {axis.amplitude[i]:.3g}: an overshoot of {goal.allowed:.2%} already needs "
        f"Kd = {kd[0] * axis.unit_kd:.3g} against the axis's own stiffness {axis.stiffness[i] * axis.unit_kp:.3g}, and with "
        f"this {fault}; sample faster, delay less, allow {allow}{above}.",
        lowest,
    )

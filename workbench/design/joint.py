"""Gains over the relative displacement of two masses, from the describing functions of the joint between them.

    minimise    T = tau(zeta)/w0,    w0 = sqrt(Kp/J), zeta = Kd/(2 sqrt(Kp J)), J: of both masses together
    subject to  overshoot(zeta), |S| <= Ms of the exact sampled loop of both masses

At each relative amplitude A the joint is its equivalent spring and loss. The worst load counts. After Tjahjowidodo, Al-Bender, Van
Brussel (IEEE/ASME AIM 2013), section IV; like theirs, the model has no friction to ground.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.definition import FORCE
from workbench.description import Equivalent
from workbench.description.harmonic import first_harmonic
from workbench.design.families.linear import Judge, TwoMasses
from workbench.plant import Plant
from workbench.schedule import Passivity, Schedule, fit_schedule, passivity
from workbench.simulation import Loop
from workbench.tuning import TuningGoal
from workbench.tuning.response import enter_time, overshoot

LINES, RATIOS = 64, (8.0, 800.0)  # of Kp/Kd, 1/s; then as many between the best one's neighbours: 0.2 % apart
STIFF, HALVINGS = (1e-3, 1e3), 14  # of Kp over J ratio^2, on each line: zeta from 0.016 to 16; found to 0.1 %
SEARCHED = 48  # stiffnesses of a line between which the limit is bracketed


@dataclass(frozen=True, eq=False)
class JointGains:
    """amplitude (n,): relative, rad or m. kp, kd (n,), SI. time (n,): s, of the closed form, the worst load's. binding: limits met."""

    amplitude: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    time: np.ndarray
    binding: tuple[tuple[str, ...], ...]


def joint_equivalent(plant: Plant, amplitudes: np.ndarray) -> Equivalent:
    """Return the equivalent of all forces of the joint together, which act in parallel, at relative amplitudes (n,)."""
    forces = [e for e in plant.effects if e.port == FORCE and e.key.endswith("@joint")]
    each = [first_harmonic(e, amplitudes, 1.0) for e in forces]  # none depends on speed but damping, which adds w c
    return Equivalent(amplitudes, sum(q.stiffness for q in each), sum(q.loss for q in each))


def joint_gains(
    equivalent: Equivalent, motor: float, loads: Sequence[float], damping: float, goal: TuningGoal, loop: Loop
) -> JointGains:
    """Return the PD of each relative amplitude: position from the load's encoder, speed from the motor's.

    motor, loads: kg*m^2 or kg. damping: of the joint beside the equivalent's loss, N*m*s/rad or N*s/m.
    """
    loads = np.asarray(loads)
    out = []
    for stiffness, loss in zip(equivalent.stiffness, equivalent.loss, strict=True):
        fastest = np.sqrt(stiffness * (1.0 / motor + 1.0 / loads)).max()  # of the resonances: where a loss damps least
        judge = TwoMasses(loop, motor, loads, np.full(loads.size, stiffness), damping + loss / fastest)
        low, high = RATIOS
        for _ in range(2):
            ratio = np.geomspace(low, high, LINES)
            kp = _stiffest(judge, ratio, motor + float(loads.min()), goal.sensitivity)
            time = _times(kp, ratio, motor + loads[:, None], goal)
            i = int(time.argmin())
            low, high = ratio[max(i - 1, 0)], ratio[min(i + 1, LINES - 1)]
        out.append((kp[i], kp[i] / ratio[i], time[i]))
    kp, kd, time = np.array(out).T
    return JointGains(equivalent.amplitude, kp, kd, time, (("sensitivity",),) * kp.size)


def _times(kp: np.ndarray, ratio: np.ndarray, inertia: np.ndarray, goal: TuningGoal) -> np.ndarray:
    """Return the worst load's 1 % time (lines,) of gains kp (lines,), Kd = kp/ratio; infinite beyond the overshoot. inertia (n, 1)."""
    with np.errstate(divide="ignore", invalid="ignore"):  # a line that nowhere keeps |S| has Kp = 0
        own = np.sqrt(kp / inertia)
        zeta = own / (2.0 * ratio)
        time = (enter_time(zeta, goal.band) / own).max(axis=0)
        fine = (overshoot(zeta) <= goal.allowed).all(axis=0) & (kp > 0.0)
    return np.where(fine, time, np.inf)


def _stiffest(judge: TwoMasses, ratio: np.ndarray, inertia: float, sensitivity: float) -> np.ndarray:
    """Return the largest Kp (lines,) along lines Kp/Kd = ratio (lines,) up to which |S| keeps its limit; 0 where none does."""
    unit = inertia * ratio**2
    share = np.geomspace(*STIFF, SEARCHED)
    kp = unit[:, None] * share
    peak = _peaks(judge, kp, ratio[:, None] + 0.0 * kp)
    fine = peak <= sensitivity
    first = fine.argmax(axis=1)  # a soft loop has little phase: the limit may be kept only from some stiffness on
    after = np.arange(SEARCHED) >= first[:, None]
    end = np.where((after & ~fine).any(axis=1), (after & ~fine).argmax(axis=1), SEARCHED - 1)
    low, high = (np.log(kp[np.arange(ratio.size), i]) for i in (np.maximum(end - 1, 0), end))
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        kept = _peaks(judge, np.exp(middle), ratio) <= sensitivity
        low, high = np.where(kept, middle, low), np.where(kept, high, middle)
    return np.where(fine.any(axis=1), np.exp(low), 0.0)


def _peaks(judge: TwoMasses, kp: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    flat = kp.ravel()
    return judge.peak(flat[:, None], (flat / ratio.ravel())[:, None]).reshape(kp.shape)


def joint_schedule(gains: JointGains, loop: Loop, reversal: float, plant: Plant, per_octave: int, tolerance: float) -> Schedule:  # fmt: skip
    """Return the schedule through the gains, followed over the stroke of the relative displacement. reversal: of it, rad or m."""
    made = fit_schedule(
        gains, loop=loop, per_octave=per_octave, tolerance=tolerance, rule="following", plant_digest=plant.digest,
        plant_lines=plant.digest_lines(),
    )  # fmt: skip
    return replace(made, reversal=reversal)


def joint_passivity(schedule: Schedule, plant: Plant, motor: float, load: float) -> Passivity:
    """Return what moving gains feed in against what damps, at each knot of a schedule over the relative displacement.

    Far below the resonance the load swings against the relative displacement, q = -k delta/(m w^2), and both turn together. So the
    gains move along the error's own cycle and feed in kq, as over the output; the loss of the joint is seen by the output times
    (m w^2/k)^2, with w^2 = Kp/J.
    """

    def at(amplitudes: np.ndarray) -> Equivalent:
        q = joint_equivalent(plant, amplitudes)
        kp, _ = schedule.gains(amplitudes)
        seen = (load * kp / (motor + load) / q.stiffness) ** 2
        return Equivalent(amplitudes, 0.0 * seen, seen * q.loss)

    return passivity(replace(schedule, rule="following"), at, motor + load)


def unstable(
    schedule: Schedule,
    equivalent: Equivalent,
    motor: float,
    load: float,
    damping: float,
    loop: Loop,
    factors: np.ndarray,
    met: Callable[[Judge], Judge] = lambda judge: judge,
) -> np.ndarray:
    """Return where the linear loop is unstable, (factors, amplitudes): gains of a schedule times a factor, the joint's spring and
    loss at each amplitude of `equivalent`. Where it is unstable at some amplitudes and stable at larger ones, it hunts. met: the
    linearisation as the law's own filter and notch make it."""
    kp, kd = schedule.gains(equivalent.amplitude)
    out = []
    for p, d, k, loss in zip(kp, kd, equivalent.stiffness, equivalent.loss, strict=True):
        resonance = np.sqrt(k * (1.0 / motor + 1.0 / load))
        judge = met(TwoMasses(loop, motor, np.array([load]), np.array([k]), damping + loss / resonance))
        out.append(np.isinf(judge.peak(factors[:, None] * p, factors[:, None] * d)))
    return np.array(out).T

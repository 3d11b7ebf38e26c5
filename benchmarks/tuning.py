"""Gains at 40 amplitudes, beside two ways to write the same by hand; CPU time, and how good the answers are."""

from statistics import median
from time import process_time
from types import SimpleNamespace

import numpy as np

from workbench.definition import find
from workbench.description import equivalent
from workbench.threads import one_thread
from workbench.tuning import Gains, TuningGoal, response, sampled, tune
from workbench.tuning.axis import Axis
from workbench.tuning.start import damped, stable_box, start

J, GOAL = 0.0074, TuningGoal(drive=3.3, speed=12.57)  # kg*m^2; N*m, rad/s
TS = 0.25e-3  # s
LOOP = SimpleNamespace(sample_time=TS, delay=TS, velocity_filter=TS, resolution=4.848e-6)
AMPLITUDES = np.geomspace(1e-5, 2.5, 40)  # rad
FEW = (4, 20, 34)  # amplitudes that the slow ways are run at; their time is scaled to all


def described():
    """k_e and c_e w of y = h0 (1 - exp(-a x))."""
    return equivalent(find("presliding_hysteresis")(h0=0.15, x0=1.0 / 636.0), AMPLITUDES)


@one_thread
def by_control(axis: Axis, i: int) -> float:
    """python-control's step_info in scipy's Nelder-Mead over log gains, limits as penalties; return the time found, s."""
    import control
    from scipy.optimize import minimize

    part = axis.take([i])
    motion = part.steps(np.array([GOAL.drive / AMPLITUDES[i] / axis.unit_kp]))
    theta = np.geomspace(0.02, np.pi, 60)

    def cost(x):
        kp, kd = np.exp(x)
        k, d = kp + part.stiffness[0] * axis.unit_kp, kd + part.passive(np.array([kp / axis.unit_kp]))[0] * axis.unit_kd
        info = control.step_info(control.tf([kp], [J, d, k]), SettlingTimeThreshold=GOAL.band)
        units = np.array([kp / axis.unit_kp]), np.array([kd / axis.unit_kd])
        excess = max(kp * AMPLITUDES[i] / GOAL.drive - 1.0, 0.0) + max(info["Overshoot"] / 100.0 - GOAL.overshoot, 0.0)
        excess += max(sampled.sensitivity(*units, theta, motion, axis.clock).max() / GOAL.sensitivity - 1.0, 0.0)
        return info["SettlingTime"] * (1.0 + 100.0 * excess)

    kp = 0.3 * min(GOAL.drive / AMPLITUDES[i], 0.05 * axis.unit_kp)
    first = np.log([kp, 1.7 * np.sqrt(J * kp)])
    return float(minimize(cost, first, method="Nelder-Mead", options={"xatol": 1e-3, "fatol": 1e-7}).fun)


@one_thread
def by_opti(axis: Axis, i: int) -> float:
    """CasADi Opti, built again for the amplitude: the response as it is written, T free, and |1 + L|^2; return T, s."""
    import casadi as ca

    part = axis.take([i])
    kp0, kd0, _ = start(part, GOAL, stable_box(part))
    theta = np.geomspace(0.02, np.pi, 48)
    position = sampled.response(theta, part.steps(kp0), axis.clock)[0]
    speed = position * sampled.difference(theta, axis.clock)
    kp0 = 0.7 * kp0
    kd0 = damped(part, kp0, 0.9)
    opti = ca.Opti()
    x = opti.variable(3)
    kp, kd, tau = ca.exp(x[0]), ca.exp(x[1]), ca.exp(x[2])
    omega = ca.sqrt(kp + part.stiffness[0])
    zeta = (kd + part.damping + part.loss[0] / omega) / (2.0 * omega)
    turn = ca.sqrt(1.0 - zeta**2)
    left = ca.exp(-zeta * tau) * (ca.cos(turn * tau) + zeta / turn * ca.sin(turn * tau))
    opti.minimize(x[2] - ca.log(omega))
    opti.subject_to(left / GOAL.band == 1.0)
    opti.subject_to(opti.bounded(response.damping_for(GOAL.allowed), zeta, 0.9999))
    opti.subject_to(turn * tau <= ca.pi)
    opti.subject_to(x[0] <= np.log(GOAL.drive / AMPLITUDES[i] / axis.unit_kp))
    opti.subject_to(
        AMPLITUDES[i] * kp / omega * ca.exp(-zeta * ca.acos(zeta) / turn) <= GOAL.speed * axis.clock.sample_time
    )
    for p, s in zip(position, speed, strict=True):
        real, imag = 1.0 + kp * p.real + kd * s.real, kp * p.imag + kd * s.imag
        opti.subject_to(real**2 + imag**2 >= GOAL.sensitivity**-2.0)
    opti.set_initial(x, np.log([kp0[0], kd0[0], response.enter_time(part.zeta(kp0, kd0))[0]]))
    opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
    got = opti.solve()
    return float(got.value(tau / omega)) * axis.clock.sample_time


def seconds(call, repeats: int = 1) -> tuple[float, object]:
    """CPU time of a call, median, and what it returned."""
    times = []
    for _ in range(repeats):
        begin = process_time()
        out = call()
        times.append(process_time() - begin)
    return median(times), out


def main() -> None:
    """Print milliseconds an amplitude, ratios to the workbench, and the time that each way's gains take."""
    given = described()
    axis = Axis.of(given, J, 0.0, LOOP)
    for warm in (lambda: by_control(axis, FEW[-1]), lambda: by_opti(axis, FEW[-1])):
        warm()
    built, _ = seconds(lambda: tune(given, J, 0.0, GOAL, LOOP, margins=False))
    whole, gains = seconds(lambda: tune(given, J, 0.0, GOAL, LOOP, margins=False), 7)
    assert isinstance(gains, Gains)
    print(
        f"PD gains at {AMPLITUDES.size} amplitudes: {1e3 * whole:.0f} ms of CPU after the first run ({1e3 * built:.0f} ms)."
    )
    print(f"  {'':<42}{'ms an amplitude':>16}{'ratio':>8}   settling time / the workbench's")
    ours = whole / AMPLITUDES.size
    print(f"  {'workbench, verified on the sampled loop':<42}{1e3 * ours:16.2f}{1.0:8.0f}")
    for name, way in (
        ("CasADi Opti, built each time", by_opti),
        ("python-control step_info + Nelder-Mead", by_control),
    ):
        each = [seconds(lambda i=i, way=way: way(axis, i)) for i in FEW]
        time = sum(t for t, _ in each) / len(FEW)
        found = ", ".join(f"{out / gains.time[i]:.4f}" for i, (_, out) in zip(FEW, each, strict=True))
        print(f"  {name:<42}{1e3 * time:16.2f}{time / ours:8.0f}   {found}")


if __name__ == "__main__":
    main()

"""One amplitude after the other through the same program, each from its own start."""

from dataclasses import dataclass

import numpy as np

from workbench.tuning import response, sampled
from workbench.tuning.axis import Axis
from workbench.tuning.curve import SLUGGISH, curve, damping_at
from workbench.tuning.goal import TuningGoal
from workbench.tuning.problem import FREQUENCIES, half_planes, solver
from workbench.tuning.start import softest

EXACT = 5e-4  # how far the sensitivity peak between frequencies may lie from the bound, relative
PASSES = 5
CLUSTER = 21  # frequencies within a factor 1.6 of the peak, which is one of them; the others over all above


@dataclass
class Solution:
    """kp, kd, tau (n,): in units of the sample. solved (n,): the program reached its tolerance. limits: see `_bounds`."""

    kp: np.ndarray
    kd: np.ndarray
    tau: np.ndarray
    solved: np.ndarray


def _frequencies(peak: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Return theta (n, FREQUENCIES): dense around where |S| peaks, and over all frequencies above the loop's own."""
    near = peak[:, None] * np.geomspace(1.0 / 1.6, 1.6, CLUSTER)
    low = np.minimum(0.3 * omega, 0.1)[:, None]
    far = low * (np.pi / low) ** np.linspace(0.0, 1.0, FREQUENCIES - CLUSTER)
    return np.minimum(np.concatenate([near, far], axis=1), np.pi)


def _bounds(axis: Axis, goal: TuningGoal, box, least_kp: np.ndarray):
    """Return (lbx, ubx, lbg, ubg), (n, .) each, for `problem.solver`."""
    n, inf = axis.amplitude.size, np.inf
    drive = goal.drive / axis.amplitude / axis.unit_kp
    ends, _ = curve(goal.band, response.damping_for(goal.allowed))
    least = np.log(axis.omega(np.maximum(least_kp, softest(axis, box, drive))))
    most = np.maximum(np.log(axis.omega(np.minimum(box[0], drive))), least)
    lbx, ubx = np.stack([least, np.full(n, ends[0])], axis=1), np.stack([most, np.full(n, ends[1])], axis=1)
    lbg, ubg = np.full((n, 2 + FREQUENCIES), -inf), np.full((n, 2 + FREQUENCIES), inf)
    lbg[:, 0] = 0.0
    ubg[:, 1] = np.log(goal.speed * axis.clock.sample_time / axis.amplitude)
    lbg[:, 2:] = 1.0 / goal.sensitivity if np.isfinite(goal.sensitivity) else -inf
    return lbx, ubx, lbg, ubg


def solve(axis: Axis, goal: TuningGoal, box, kp, kd, *, least_kp=0.0, weight: float = 1.0, first=None) -> Solution:
    """Return the optimum at each amplitude, from (kp, kd); weight 0 asks for the largest kp instead of the shortest time.

    `first` (kp, kd): a stable loop, on which frequencies, half-planes and the loss are based; the start, unless given.
    Passes follow, each based on the solution before, until the sensitivity peak is exact.
    """
    limits = _bounds(axis, goal, box, np.broadcast_to(least_kp, kp.shape))
    at_kp, at_kd = (kp, kd) if first is None else first
    out = Solution(kp.copy(), kd.copy(), np.empty(kp.size), np.zeros(kp.size, dtype=bool))
    todo = np.arange(kp.size)
    for _ in range(PASSES):
        part = axis.take(todo)
        motion = part.steps(at_kp[todo])
        _, peak = sampled.sensitivity_peak(at_kp[todo], at_kd[todo], motion, axis.clock)
        theta = _frequencies(peak, part.omega(at_kp[todo]))
        position = sampled.response(theta, motion, axis.clock)
        speed = position * sampled.difference(theta, axis.clock)
        rows = half_planes(position, speed, at_kp[todo], at_kd[todo])
        _run(out, todo, part, goal, weight, rows, [b[todo] for b in limits])
        if not np.isfinite(goal.sensitivity):
            break
        at_kp, at_kd = out.kp.copy(), out.kd.copy()
        exact, _ = sampled.sensitivity_peak(out.kp[todo], out.kd[todo], part.steps(out.kp[todo]), axis.clock)
        gains = np.stack([np.ones(todo.size), out.kp[todo], out.kd[todo]], axis=-1)
        believed = 1.0 / (rows @ gains[:, :, None])[:, :, 0].min(axis=1)
        active = believed > goal.sensitivity * (1.0 - EXACT)
        todo = todo[(exact > goal.sensitivity * (1.0 + EXACT)) | (active & (exact < goal.sensitivity * (1.0 - EXACT)))]
        if not todo.size:
            break
    return out


def _run(
    out: Solution, todo: np.ndarray, axis: Axis, goal: TuningGoal, weight: float, rows: np.ndarray, limits
) -> None:
    """Solve the amplitudes `todo`, whose axis and limits are given, from what `out` holds, and put the solutions there."""
    run, least = solver(), response.damping_for(goal.allowed)
    ends, shapes = curve(goal.band, least)
    common = np.concatenate([ends, shapes.ravel()])
    lbx, ubx, lbg, ubg = limits
    zeta = np.clip(axis.zeta(out.kp[todo], out.kd[todo]), least, SLUGGISH)
    x0 = np.log(np.stack([axis.omega(out.kp[todo]), response.enter_time(zeta, goal.band)], axis=1))
    x0, x = np.clip(x0, lbx, ubx), np.empty_like(x0)
    for j, i in enumerate(todo):
        p = np.concatenate([[axis.stiffness[j], axis.loss[j], axis.damping, weight], common, rows[j].ravel()])
        got = run(x0=x0[j], p=p, lbx=lbx[j], ubx=ubx[j], lbg=lbg[j], ubg=ubg[j])
        x[j] = np.asarray(got["x"]).ravel()
        out.solved[i] = run.stats()["success"]
    omega, tau = np.exp(x).T
    zeta = np.maximum(damping_at(tau, goal.band, least), least)
    out.kp[todo] = omega**2 - axis.stiffness
    out.kd[todo] = np.maximum(2.0 * zeta * omega - axis.damping - axis.loss / omega, 0.0)
    out.tau[todo] = tau

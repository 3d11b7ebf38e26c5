"""A trajectory as the drive reads it, and what a plan comes to as JSON."""

import json
from math import isfinite
from pathlib import Path

import numpy as np

from workbench.inverse.dynamics import InverseDynamics
from workbench.planning.prospect import Prospect
from workbench.planning.selection import Plan
from workbench.planning.separation import Separation

TRAJECTORY, FIGURE = "trajectory.csv", "trajectory.svg"
JSON = "plan.json"


def _write_trajectory(
    file: Path, time: np.ndarray, position: np.ndarray, drive: np.ndarray, rotary: bool, dt: float
) -> None:
    """Write time, position, velocity, acceleration and the drive to feed forward as CSV, every `dt` s, SI.

    time, position of the drive's encoder, drive: (n,). Between these, cubic splines.
    """
    from scipy.interpolate import CubicSpline

    course = CubicSpline(time, position)
    t = np.arange(int(np.floor(time[-1] / dt + 1e-9)) + 1) * dt
    rows = np.column_stack([t, course(t), course(t, 1), course(t, 2), CubicSpline(time, drive)(t)])
    rows = np.round(rows, 12) + 0.0  # what is left of rounding at rest is zero, and has no sign
    x, f = ("rad", "torque_Nm") if rotary else ("m", "force_N")
    header = f"time_s,position_{x},velocity_{x}_per_s,acceleration_{x}_per_s2,{f}"
    np.savetxt(file, rows, fmt="%.9g", delimiter=",", header=header, comments="")


def write_plan(folder: Path, plan: Plan, found: tuple[Prospect, ...], accuracy: float, dt: float) -> None:
    """Write the trajectory and plan.json into an existing folder."""
    _write_trajectory(folder / TRAJECTORY, plan.trajectory.time, plan.position, plan.drive, plan.plant.rotary, dt)
    content = {
        "format": 1,
        "accuracy": accuracy,
        "seconds": float(plan.trajectory.time[-1]),
        "motions": [r.phrase for r in plan.picks],
        "trajectory": TRAJECTORY,
        "sample_time": dt,
        "parameters": [
            {
                "effect": p.effect,
                "at": p.at,
                "parameter": p.parameter,
                "value": p.value,
                "unit": p.unit,
                "now": _number(p.now),
                "promised": _number(p.then),
                "reached": p.reached,
                "why": p.why,
                "sentence": p.sentence,
            }
            for p in found
        ],
    }
    _dump(folder, content)


def write_separation(folder: Path, found: Separation, inverse: InverseDynamics | None, rotary: bool, dt: float) -> None:
    """Write the motion that parts two effects, as `inverse` follows it, and plan.json, into an existing folder."""
    content = {
        "format": 1,
        "separate": [found.first, found.second],
        "apart": found.apart,
        "angle": found.angle,
        "standard_deviations": found.deviations,
        "motion": found.motion,
        "sentence": found.sentence,
        "trajectory": TRAJECTORY if found.apart else None,
        "sample_time": dt,
    }
    if found.apart:
        m = inverse.motion
        _write_trajectory(folder / TRAJECTORY, m.t, m.record.channels["position"], m.u, rotary, dt)
    _dump(folder, content)


def _number(value: float) -> float | None:
    return float(value) if isfinite(value) else None


def _dump(folder: Path, content: dict) -> None:
    (folder / JSON).write_text(
        json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8"
    )

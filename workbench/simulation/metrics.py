"""What leaves a run: one number a scenario and metric, and trajectories where they were asked for."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from workbench.simulation.beginning import NEVER
from workbench.simulation.binding import Bound
from workbench.simulation.bodies import OUTPUT
from workbench.simulation.sampled import FOLLOWING


@dataclass(frozen=True, eq=False)
class Trajectories:
    """time (n,) in s; signals: name -> (n, lanes)."""

    time: np.ndarray
    signals: Mapping[str, np.ndarray]

    def __getitem__(self, name: str) -> np.ndarray:
        return self.signals[name]


@dataclass(frozen=True, eq=False)
class Metrics:
    """Arrays over scenarios, (lanes,), SI. Of two masses, positions are the load's, and speeds the motor's.

    time_1pct: when the true position enters the band of 1 % of the step about the target to stay, linear between samples;
    infinite where it is outside in the last sample. Where a reference over time is followed, the target is its last value,
    and final_error and settling are about the reference itself. time_own: the same about its own final position, where asked for.
    overshoot: beyond the target, as a share of the step. final_error: largest |target - q| in the last window.
    following_error: largest |r - q| from a reference over time, else None.
    settling: first sample of the first stretch within +-counts by the reading that lasts for the hold time, in s.
    peak_torque: largest command after its limit. peak_speed. ripple: rms of the command about its mean, last window.
    reversals: of motion, by the reading. final_position. finite: False where the run went to infinity or NaN; there
    times, errors and peaks are infinite.
    """

    time_1pct: np.ndarray
    time_own: np.ndarray | None
    overshoot: np.ndarray
    final_error: np.ndarray
    settling: np.ndarray
    peak_torque: np.ndarray
    peak_speed: np.ndarray
    ripple: np.ndarray
    reversals: np.ndarray
    final_position: np.ndarray
    finite: np.ndarray
    following_error: np.ndarray | None = None
    trajectories: Trajectories | None = None

    @property
    def lanes(self) -> int:
        return self.finite.size


def entry_time(rows: Mapping[str, np.ndarray], aim, band, sample_time: float) -> np.ndarray:
    """When the error |aim - q| crossed the band for the last time, linear between the two samples around it."""
    last, outer, inner = rows["k_outside"], rows["e_outside"], rows["e_inside"]
    with np.errstate(all="ignore"):
        share = (np.abs(outer) - band) / np.abs(outer - inner)
    time = np.where(last < 0.0, 0.0, (last + share) * sample_time)
    return np.where(rows["outside"] != 0.0, np.inf, time)


def finished(bound: Bound, rows: Mapping[str, np.ndarray], band: float, trajectories: Trajectories | None) -> Metrics:
    """Return the metrics of the final rows. band: share of the step."""
    scenarios, dt = bound.scenarios, bound.loop.sample_time
    position = OUTPUT[bound.design.sensing.kind]
    states = [n for n in ("q", "v", "load.q", "load.v") if n in rows]
    finite = np.all([np.isfinite(rows[n]) for n in states], axis=0)
    step = np.broadcast_to(np.abs(scenarios.target - scenarios.start), finite.shape)
    n = bound.samples - bound.window_from
    with np.errstate(all="ignore"):
        beyond = (rows["peak"] - scenarios.target * np.sign(scenarios.target - scenarios.start)) / step
        variance = rows["sum_uu"] / n - (rows["sum_u"] / n) ** 2
    settled = np.where(rows["k_settled"] == NEVER, np.inf, (rows["k_settled"] + 1.0) * dt)

    def judged(x):
        return np.where(finite, x, np.inf)

    return Metrics(
        time_1pct=judged(entry_time(rows, scenarios.target, band * step, dt)),
        time_own=None,
        overshoot=judged(np.where(step > 0.0, np.maximum(beyond, 0.0), np.nan)),
        final_error=judged(rows["final_error"]),
        settling=judged(settled),
        peak_torque=judged(rows["peak_torque"]),
        peak_speed=judged(rows["peak_speed"]),
        ripple=judged(np.sqrt(np.maximum(variance, 0.0))),
        reversals=rows["reversals"].astype(np.int64),
        final_position=rows[position],
        finite=finite,
        following_error=judged(rows[FOLLOWING]) if FOLLOWING in rows else None,
        trajectories=trajectories,
    )

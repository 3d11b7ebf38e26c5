"""The two calls: a controlled loop over scenarios, and a plant under a given drive."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.control.law import Controller
from workbench.errors import WorkbenchError, nearest
from workbench.plant import TWO_MASS, Plant
from workbench.simulation.binding import Bound, bind, samples_of
from workbench.simulation.criteria import Criteria
from workbench.simulation.given import DRIVE, INJECTED, REFERENCE, TEMPERATURE, given_of
from workbench.simulation.metrics import Metrics, Trajectories, entry_time, finished
from workbench.simulation.run import LANES, run_lanes
from workbench.simulation.scenario import Loop, Scenario, ScenarioArrays, arrays_of


def _named(bound: Bound, record: Sequence[str]) -> tuple[str, ...]:
    """Return the rows to record; "u" is the command after its limit, "kp" and "kd" those in use where they are scheduled."""
    known = {n.removeprefix("gain."): n for n in bound.design.rows} | {"u": "u_c"}
    for name in record:
        if name not in known:
            raise WorkbenchError(f"there is no signal '{name}' to record; {nearest(name, known)}")
    return tuple(known[n] for n in record)


def simulate(
    plant: Plant | Sequence[Plant],
    loop: Loop,
    controller: Controller,
    scenarios: Sequence[Scenario] | ScenarioArrays,
    duration: float,
    record: Sequence[str] = (),
    *,
    every: int = 1,
    own: bool = False,
    reference: np.ndarray | None = None,
    injected: np.ndarray | None = None,
    temperature: np.ndarray | None = None,
    criteria: Criteria | None = None,
    threads: int | None = None,
    lanes: int = LANES,
) -> Metrics:
    """Return the metrics of a closed loop in every scenario, from rest at each one's start.

    Of two masses, the load goes to the target, and loop.feedback says whose encoder the controller reads.

    plant: one, or one a scenario (same effects, other values). controller: its gains may vary over scenarios. duration: s.
    record: signals to keep ("q", "v", "y", "vh", "u", "kp", "kd", "amplitude", an effect's state "key.x[0]"; with two masses
    "load.q", "load.v", "motor.y", "load.y"), every so many samples. reference: what the controller follows, rad or m, (n,) for all
    scenarios or (n, lanes), a value a control sample; a scenario's target is then its last value. injected: added to the
    law's command before its limit, N*m or N, the same shapes. temperature: of the bench over time, K, the same shapes; without it
    each scenario's own. own: run a second time for time_own. threads: how many share the work (the result is the same); all
    cores where absent. lanes: scenarios that one kernel moves side by side.

    Raises WorkbenchError for a plant that has no forward dynamics (no inertia, not affine in acceleration, an implicit
    cycle), a duration that is not positive, no scenarios, or numbers of another length than the scenarios or the run. A
    run that goes to infinity is no error: its metrics are infinite and `finite` is False.
    """
    criteria = criteria or Criteria()
    arrays = arrays_of(scenarios)
    samples = samples_of(duration, loop)
    given = given_of({REFERENCE: reference, INJECTED: injected, TEMPERATURE: temperature}, samples, arrays.lanes)
    bound = bind(plant, loop, controller, arrays, samples, criteria, given=given)
    arrays = bound.scenarios
    final, kept = run_lanes(bound, _named(bound, record), every, lanes, threads)
    metrics = finished(bound, final, criteria.band, _trajectories(bound, record, every, kept))
    if not own:
        return metrics
    aim = np.where(metrics.finite, metrics.final_position, arrays.target)
    second = bind(plant, loop, controller, arrays, samples, criteria, aim=aim, given=given)
    again, _ = run_lanes(second, (), 1, lanes, threads)
    band = criteria.band * np.abs(aim - arrays.start)
    time = np.where(metrics.finite, entry_time(again, aim, band, loop.sample_time), np.inf)
    return replace(metrics, time_own=time)


def followed(
    plant: Plant,
    loop: Loop,
    controller: Controller,
    scenarios: ScenarioArrays,
    references: np.ndarray,
    which: np.ndarray,
    lasts: np.ndarray,
    record: str = "q",
) -> np.ndarray:
    """Return a signal (n, lanes) of the loops of `simulate` that follow references, each of which several lanes share.

    references (n, m), rad or m, a value a control sample. which (lanes,): the reference of each lane. lasts (lanes,): samples that are
    needed of each, n at most; beyond them the signal is undefined. Lanes that a kernel moves side by side run as long as the longest
    of them, so those of like duration should lie together.
    """
    known = given_of({REFERENCE: references}, len(references), references.shape[1])
    bound = bind(plant, loop, controller, scenarios, len(references), Criteria(), given=replace(known, which=which))
    _, kept = run_lanes(bound, _named(bound, (record,)), lasts=lasts)
    return kept[:, 0]


def _trajectories(bound: Bound, record, every: int, kept) -> Trajectories | None:
    if not record:
        return None
    time = np.arange(0, bound.samples, every) * bound.loop.sample_time
    return Trajectories(time, {name: kept[:, i] for i, name in enumerate(record)})


def open_loop(
    plant: Plant | Sequence[Plant],
    drive: np.ndarray,
    dt: float,
    substeps: int = 2,
    *,
    scenarios: Sequence[Scenario] | ScenarioArrays | None = None,
    resolution: float = 0.0,
    load_resolution: float = 0.0,
    temperature: np.ndarray | None = None,
    record: Sequence[str] = (),
    threads: int | None = None,
    lanes: int = LANES,
) -> Trajectories:
    """Return time (n,), "q", "v", "y" and `record` (n, lanes) under a given drive, held over each sample.

    Of two masses these are the motor's, and "load.q", "load.v", "load.y" are there besides.

    plant: one, or one a lane (same effects, other values). drive: (n, lanes) or (n,) commands in N*m or N, before the plant's own command maps. Sample k is the state at k dt,
    before drive[k] acts. Without scenarios every lane starts at rest at zero. temperature: as of `simulate`. Errors as for it.
    """
    drive = np.asarray(drive, dtype=float)
    drive = drive[:, None] if drive.ndim == 1 else drive
    if not drive.size or not np.isfinite(drive).all():
        raise WorkbenchError("the drive of an open loop needs one finite value or more a lane.")
    arrays = ScenarioArrays(drive.shape[1]) if scenarios is None else arrays_of(scenarios)
    if arrays.lanes != drive.shape[1]:
        raise WorkbenchError(f"the drive has {drive.shape[1]} columns for {arrays.lanes} scenarios.")
    one = plant if isinstance(plant, Plant) else plant[0]
    limited = np.clip(drive, -one.limits.drive, one.limits.drive)
    loop = Loop(dt, substeps, resolution=resolution, load_resolution=load_resolution)
    given = given_of({DRIVE: limited, TEMPERATURE: temperature}, len(drive), arrays.lanes)
    bound = bind(plant, loop, None, arrays, len(drive), Criteria(), given=given)
    load = ("load.q", "load.v", "load.y") if one.kind == TWO_MASS else ()
    names = tuple(dict.fromkeys(("q", "v", "y", *load, *record)))
    _, kept = run_lanes(bound, _named(bound, names), 1, lanes, threads)
    return _trajectories(bound, names, 1, kept)

"""Output error: the loop of a record is simulated with the record's controller, and compared with what was measured.

Identification asks which drive a measured motion needs. Here the record's reference goes in, and motion and drive come
out: errors that a stiff feedback hides in the one show in the other, and an unstable or slow part of a model shows here.

Source: Gautier, Janot and Vandanjon 2013 (closed-loop output error on the drive); Ljung 1999, chapter 13.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isclose
from types import MappingProxyType

import numpy as np

from workbench.control.law import Controller
from workbench.errors import WorkbenchError
from workbench.motion import Motion
from workbench.plant import ONE_MASS, SENSORS, TWO_MASS, Plant
from workbench.record import Record
from workbench.simulation import Loop, Scenario, simulate
from workbench.simulation.recorded import temperature_of

SAME_RATE = 1e-3  # relative; a bench clock is seldom truer
DRIVE = "drive"
READINGS = {ONE_MASS: ("y",), TWO_MASS: ("motor.y", "load.y")}  # rows of the kernel, in the order of SENSORS


@dataclass(frozen=True, eq=False)
class Rerun:
    """One record's loop, simulated.

    simulated: "position", with two masses "load_position" (unless held), as the encoders read them, and "drive" (the command
    after its limit) -> (n,), SI, at the record's samples. errors: the same names -> rms(F(x - simulated)) / rms(F(x)) over the samples that count, F
    the evaluation filter; a position is taken about its mean. raw: the same errors without the filter.
    """

    record: Record
    simulated: Mapping[str, np.ndarray]
    errors: Mapping[str, float]
    raw: Mapping[str, float]


def _measured(record: Record, name: str) -> np.ndarray:
    """Return the measured channel (n,) that a simulated one is compared with."""
    return record.drive if name == DRIVE else record.channels[name]


def _checked(motion: Motion, loop: Loop) -> None:
    """WorkbenchError where a record has no reference, or another rate than the loop."""
    record = motion.record
    if "reference" not in record.channels:
        raise WorkbenchError(
            f"record '{record.name}' has no channel 'reference', so its loop cannot be simulated; record what the "
            "controller was asked to follow, and name its column under [channels]."
        )
    if not isclose(record.dt, loop.sample_time, rel_tol=SAME_RATE):
        raise WorkbenchError(
            f"record '{record.name}' has a sample every {record.dt:.6g} s, but the loop runs every "
            f"{loop.sample_time:.6g} s; record at the control rate, or give a loop at the record's rate."
        )


def outputs(
    plants: Sequence[Plant], motion: Motion, loop: Loop, controller: Controller
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Return (name -> (n, plants): encoders' readings and drive, finite (plants,)) of each plant in the loop of one record."""
    _checked(motion, loop)
    record, kind = motion.record, plants[0].kind
    held = kind == TWO_MASS and record.locked
    rows = dict(zip(SENSORS[: 1 if held else None], READINGS[kind], strict=False)) | {DRIVE: "u"}
    start = record.channels["load_position" if kind == TWO_MASS and not held else "position"][0]
    one = Scenario(start=float(start), locked=float(held), load_inertia=payload_inertia(record))
    run = simulate(
        list(plants), loop, controller, [one] * len(plants), record.time.size * loop.sample_time, tuple(rows.values()),
        reference=record.channels["reference"], injected=record.channels.get("injected"), temperature=temperature_of(plants[0], record),
    )  # fmt: skip
    return {name: run.trajectories[row] for name, row in rows.items()}, run.finite


def payload_inertia(record: Record) -> float:
    """Return the payload's inertia of a record; WorkbenchError where it has weight, which a scenario does not simulate."""
    if record.payload is not None and record.payload.mgl:
        raise WorkbenchError(
            f"record '{record.name}' states a payload with weight (mgl), which is not simulated; take a record without it."
        )
    return record.payload.inertia if record.payload is not None else 0.0


def _relative(x: np.ndarray, simulated: np.ndarray, keep: slice) -> float:
    """rms(x - simulated) / rms(x) over the samples kept; NaN where x is zero."""
    whole = np.linalg.norm(x[keep])
    return float(np.linalg.norm((x - simulated)[keep]) / whole) if whole > 0.0 else float("nan")


def rerun(plant: Plant, motion: Motion, loop: Loop, controller: Controller) -> Rerun:
    """Return the record of `motion` as its loop gives it with this plant: the reference goes in, motion and drive come out.

    The record needs a channel `reference`, rad or m, and where something was added to the controller's command
    `injected`, N*m or N. loop: what the controller ran on, at the record's rate; its resolution quantises the simulated
    reading as the bench's encoder does. The simulation begins at rest where the record begins, and its clock at zero;
    errors count where the record's do. Raises WorkbenchError without a reference, at another rate, and where the loop is unstable.
    """
    record, keep = motion.record, motion.keep
    rows, finite = outputs([plant], motion, loop, controller)
    if not finite.all():
        raise WorkbenchError(
            f"the loop of record '{record.name}' goes to infinity with this plant and controller: compare the sign of "
            "the drive, the units of the gains and the delay with those of the bench."
        )
    simulated = {n: x[:, 0] for n, x in rows.items()}
    errors, raw = {}, {}
    for name, x in simulated.items():
        of = _measured(record, name)
        about = 0.0 if name == DRIVE else np.mean(of[keep])
        raw[name] = _relative(of - about, x - about, keep)
        errors[name] = _relative(motion.filter(of - about), motion.filter(x - about), keep)
    return Rerun(record, MappingProxyType(simulated), MappingProxyType(errors), MappingProxyType(raw))

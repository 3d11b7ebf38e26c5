"""What a compensation would have added along a record, held against what identification says of the same effects."""

import casadi as ca
import numpy as np

from workbench.compensation import parts, structure
from workbench.compensation.compensator import OBSERVED, READ, REFERENCE, Compensator
from workbench.definition import namespace
from workbench.errors import WorkbenchError
from workbench.identification.fit import series_of
from workbench.inverse.dynamics import InverseDynamics
from workbench.kernel.program import read
from workbench.kernel.scan import scan
from workbench.plant import Plant
from workbench.record import Record

SIGNALS = ("y", "vh", "r", "u", "motor_y", "motor_vh", "load_y", "load_vh")


def predicted(compensator: Compensator, record: Record, velocity_filter: float = 0.0) -> np.ndarray:
    """Return what the compensation adds to the command (n,), N*m or N, sample by sample along a record.

    The same program as in the law, on the record's own positions (and its channel "reference", where that is the source), at
    the record's rate. velocity_filter: time constant of the filtered difference, s.
    """
    made = structure.structure(compensator)
    position = record.channels["position"]
    load = record.channels.get("load_position", position)
    if compensator.source == REFERENCE and "reference" not in record.channels:
        raise WorkbenchError(f"record '{record.name}' has no channel 'reference', from which it would be compensated.")
    r = record.channels.get("reference", position)
    rows = [position, _speed(position, record.dt, velocity_filter), r, record.drive]
    rows += [position, rows[1], load, _speed(load, record.dt, velocity_filter)]
    numbers = structure.values_of(compensator, made)
    start = np.array(
        [position[0] if n.startswith(f"{structure.PREFIX}_at") else 0.0 for n in structure.states_of(made)]
    )
    if compensator.source == OBSERVED:
        raise WorkbenchError("what an observer sees hangs on the loop that it runs in; it is simulated, not predicted.")
    count = record.resolution.get("position", 0.0)
    return scan(
        _program(made, record.dt, count, tuple(numbers)), np.stack(rows), start, np.array(list(numbers.values()))
    )[0]


def _program(made: structure.Structure, dt: float, count: float, names: tuple[str, ...]):
    """Return the compensation alone as a program: signals, states, parameters in; next states, force out."""
    s, p = ca.SX.sym("s", len(SIGNALS)), ca.SX.sym("p", len(names))
    states = structure.states_of(made)
    z = ca.SX.sym("z", len(states))
    given = dict(zip(SIGNALS, ca.vertsplit(s), strict=True))
    signals = namespace(**given, e=given["r"] - given["y"], dt=dt, count=ca.SX(count), limit=ca.SX(np.inf))
    numbers = namespace(**dict(zip(names, ca.vertsplit(p), strict=True)))
    # of a record the drive as reported stands for what acted; it is limited already
    memory = dict(zip(states, ca.vertsplit(z), strict=True)) | {f"{structure.PREFIX}_whole": given["u"]}
    after, force = parts.forces(made, parts.asked(made, signals, numbers), namespace(**memory), numbers, ca.SX(0))
    following = ca.vertcat(*(ca.densify(ca.SX(after[n])) for n in states))
    return read(ca.Function("compensation", [s, z, p], [following, ca.densify(force)]))


def _speed(position: np.ndarray, dt: float, velocity_filter: float) -> np.ndarray:
    """Return the filtered backward difference of a loop, (n,)."""
    from scipy.signal import lfilter

    smoothing = 1.0 - np.exp(-dt / velocity_filter) if velocity_filter else 1.0
    return lfilter([smoothing], [1.0, smoothing - 1.0], np.diff(position, prepend=position[0]) / dt)


def agreement(compensator: Compensator, plant: Plant, inverse: InverseDynamics, velocity_filter: float = 0.0) -> float:
    """Return how far what the compensation adds is from what identification says that its forces take of the drive.

    Both below the evaluation bandwidth; rms of the difference over the rms of the force. plant: holds the forces, and
    something else. Small where a causal controller sees what a zero-phase filter sees: not on fast motions.
    """
    if compensator.source != READ:
        raise WorkbenchError("identification sees the measured position; compare a compensation from that.")
    without = plant
    for e in compensator.forces:
        without = without.without(e.key)
    m = inverse.motion
    said = series_of(plant, inverse)[0].predicted - series_of(without, inverse)[0].predicted
    does = m.filter(predicted(compensator, m.record, velocity_filter))
    off, whole = (does - said)[m.keep], said[m.keep]
    return float(np.sqrt(np.mean(off**2) / max(np.mean(whole**2), 1e-300)))

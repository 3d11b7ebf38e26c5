"""Two encoders are an angle measurement: what their difference tells of the joint, and of the clocks that stamp it.

    q_motor - q_load = zero of the record + A a + B v + forces of the load/k,    A = J/k,  B = late + b/k

with J and b the inertia and viscous friction behind the joint. A reading of the load that is late falls behind in
proportion to the speed; so does a load that viscous friction holds back, and nothing in the angle tells them apart. The
drive's balance bounds what friction can be: late = B - A b/J, with b between zero and all the viscous friction that the
drive feels, unless the plant knows it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.definition import catalogue
from workbench.encoders.angle import Angle, Ends, Rates, angles, ends
from workbench.encoders.blocks import Blocks, Interval
from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.shift import shifted
from workbench.motion import increments
from workbench.plant import Plant

# A hysteresis of the joint: play operators on the torque, whose radii are shares of its largest value. Three span a loop from
# a thin to a fat one; half or twice of each moves no lateness by more than its interval.
LOOPS = (0.05, 0.15, 0.45)
BLOCKS, SHORTEST = 48, 0.5  # blocks wanted, and s of the shortest, as of the intervals of a fit
FOLDS = 6
FARTHEST = 0.05  # s: what a clock may be late by, as the effect has it
# Of the squared angle on held-out blocks, what a clock that gains must take of what one that is late leaves: more than half.
# A quarter or three quarters decide alike on a clock that gains a few counts over the records; less is no lasting trend.
PLAIN = 0.5
LATE, GAINING = 0, 1  # columns


@dataclass(frozen=True)
class Deflection:
    """What two encoders tell of a joint.

    late: s by which load_position is later than position, in the middle of the records; the interval holds what viscous
    friction behind the joint may be. drift: s that it gains a second; gains: the same where that is plain, else zero. middle: s, the bench clock
    there; of a clock that is set anew where each record begins (restarted), the time since. records: record ->
    late by itself, friction taken as likely. zeros: record -> q_motor - q_load of a relaxed joint, rad. inertial: A, s^2.
    compliance: rad/(N*m), by the torque that passes the joint. friction: (least, most) of b/k, s. share: of the squared
    angle that all else leaves on held-out blocks (friction as far as it may reach), what lateness takes. left: rms of what then
    remains, rad. counts: the same in steps of the load's encoder, NaN where unknown. worth: rms of the torque by which
    lateness would wind the joint, over the drive's: no less, for the stiffness is taken at the end of its interval. by_motor: squared error of the drive's balance with the drive on the
    load's clock, over that with the drive on the motor's.
    """

    late: Interval
    drift: Interval
    gains: float
    middle: float
    records: Mapping[str, Interval]
    zeros: Mapping[str, Interval]
    inertial: Interval
    compliance: Interval
    friction: tuple[float, float]
    share: float
    left: float
    counts: float
    worth: float
    by_motor: float
    restarted: bool = False

    @property
    def start(self) -> float:
        """Lateness at t = 0 of the bench clock, or where each record begins, s."""
        return self.late.value - self.gains * self.middle


@dataclass(frozen=True, eq=False)
class Drive:
    """The drive's balance: inertia and viscous friction of both bodies together; per record what of the drive is no friction
    (torque) and what nothing explains (left), (n,) each; error: the sum of squares of that."""

    inertia: float
    viscous: float
    torque: list[np.ndarray]
    left: list[np.ndarray]

    @property
    def error(self) -> float:
        return float(sum(r @ r for r in self.left))


def _parted(records: Sequence[Angle]) -> tuple[list[slice], np.ndarray]:
    """Return (blocks of the stacked rows, the record of each)."""
    long = max(SHORTEST, sum(a.apart.size * a.dt for a in records) / BLOCKS)
    found, of, first = [], [], 0
    for k, a in enumerate(records):
        many = max(int(a.apart.size * a.dt / long), 1)
        edges = first + np.linspace(0, a.apart.size, many + 1).astype(int)
        found += [slice(i, j) for i, j in zip(edges[:-1], edges[1:], strict=True)]
        of += [k] * many
        first += a.apart.size
    return found, np.array(of)


def _stacked(records: Sequence[Angle], rows: Sequence[Sequence[np.ndarray]]) -> np.ndarray:
    """Return the columns of all records, one under the other, and a constant of each record last."""
    tables = []
    for k, (a, columns) in enumerate(zip(records, rows, strict=True)):
        own = np.zeros((a.apart.size, len(records)))
        own[:, k] = 1.0
        tables.append(np.column_stack([*columns, own]))
    return np.concatenate(tables)


def _drive_of(records: Sequence[Angle], declared: float, late: float = 0.0) -> Drive:
    """Return the drive's balance. declared: inertia of both bodies, which stands where the balance tells none (a slow motion's comes out below
    zero; a viscous friction below zero beside it is none). late: s by which the drive is later than the encoders."""
    columns = _stacked(records, [(*a.momentum, *a.forces.T) for a in records])
    drives = [shifted(a.drive, -late, a.dt) if late else a.drive for a in records]
    y = np.concatenate(drives)
    balance = Blocks(columns, y, [slice(0, y.size)])
    if (w := balance.solved())[0] <= 0.0:
        w = balance.solved(held={0: declared})
        if w[1] < 0.0:
            w = balance.solved(held={0: declared, 1: 0.0})
    forces = w[3 : 3 + records[0].forces.shape[1]]
    left = np.split(y - columns @ w, np.cumsum([a.apart.size for a in records])[:-1])
    lost = [w[1] * a.speed + a.forces[:, a.dissipative] @ forces[a.dissipative] for a in records]
    return Drive(float(w[0]), float(w[1]), [u - f for u, f in zip(drives, lost, strict=True)], left)


def _loops(records: Sequence[Angle], torque: Sequence[np.ndarray]) -> list[list[np.ndarray]]:
    """Return play operators on the torque, per record."""
    largest = max(float(np.abs(t).max()) for t in torque)
    return [[t[0] + np.cumsum(increments(t, 2.0 * share * largest)) for share in LOOPS] for t in torque]


def _deflection(
    records: Sequence[Angle], bodies: Ends, undone: float = 0.0, restarted: bool = False
) -> Deflection | None:
    """Return what the angles of records tell; None where there are none, or no inertia is declared behind the joint.

    undone: s of the load's lateness that the angles are without. restarted: whether a clock that gains is set anew where each record begins. Intervals are by the jackknife over blocks of the records.
    """
    if not records or bodies.inertia[1] <= 0.0:
        return None
    drive = _drive_of(records, sum(bodies.inertia))
    rates = bodies.rates(drive.inertia, drive.viscous)
    parts, of = _parted(records)
    y = np.concatenate([a.apart for a in records])
    clocks = [a.time - (a.begins if restarted else 0.0) for a in records]
    middle = float(np.mean([0.5 * (t[0] + t[-1]) for t in clocks]))
    since = [t - middle for t in clocks]
    common = [(a.speed, a.speed * t, a.acceleration) for a, t in zip(records, since, strict=True)]
    more = [(a.jerk, r, *a.forces.T) for a, r in zip(records, drive.left, strict=True)]
    through = [
        t - (drive.inertia - rates.load) * a.motor[:, 1] + rates.likely * rates.load * a.speed
        for a, t in zip(records, drive.torque, strict=True)
    ]
    looped, passed = _loops(records, through), [(t,) for t in through]

    def of_columns(*columns):
        return Blocks(
            _stacked(records, [[x for part in parts for x in part] for parts in zip(*columns, strict=True)]), y, parts
        )

    plain, full, static = of_columns(common, more), of_columns(common, more, looped), of_columns(common, passed)
    told = _told(records, drive, rates, of, (plain, full, static), middle, undone, since, sum(bodies.inertia))
    return replace(told, restarted=restarted)


def _told(
    records, drive: Drive, rates: Rates, of: np.ndarray, fits, middle: float, undone: float, since, declared: float
) -> Deflection:
    plain, full, static = fits
    (inertial,) = _measured(plain, slice(2, 3))
    (compliance,) = _measured(static, slice(3, 4), {2: 0.0})
    friction = max(inertial.low, 0.0) * rates.least, max(inertial.high, 0.0) * rates.most
    likely = max(inertial.value, 0.0) * rates.likely
    gaining = _measured(full, slice(GAINING, GAINING + 1))[0]
    steady = {GAINING: 0.0}
    drifting = gaining.sure and _held_out(full, {}) < (1.0 - PLAIN) * _held_out(full, steady)
    held = {} if drifting else steady
    (both,) = _measured(full, slice(LATE, LATE + 1), held)
    late = Interval(both.value - likely, both.low - friction[1], both.high - friction[0]) + undone
    squares = _held_out(full, held)
    without = _held_out(full, steady, (friction[0] - undone, friction[1] - undone))
    left = float(np.sqrt(squares / sum(a.apart.size for a in records)))
    count, names = max(a.count for a in records), [a.record for a in records]
    gains = gaining.value if drifting else 0.0
    wound = _rms([a.speed * (late.value + gains * t) for a, t in zip(records, since, strict=True)]) / max(
        abs(compliance.low), abs(compliance.high), 1e-300
    )
    own = [i + undone for i in _alone(full, of, held, likely)]
    return Deflection(
        late, gaining, gains, middle, dict(zip(names, own, strict=True)),
        dict(zip(names, _measured(plain, slice(-len(names), None)), strict=True)),
        inertial, compliance, friction, 1.0 - squares / max(without, 1e-300), left, left / count if count else float("nan"),
        wound / max(_rms([a.drive for a in records]), 1e-300),
        _drive_of(records, declared, late.value).error / max(drive.error, 1e-300),
    )  # fmt: skip


def _rms(parts: Sequence[np.ndarray]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))


def _measured(blocks: Blocks, which: slice, held: Mapping[int, float] | None = None) -> list[Interval]:
    """Return the values of some columns with their intervals."""
    w, half = blocks.solved(held=held)[which], blocks.half_widths(held=held)[which]
    return [Interval(float(v), float(v - h), float(v + h)) for v, h in zip(w, half, strict=True)]


def _alone(full: Blocks, of: np.ndarray, held: Mapping[int, float], likely: float) -> list[Interval]:
    """Return how late each record says that the load is, its zero free and all else held at what all records say."""
    w, found = full.solved(held=held), []
    many = int(of.max()) + 1
    for k in range(many):
        others = {i: float(v) for i, v in enumerate(w) if i not in (LATE, w.size - many + k)}
        rows = np.flatnonzero(of == k)
        value, half = full.solved(rows, others)[LATE] - likely, full.half_widths(rows, others)[LATE]
        found.append(Interval(float(value), float(value - half), float(value + half)))
    return found


def _held_out(full: Blocks, held: Mapping[int, float], friction: tuple[float, float] | None = None) -> float:
    """Return the squared error of the angle on held-out blocks. friction: the bounds of what stands in for lateness, s."""
    total, folds = 0.0, np.arange(len(full)) % FOLDS
    for k in range(min(FOLDS, len(full))):
        out, rest = np.flatnonzero(folds == k), np.flatnonzero(folds != k)
        w = full.solved(rest, held)
        if friction:
            w = full.solved(rest, {**held, LATE: float(np.clip(w[LATE], *friction))})
        total += full.errors(w, out)
    return total


def deflection_of(inverses: Sequence[InverseDynamics], plant: Plant) -> Deflection | None:
    """Return what the records of two encoders tell of a plant's joint; None where there is no such record.

    A first answer is right to first order in lateness over a period of the motion; where zero lies outside of its interval it
    is undone, and what is left of it is measured again.
    """
    found = _of_clocks(angles(inverses, plant), ends(plant))
    if found is None or not found.late.sure or abs(found.late.value) > FARTHEST:
        return found
    late = plant + catalogue()["clock_skew"](at="sensor.load_position", label="told", offset=found.late.value)
    return _of_clocks(angles(inverses, late), ends(plant), found.late.value) or found


def _of_clocks(records: Sequence[Angle], bodies: Ends, undone: float = 0.0) -> Deflection | None:
    """Return what the angles of records tell with a clock that runs on from record to record, or plainly more with one that is set anew."""
    if (found := _deflection(records, bodies, undone)) is None or len(records) < 2:
        return found
    anew = _deflection(records, bodies, undone, restarted=True)
    return anew if anew.gains and anew.left**2 < (1.0 - PLAIN) * found.left**2 else found


def zeros(inverses: Sequence[InverseDynamics], plant: Plant) -> dict[str, float]:
    """Return record -> q_motor - q_load in rad where the joint is relaxed; empty where there are no two encoders."""
    found = deflection_of(inverses, plant)
    return {} if found is None else {name: z.value for name, z in found.zeros.items()}

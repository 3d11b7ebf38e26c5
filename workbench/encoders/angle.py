"""The difference of two encoders, beside what it can depend on, and what the plant knows of the bodies at both ends."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.definition import FORCE
from workbench.inverse.bodies import ACCELERATION, RAW, VELOCITY
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import TWO_MASS, Plant

# An inertia that is only a start value: a data sheet's is right within a factor of 1.5, an engineer's guess within this one.
# It bounds friction over inertia behind the joint: half of it lets a smaller lateness pass for none of friction's, twice of
# it takes twice as much for friction.
GUESSED = 3.0
TOLERANCE = 0.01  # to which a fixed value is known: half or twice of it moves the bound on friction by a hundredth


@dataclass(frozen=True, eq=False)
class Angle:
    """One record through the evaluation filter, where errors count, SI, (n,) each.

    apart: q_motor - q_load. speed, acceleration, jerk: of the load. motor: (n, 2), speed and acceleration there. forces: (n, k),
    the linear columns of the declared forces at both bodies but inertia and viscous friction; dissipative: (k,), those that read
    a direction or a velocity. count: of the load's encoder, 0 where unknown. dt: s; begins: the bench clock where the
    record does, s.
    """

    record: str
    dt: float
    begins: float
    count: float
    time: np.ndarray
    apart: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray
    jerk: np.ndarray
    motor: np.ndarray
    drive: np.ndarray
    forces: np.ndarray
    dissipative: np.ndarray

    @property
    def momentum(self) -> list[np.ndarray]:
        """Columns of the drive's balance, which holds whatever joins the bodies: mean acceleration, mean speed, and how much
        acceleration the motor has more. (The speed that it has more, the deflection's, would excuse a drive that is late.)"""
        load = np.column_stack([self.speed, self.acceleration])
        speed, acceleration = (0.5 * (self.motor + load)).T
        return [acceleration, speed, self.motor[:, 1] - self.acceleration]


@dataclass(frozen=True)
class Rates:
    """Viscous friction over inertia behind the joint, 1/s: the least and the most that it can be, and its likely value;
    load: the likely inertia there."""

    least: float
    likely: float
    most: float
    load: float


@dataclass(frozen=True)
class Ends:
    """Inertia and viscous friction (motor, load) as declared, and whether each is known: declared as fixed."""

    inertia: tuple[float, float]
    viscous: tuple[float, float]
    known_inertia: tuple[bool, bool] = (False, False)
    known_viscous: tuple[bool, bool] = (False, False)

    def rates(self, inertia: float, viscous: float) -> Rates:
        """Return what friction over inertia can be behind the joint where the drive feels these two of both bodies.

        Likely is the same share of friction as of inertia, by what is declared.
        """
        viscous, share = max(viscous, 0.0), self.inertia[1] / max(sum(self.inertia), 1e-300)
        # the drive's balance feels too little of it where friction that falls with speed is not declared
        least, most = 0.0, max(viscous, sum(self.viscous))
        if self.known_viscous[1]:
            least = most = self.viscous[1]
        elif self.known_viscous[0]:
            least, most = sorted((max(viscous - self.viscous[0], 0.0), self.viscous[1]))
        light, load, heavy = share / GUESSED * inertia, share * inertia, inertia
        if self.known_inertia[1]:
            light = load = heavy = self.inertia[1]
        elif self.known_inertia[0] and inertia > self.inertia[0]:
            light = load = heavy = inertia - self.inertia[0]
        low, high = least / heavy * (1.0 - TOLERANCE), most / light * (1.0 + TOLERANCE)
        return Rates(low, float(np.clip(viscous / inertia, low, high)), high, load)


def _angle_of(p: InverseDynamics, plant: Plant) -> Angle:
    """Return the angle of one record: its joint's effective deflection, declared maps undone."""
    m = p.motion
    own = [
        (column.sum(axis=0), bool({"dir", "v", "dq"} & set(e.reads)))
        for e, _, column in p.columns(plant)
        if e.at in ("motor", "load") and tuple(e.reads) not in (("a",), ("v",))
    ]
    (_, joint), (_, motor), (_, load) = (p.bodies.body(plant, at) for at in ("joint", "motor", "load"))
    smooth, keep = m.filter, m.keep
    signals = np.stack([joint[RAW], m.u, *motor[[VELOCITY, ACCELERATION]], *(c for c, _ in own)])
    apart, drive, speed, acceleration, *forces = smooth(signals)[:, keep]
    moves = [x[keep] for x in smooth.derivatives(load[VELOCITY], 3)]
    return Angle(
        m.record.name, m.dt, float(m.t[0]), m.record.resolution.get("load_position", 0.0), m.t[keep], apart, *moves,
        np.column_stack([speed, acceleration]), drive, np.reshape(forces, (len(own), drive.size)).T,
        np.array([d for _, d in own], dtype=bool),
    )  # fmt: skip


def angles(inverses: Sequence[InverseDynamics], plant: Plant) -> list[Angle]:
    """Return the angle of every record of two encoders whose load is free to move, by name; none of one mass."""
    if plant.kind != TWO_MASS:
        return []
    both = [p for p in inverses if "load_position" in p.motion.record.channels and not p.motion.record.locked]
    return [_angle_of(p, plant) for p in sorted(both, key=lambda p: p.motion.record.name)]


def ends(plant: Plant) -> Ends:
    """Return what a plant of two masses declares of inertia and viscous friction at its two ends."""

    def of(effect: str):
        declared = [
            [e for e in plant.effects if e.port == FORCE and e.at == at and e.name == effect]
            for at in ("motor", "load")
        ]
        found = [[e.parameters[n] for e in there for n in e.linear] for there in declared]
        return tuple(sum(p.value for p in ps) for ps in found), tuple(
            bool(ps) and all(p.fixed for p in ps) for ps in found
        )

    (inertia, known_inertia), (viscous, known_viscous) = of("inertia"), of("viscous_friction")
    return Ends(inertia, viscous, known_inertia, known_viscous)

"""What a closed drive can be told: a position-velocity cascade with feed-forward, in SI, and the units it is written in.

    v_r = kv (r - y) + forward r',   u = kvp (v_r - v) + ki integral of (v_r - v) dt + viscous r' + mass r''

A PD law u = kp (r - y) - kd v is such a cascade with kv = kp/kd, kvp = kd and no integral. Around a target that rests a
cascade is the PID on the position with p = kvp kv + ki, i = ki kv, d = kvp on -v: the same loop, margins and answer to a
load. A step of the target itself kicks the PID by ki more: give such drives a smooth reference.
"""

from dataclasses import dataclass
from math import isfinite, pi

import numpy as np

from workbench.control.law import Controller
from workbench.errors import WorkbenchError
from workbench.frequency.notch import Notch
from workbench.plant import Plant

TURN = 2.0 * pi


@dataclass(frozen=True)
class Cascade:
    """kv: 1/s. kvp: N*m*s/rad or N*s/m. ki: N*m/rad or N/m. mass: kg*m^2 or kg. viscous: N*m*s/rad or N*s/m.

    speed_limit: rad/s or m/s. limit: N*m or N. forward: share of the reference's speed that the speed loop is given. rotary.
    notches: behind the speed loop, as part of the loop that was tuned.
    """

    kv: float
    kvp: float
    ki: float
    speed_limit: float
    limit: float
    mass: float = 0.0
    viscous: float = 0.0
    forward: float = 0.0
    rotary: bool = True
    notches: tuple[Notch, ...] = ()

    def __post_init__(self):
        for name in ("kv", "kvp", "ki", "speed_limit", "limit", "mass", "viscous", "forward"):
            value = getattr(self, name)
            if not (isfinite(value) and value >= 0.0):
                raise WorkbenchError(f"a cascade's {name} is {value:g}; a finite number, not negative, is needed.")

    def without_notches(self, where: str) -> None:
        """Raise WorkbenchError where there are notches, for a format that holds none."""
        if self.notches:
            raise WorkbenchError(
                f"{where}: this format holds no notch, and the gains were tuned with {len(self.notches)}: without them the loop "
                "is another. State notches = 0 and tune again, or write the notches as objects (sdo, twincat)."
            )

    @property
    def pid(self) -> tuple[float, float, float]:
        """(p, i, d) of the same law as one PID on the position, d on the measured speed."""
        return self.kvp * self.kv + self.ki, self.ki * self.kv, self.kvp


@dataclass(frozen=True)
class Units:
    """What a drive measures in. counts: encoder counts in a turn, or in a metre. amps: A per N*m or N, or 0 where the drive
    takes torque itself."""

    counts: float = 0.0
    amps: float = 0.0

    def per_count(self, rotary: bool, where: str) -> float:
        """Radians or metres of one count; WorkbenchError where the counts are not stated."""
        if not (isfinite(self.counts) and self.counts > 0.0):
            raise WorkbenchError(
                f"{where}: the encoder's counts are {self.counts:g}; state how many a turn (or metre) has."
            )
        return (TURN if rotary else 1.0) / self.counts

    def per_amp(self, where: str) -> float:
        """N*m or N of one ampere; WorkbenchError where it is not stated."""
        if not (isfinite(self.amps) and self.amps > 0.0):
            raise WorkbenchError(f"{where}: the drive counts current; state amps, how many A one N*m (or N) takes.")
        return 1.0 / self.amps


def cascade_of(controller: Controller, plant: Plant, *, mass: float = 0.0, viscous: float = 0.0, forward: float = 0.0) -> tuple[Cascade, ...]:  # fmt: skip
    """Return a controller as cascades: one, or one a knot of a scheduled PD, in the order of its amplitudes.

    Raises WorkbenchError for a law that no cascade holds, or gains that vary over lanes.
    """
    p, law = controller.parameters, controller.law
    if not isfinite(plant.limits.drive) or not isfinite(plant.limits.speed):
        raise WorkbenchError(
            "a drive is told its limits, and the plant states no limit of drive or of speed: state both."
        )
    if any(np.ndim(v) for v in p.values()) or len(controller.tables) > 1:
        raise WorkbenchError(f"controller '{controller.name}' has several sets of gains; a drive takes one.")
    if law.before is not None:
        raise WorkbenchError(
            f"controller '{controller.name}' was tuned with a notch behind its law, which no cascade holds: its gains keep no margin "
            "without it. Tune it without a notch, or write it as firmware."
        )
    known = {"limit": plant.limits.drive, "mass": mass, "viscous": viscous, "forward": forward, "rotary": plant.rotary}
    if controller.name == "pi_cascade":
        return (Cascade(p["kv"], p["kvp"], p["ki"], p["speed_limit"], **known),)
    if controller.name == "fixed_pd":
        pairs = [(p["kp"], p["kd"])]
    elif controller.name == "scheduled_pd" and "profiled" not in law.name:
        columns = controller.tables[0].columns
        pairs = [(p["scale"] * kp, p["scale"] * kd) for kp, kd in zip(columns["kp"], columns["kd"], strict=True)]
    else:
        raise WorkbenchError(
            f"the law '{law.name}' is no cascade: a drive that takes gains alone cannot hold it. Write it as firmware, or "
            "export the study's PI cascade."
        )
    if any(kd <= 0.0 for _, kd in pairs):
        raise WorkbenchError(f"controller '{controller.name}': a cascade has kv = kp/kd, and kd is zero.")
    return tuple(Cascade(kp / kd, kd, 0.0, plant.limits.speed, **known) for kp, kd in pairs)

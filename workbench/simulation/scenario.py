"""What the controller runs on, and the scenarios that one run puts side by side."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from math import isfinite

import numpy as np

from workbench.effects.elementary import exp
from workbench.errors import WorkbenchError, nearest
from workbench.parameter import ROOM
from workbench.plant import SENSORS


@dataclass(frozen=True)
class Loop:
    """The sampled side.

    sample_time: s. substeps: integration steps a sample. delay: s, of the command, rounded to whole substeps.
    velocity_filter: time constant of the filtered difference, s (0: none). resolution: one encoder count in rad or m
    (0: the reading is exact). With two masses resolution is the motor encoder's, load_resolution the load encoder's, and
    feedback says which of them closes the loop: "position" (the motor's) or "load_position".
    """

    sample_time: float
    substeps: int = 2
    delay: float = 0.0
    velocity_filter: float = 0.0
    resolution: float = 0.0
    load_resolution: float = 0.0
    feedback: str = "position"

    def __post_init__(self):
        if self.feedback not in SENSORS:
            raise WorkbenchError(
                f"the loop's feedback '{self.feedback}' is no reading; {nearest(self.feedback, SENSORS)}"
            )
        if not (isfinite(self.sample_time) and self.sample_time > 0.0):
            raise WorkbenchError(f"the loop's sample time is {self.sample_time:g} s; it must be positive.")
        if int(self.substeps) != self.substeps or self.substeps < 1:
            raise WorkbenchError(f"the loop has {self.substeps} substeps; a whole number from 1 on is needed.")
        for name in ("delay", "velocity_filter", "resolution", "load_resolution"):
            if not (isfinite(getattr(self, name)) and getattr(self, name) >= 0.0):
                raise WorkbenchError(f"the loop's {name} is {getattr(self, name):g}; it must not be negative.")

    @property
    def substep(self) -> float:
        """h in s."""
        return self.sample_time / self.substeps

    @property
    def count(self) -> float:
        """One count of the encoder that closes the loop, rad or m."""
        return self.resolution if self.feedback == "position" else self.load_resolution

    @property
    def smoothing(self) -> float:
        """1 - exp(-Ts/tf), the share of a new difference in the filtered velocity."""
        return 1.0 - exp(-self.sample_time / self.velocity_filter) if self.velocity_filter > 0.0 else 1.0


def loop_under(controller, loop: Loop) -> Loop:
    """Return the loop with the velocity filter that a controller of one lane has of its own, where it has one."""
    own = controller.velocity_filter
    return loop if own is None else replace(loop, velocity_filter=float(np.ravel(own)[0]))


@dataclass(frozen=True)
class Scenario:
    """One lane.

    target, start: position asked for and at first, rad or m; of the load where there are two masses. inertia: factor on
    the plant's masses. load_inertia: added to the mass (the load's), kg*m^2 or kg. friction: factor on every force that is
    friction (declared passive, reading or giving `dir`, or reading `v` alone). load: constant torque or force that opposes positive
    motion, of the load where there are two masses. noise: rms of a torque or force that is drawn anew every sample, near
    normal (the sum of four uniform numbers). speed: of every body at first, rad/s or m/s; friction has moved nowhere yet.
    phase: of the encoders within a count, 0 to 1. delay: s, added to the loop's.
    seed: of the noise. locked: 1 where the load is held at its start, else 0; two masses only. temperature: of the bench, K.
    """

    target: float = 0.0
    inertia: float = 1.0
    friction: float = 1.0
    load: float = 0.0
    noise: float = 0.0
    phase: float = 0.0
    seed: int = 0
    start: float = 0.0
    load_inertia: float = 0.0
    delay: float = 0.0
    locked: float = 0.0
    speed: float = 0.0
    temperature: float = ROOM


NAMES = tuple(f.name for f in fields(Scenario))


@dataclass(frozen=True, eq=False)
class ScenarioArrays:
    """Many scenarios: each field of Scenario as an array (lanes,), or a scalar that holds for all of them."""

    lanes: int
    target: np.ndarray | float = 0.0
    inertia: np.ndarray | float = 1.0
    friction: np.ndarray | float = 1.0
    load: np.ndarray | float = 0.0
    noise: np.ndarray | float = 0.0
    phase: np.ndarray | float = 0.0
    seed: np.ndarray | int = 0
    start: np.ndarray | float = 0.0
    load_inertia: np.ndarray | float = 0.0
    delay: np.ndarray | float = 0.0
    locked: np.ndarray | float = 0.0
    speed: np.ndarray | float = 0.0
    temperature: np.ndarray | float = ROOM

    def __post_init__(self):
        if self.lanes < 1:
            raise WorkbenchError("there is no scenario to simulate; give at least one.")
        for name in NAMES:
            kind = np.uint64 if name == "seed" else np.float64
            value = np.asarray(getattr(self, name))
            if value.ndim and value.shape != (self.lanes,):
                raise WorkbenchError(f"scenarios: {name} has shape {value.shape}; {self.lanes} values are needed.")
            if name != "seed" and not np.isfinite(value).all():
                raise WorkbenchError(f"scenarios: {name} is not finite.")
            object.__setattr__(
                self, name, value.astype(np.int64).astype(kind) if name == "seed" else value.astype(kind)
            )
        if not (self.delay >= 0.0).all() or not (self.noise >= 0.0).all():
            raise WorkbenchError("scenarios: delay and noise must not be negative.")
        if not ((self.locked == 0.0) | (self.locked == 1.0)).all():
            raise WorkbenchError("scenarios: locked is 1 where the load is held, and 0 where it moves.")

    def taken(self, which: np.ndarray) -> "ScenarioArrays":
        """Return the scenarios of these numbers, (n,)."""
        return ScenarioArrays(len(which), **{n: v[which] if (v := getattr(self, n)).ndim else v for n in NAMES})

    def tiled(self, times: int) -> "ScenarioArrays":
        """Return the same scenarios `times` over, one set after another: for a population of gains."""
        return ScenarioArrays(
            self.lanes * times, **{n: np.tile(v, times) if (v := getattr(self, n)).ndim else v for n in NAMES}
        )


def arrays_of(scenarios: "Sequence[Scenario] | ScenarioArrays") -> ScenarioArrays:
    """Return scenarios as arrays; a field that is the same in all becomes a scalar, except target and phase."""
    if isinstance(scenarios, ScenarioArrays):
        return scenarios
    if isinstance(scenarios, Scenario):
        scenarios = [scenarios]
    if not isinstance(scenarios, Iterable):
        raise WorkbenchError("scenarios must be a sequence of Scenario.")
    scenarios = list(scenarios)
    columns = {}
    for name in NAMES:
        values = [getattr(s, name) for s in scenarios]
        same = name not in ("target", "phase") and len(set(values)) == 1
        columns[name] = values[0] if same else np.array(values)
    return ScenarioArrays(len(scenarios), **columns)

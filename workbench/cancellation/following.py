"""What compensation of named effects is worth to a controller: a slow motion that turns, followed with it and without.

A controller's following error of a slow reversing motion is friction's, for inertia asks for next to nothing there. All runs
are one call: gain 0 is the controller alone, and mismatch is a gain that is off, as a friction that is not the one that was
identified would make it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.compensation import Compensator, compensated
from workbench.control import Controller
from workbench.definition import ANGLE
from workbench.errors import WorkbenchError
from workbench.keeping import kept
from workbench.plant import Plant
from workbench.simulation import Loop, ScenarioArrays, simulate

PERIODS = 3  # of the slow motion; the first begins at rest
GAIN = "comp_gain"
LOST = 0.9  # of the amplitude: with an error as large nothing follows


@dataclass(frozen=True)
class Slow:
    """A motion r = A sin(2 pi f t) that begins smoothly: amplitude rad or m, frequency Hz."""

    amplitude: float
    frequency: float

    def reference(self, loop: Loop) -> np.ndarray:
        """Return r (n,) over whole periods; over the first it grows as 1 - cos does."""
        t = loop.sample_time * np.arange(int(round(PERIODS / self.frequency / loop.sample_time)))
        rise = np.where(
            t * self.frequency < 1.0, 0.5 * (1.0 - np.cos(np.pi * np.minimum(t * self.frequency, 1.0))), 1.0
        )
        return self.amplitude * rise * np.sin(2 * np.pi * self.frequency * t)


@dataclass(frozen=True, eq=False)
class Worth:
    """errors: gain of the compensation -> largest following error, rad or m; 0 is the controller alone. time (n,), reference
    (n,), without and with_it (n,): the error over time, r - q."""

    errors: Mapping[float, float]
    time: np.ndarray
    reference: np.ndarray
    without: np.ndarray
    with_it: np.ndarray

    @property
    def ratio(self) -> float:
        """Following error without compensation over that with it."""
        return self.errors[0.0] / self.errors[1.0]

    def off(self, share: float) -> float:
        """The same with the compensation off by a share either way, the worse of both."""
        return self.errors[0.0] / max(self.errors[1.0 - share], self.errors[1.0 + share])


def with_gains(controller: Controller, compensator: Compensator, gains: Sequence[float]) -> Controller:
    """Return the compensated controller with one gain of the compensation a lane."""
    made = compensated(controller, compensator)
    return replace(made, parameters={**made.parameters, GAIN: np.asarray(gains, dtype=float)})


def _undoable(loop: Loop, controller: Controller, compensator: Compensator) -> None:
    """Raise WorkbenchError where a joint's error would be undone for a loop that closes behind the joint: it sees the error."""
    behind = loop.feedback == "load_position" and "motor_y" not in controller.law.reads
    for e in compensator.maps:
        if e.port == ANGLE and behind:
            raise WorkbenchError(
                f"controller '{controller.name}' closes its loop on the output's encoder, within which '{e.named}' lies; undo it "
                "for a loop on the motor's encoder."
            )


@kept
def worth(
    plant: Plant, loop: Loop, controller: Controller, compensator: Compensator, slow: Slow, share: float = 0.3
) -> Worth:
    """Return what a compensation is worth to a controller on a plant; share: mismatch either way.

    WorkbenchError where the controller does not follow the slow motion at all.
    """
    _undoable(loop, controller, compensator)
    gains = (0.0, 1.0, 1.0 - share, 1.0 + share)
    reference = slow.reference(loop)
    output = "q" if plant.kind == "one mass" else "load.q"
    made = with_gains(controller, compensator, gains)
    m = simulate(
        plant, loop, made, ScenarioArrays(len(gains)), reference.size * loop.sample_time, (output,), reference=reference,
        lanes=len(gains),
    )  # fmt: skip
    error = reference[:, None] - m.trajectories[output]
    last = slice(reference.size // PERIODS, None)
    largest = np.abs(error[last]).max(axis=0)
    if not (np.isfinite(largest[0]) and largest[0] < LOST * slow.amplitude):
        raise WorkbenchError(
            f"controller '{controller.name}' does not follow a slow motion of {slow.amplitude:g} {plant.displacement} at "
            f"{slow.frequency:g} Hz, so there is nothing to compensate; take a larger or a slower one."
        )
    errors = {g: float(e) for g, e in zip(gains, np.where(np.isfinite(largest), largest, np.inf), strict=True)}
    return Worth(errors, m.trajectories.time, reference, error[:, 0], error[:, 1])


def bears(plant: Plant, loop: Loop, controller: Controller, compensator: Compensator, slow: Slow) -> bool:
    """Return whether the controller follows the slow motion on the plant without what is cancelled.

    Compensation that sees the plant's motion leaves the loop with that plant: one that friction alone holds up falls there.
    """
    for e in compensator.forces:
        plant = plant.without(e.key)
    reference = slow.reference(loop)
    duration = reference.size * loop.sample_time
    m = simulate(plant, loop, controller, ScenarioArrays(1), duration, reference=reference, lanes=1)
    return bool(m.finite[0] and m.following_error[0] < LOST * slow.amplitude)

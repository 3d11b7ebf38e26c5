"""A plant's friction described over amplitude, and the gains tuned to it at each: what every controller of it begins with."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.description import Equivalent, equivalent_of, friction_of
from workbench.description.friction import RigidAxis, drawn_away
from workbench.errors import WorkbenchError
from workbench.frequency import Response
from workbench.plant import Plant
from workbench.tuning.gains import Gains
from workbench.tuning.goal import TuningGoal
from workbench.tuning.measured import tune_within
from workbench.tuning.tuning import tune

ROUNDS = 2  # of describing and tuning: friction that depends on speed is described at the loop's own frequency
FASTEST = 0.2  # natural frequency times sample time that the first round assumes at most


@dataclass(frozen=True, eq=False)
class TunedAxis:
    """equivalent: of the friction of `rigid`, at the amplitudes (n,) of `gains`, each at the loop's own frequency."""

    rigid: RigidAxis
    equivalent: Equivalent
    gains: Gains

    def described(self, resolution: float) -> Callable[[np.ndarray], Equivalent]:
        """Return amplitudes (n,) -> Equivalent of the friction, each at the natural frequency that the gains give it.

        resolution: of the encoder, rad or m.
        """
        rigid, gains = self.rigid, self.gains
        omega = np.log(np.sqrt((gains.kp + self.equivalent.stiffness) / rigid.inertia))

        def at(amplitudes: np.ndarray) -> Equivalent:
            known = np.exp(np.interp(np.log(amplitudes), np.log(gains.amplitude), omega))
            return equivalent_of(rigid.friction, amplitudes, known, resolution)

        return at


def tuned_axis(
    plant: Plant, amplitudes: np.ndarray, goal: TuningGoal, loop, *, response: Response | None = None
) -> TunedAxis:
    """Return the equivalent friction of a plant of one mass and the gains tuned to it, at amplitudes (n,), rad or m.

    loop: sample_time, delay, velocity_filter (s), resolution. response: a measured frequency response whose modes limit the gains too.
    Margins are asked of the schedule that comes of the gains, not of these. WorkbenchError: no gains keep the goal (OutOfReach), or
    the plant's springs draw the axis away from the middle.
    """
    rigid = friction_of(plant)
    pull = drawn_away(rigid.friction, amplitudes)
    if pull.any():
        i, place = int(np.argmax(pull)), "rad" if plant.rotary else "m"
        raise WorkbenchError(
            f"At amplitude {amplitudes[i]:.3g} {place} the plant's springs draw the axis away from the middle with {pull[i]:.3g} {plant.effort}/{place}, and PD"
            " gains are tuned to axes that stay where they are left; take the springs out of the plant and add their force to the command"
            " (docs/compensation.md)."
        )
    omega = np.minimum(np.sqrt(goal.drive / (amplitudes * rigid.inertia)), FASTEST / loop.sample_time)
    for _ in range(ROUNDS):
        equivalent = equivalent_of(rigid.friction, amplitudes, omega, loop.resolution)
        if response is None:
            gains = tune(equivalent, rigid.inertia, rigid.viscous, goal, loop, margins=False)
        else:
            gains = tune_within(response, equivalent, rigid.inertia, rigid.viscous, goal, loop, margins=False)
        omega = np.sqrt((gains.kp + equivalent.stiffness) / rigid.inertia)
    return TunedAxis(rigid, equivalent, gains)

"""What gains are tuned for."""

from dataclasses import dataclass
from math import inf

from workbench.errors import WorkbenchError


@dataclass(frozen=True)
class TuningGoal:
    """Shortest time into the band, to stay, within these limits.

    overshoot: of the response's own final value. 0.8 % by default, and never more than the band: at 1 % the optimum lies on
        a cliff, where a little less damping (zeta < 0.82609) makes the response leave the 1 % band again, 5.6 instead of
        4.2 natural periods/(2 pi).
    drive: largest torque or force at the start of a step of A, Kp A, N*m or N. speed: its peak speed, rad/s or m/s.
    error: largest share of a step that the spring k_e keeps back, k_e/(k_e + Kp). Dropped, with a finding, where no gains
        reach it. 1: not stated.
    sensitivity: largest |S| of the sampled loop, Ms. 2 leaves a gain margin of 6 dB and a phase margin of 29 degrees.
        inf: not stated.
    band: of the final value.
    """

    overshoot: float = 0.008
    drive: float = inf
    speed: float = inf
    error: float = 1.0
    sensitivity: float = 2.0
    band: float = 0.01

    def __post_init__(self):
        for name, low, high in (
            ("overshoot", 0.0, 1.0),
            ("drive", 0.0, inf),
            ("speed", 0.0, inf),
            ("error", 0.0, 1.0),
            ("sensitivity", 1.0, inf),
            ("band", 0.0, 0.2),
        ):
            value = getattr(self, name)
            if not low < value <= high:
                raise WorkbenchError(f"tuning goal: {name} = {value:g} is outside ({low:g}, {high:g}].")

    @property
    def allowed(self) -> float:
        """The overshoot that is allowed: at most the band, so that a response that enters the band stays."""
        return min(self.overshoot, self.band)

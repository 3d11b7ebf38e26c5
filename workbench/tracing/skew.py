"""A clock that is late between two encoders, judged in their angle before anything in torque.

In torque a late encoder looks like hysteresis and damping of a joint, and a fit that cannot undo it lets the joint carry
nothing. In the angle it is plain (`encoders.clocks`). So it comes first, and its value is held: what a fit in torque makes
of it is worth nothing where the joint is stiff (of four records of robots it came to -27 to 3.5 ms where the angle says 3).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.definition import catalogue
from workbench.encoders.clocks import PLAIN, WORTH, Late, late_clock
from workbench.encoders.wording import late_sentence
from workbench.identification.fit import fitted_on
from workbench.identification.result import Estimate, Fit
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.candidates import ADDITION, Candidate
from workbench.tracing.result import Cause

NAME = "clock_skew"  # of the cause, whichever clock it is


@dataclass(frozen=True, eq=False)
class Skew:
    """late: what the angle says. candidate: the plant with the clock, its values held."""

    late: Late
    candidate: Candidate

    @property
    def sentence(self) -> str:
        return late_sentence(self.late)

    @property
    def parameters(self) -> tuple[Estimate, ...]:
        """The clock's values with the intervals that the angle gives them."""
        clock, s = self.candidate.plant[self.candidate.key], self.late.seconds
        drift = self.late.measured.drift
        half = {"offset": 0.5 * (s.high - s.low), "skew": 0.5 * (drift.high - drift.low)}
        middle = {
            "offset": self.late.values["offset"] + 0.5 * (s.high + s.low) - s.value,
            "skew": self.late.values["skew"],
        }
        return tuple(
            Estimate(
                clock.named, clock.at, n, p.value, middle[n] - half[n], middle[n] + half[n], p.unit, p.meaning, False
            )
            for n, p in clock.parameters.items()
        )


def skew_of(
    inverses: Sequence[InverseDynamics], plant: Plant, share: float = PLAIN, worth: float = WORTH
) -> Skew | None:
    """Return the lateness of one of two encoders by the identification records, None where none is plain.

    share: of the angle that all else leaves, that lateness must take. worth: of the drive, that it must be worth.
    """
    late = late_clock(fitted_on(inverses), plant, share, worth)
    if late is None:
        return None
    clock = catalogue()[late.law](at=f"sensor.{late.channel}")
    inside = {
        n: float(np.clip(v, clock.parameters[n].lower, clock.parameters[n].upper)) for n, v in late.values.items()
    }
    clock = clock(fixed=True, **inside)
    return Skew(late, Candidate(clock.named, clock.at, ADDITION, plant + clock, part=NAME))


def clock(skew: Skew, before: Fit, here: Fit) -> Cause:
    """Return the cause that a late clock is, as the angle between two encoders tells it; shares are of the drive."""
    identification, validation = (
        1.0 - (here.rms[r] / before.rms[r]) ** 2 if before.rms[r] > 0.0 else 0.0 for r in (IDENTIFICATION, VALIDATION)
    )
    power = max(before.identification**2 - here.identification**2, 0.0)
    return Cause(
        skew.candidate.name, skew.candidate.at, skew.sentence, skew.parameters, identification, validation, size=power**0.5,
    )  # fmt: skip

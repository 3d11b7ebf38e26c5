"""A periodic effect whose phase does not carry over, offered as a calibration: its phase on each record, and what that is worth.

An incremental encoder counts from where the axis stood at power-up. What is periodic in a motor's or a gear's true angle
then has another phase in every power-up, with the same order and the same amplitude; used silently it makes a validation
record worse. Its phase is a number to be found at each power-up, by an index pulse or by a short motion.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from workbench.finding import Finding, capital, title
from workbench.identification.result import Estimate
from workbench.record import IDENTIFICATION, VALIDATION

APART = 2.0  # times both 95 % half widths together, from which two phases are two


@dataclass(frozen=True)
class Phase:
    """The first harmonic of a periodic effect, fitted to one record alone. phase: rad, with its 95 % interval."""

    record: str
    role: str
    amplitude: Estimate
    phase: Estimate

    @property
    def half(self) -> float:
        """Half of the phase's 95 % interval, rad."""
        return (self.phase.high - self.phase.low) / 2

    @property
    def shown(self) -> str:
        return f"{self.phase.value:.2f} ± {self.half:.2f} rad on {self.record}"


@dataclass(frozen=True)
class Calibration:
    """A periodic effect that does not carry over. phases: of each record alone. identified, calibrated: error on the
    validation records with the phase of identification, and with amplitude and phase found on each of them."""

    effect: str
    at: str
    phases: tuple[Phase, ...]
    identified: float
    calibrated: float

    @property
    def differs(self) -> bool:
        """Whether a validation record's phase is another one than those of the identification records."""
        known = [p for p in self.phases if p.role == IDENTIFICATION]
        return any(_apart(p, k) for p in self.phases if p.role == VALIDATION for k in known)

    @property
    def sentence(self) -> str:
        name = capital(title(self.effect))
        known = "; ".join(p.shown for p in self.phases)
        if not self.differs:
            return f"{name} does not carry over, and not for its phase: that is {known}. It is not to be used."
        return (
            f"The phase of {title(self.effect)} is {known}: it belongs to one power-up. With amplitude and phase found anew, "
            f"the validation error is {100 * self.calibrated:.2f} % instead of {100 * self.identified:.2f} %. Calibrate it at "
            "each power-up, by an index pulse or a slow motion over one period; until then it is better left out, as it is in the "
            "predictions of validation records that it would make worse."
        )


def _apart(a: Phase, b: Phase) -> bool:
    """Whether two phases differ by more than their intervals, on the circle."""
    off = (a.phase.value - b.phase.value + pi) % (2 * pi) - pi
    return abs(off) > APART * float(np.hypot(a.half, b.half))


def finding(c: Calibration) -> Finding:
    """Return a calibration as a finding."""
    evidence = {f"phase on {p.record}": p.phase.value for p in c.phases}
    evidence |= {"validation error as identified": c.identified, "validation error calibrated": c.calibrated}
    remedy = "give the axis an absolute encoder or an index pulse, and count from it" if c.differs else ""
    return Finding("calibration", f"{c.effect}@{c.at}", c.sentence, evidence, remedy)


def as_dict(c: Calibration) -> dict:
    """Return a calibration as trace.json holds it."""
    phases = [
        {
            "record": p.record,
            "role": p.role,
            "amplitude": {"value": p.amplitude.value, "unit": p.amplitude.unit},
            "phase": {"value": p.phase.value, "unit": "rad", "interval_95": [p.phase.low, p.phase.high]},
        }
        for p in c.phases
    ]
    nrmse = {"identified": c.identified, "calibrated": c.calibrated}
    return {
        "effect": c.effect,
        "at": c.at,
        "differs": c.differs,
        "phases": phases,
        "nrmse": nrmse,
        "sentence": c.sentence,
    }

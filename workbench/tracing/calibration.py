"""A periodic effect whose phase does not carry over, offered as a calibration: its phase on each record, and what that is worth.

An incremental encoder counts from where the axis stood at power-up. What is periodic in a motor's or a gear's true angle
then has another phase in every power-up, with the same order and the same amplitude; used silently it makes a validation
record worse. Its phase is a number to be found at each power-up, by an index pulse or by a short motion.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from workbench.identification.result import Estimate
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.wording_search import phase_shown, phases_sentence

# Factor between an amplitude on validation and that on identification, beyond which it is no wave of another power-up: a cogging that dressed the
# thrust of a propeller's arm has 0.26. Doubled, it is a cause there; halved (1.0), no wave of another power-up is found
ALIKE = 2.0
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
    def same(self) -> bool:
        """Whether the wave is as large on the validation records as on those of identification, but for its phase."""
        of = {
            role: np.mean([p.amplitude.value for p in self.phases if p.role == role])
            for role in (IDENTIFICATION, VALIDATION)
        }
        return of[IDENTIFICATION] / ALIKE <= of[VALIDATION] <= of[IDENTIFICATION] * ALIKE

    @property
    def sentence(self) -> str:
        """Why it does not carry over, and what is to be done."""
        shown = [phase_shown(p.record, p.phase.value, p.half) for p in self.phases]
        return phases_sentence(self.effect, shown, self.differs, self.identified, self.calibrated)


def _apart(a: Phase, b: Phase) -> bool:
    """Whether two phases differ by more than their intervals, on the circle."""
    off = (a.phase.value - b.phase.value + pi) % (2 * pi) - pi
    return abs(off) > APART * float(np.hypot(a.half, b.half))


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

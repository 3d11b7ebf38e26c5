"""Which reading is wrong where a plant comes out otherwise than declared: drive, encoder and time move its parameters by known powers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

# Logarithmic spread of what is declared about what is true, by which the cause of a wrong scale is told.
SPREAD = {"inertia": 0.1, "viscous": 0.7, "dry": 0.4}
DRIVE, ENCODER, TIME = "drive scale", "encoder scale", "time scale"
EFFECT = {  # of a reading that is x times the truth on (inertia, viscous, dry) as fitted: exponents of x
    DRIVE: (1.0, 1.0, 1.0),
    ENCODER: (-1.0, -1.0, 0.0),
    TIME: (2.0, 1.0, 0.0),
}


@dataclass(frozen=True)
class Misread:
    """The records have another inertia than is declared, in `unit`, as if one thing were read `factor` times too large.

    kind: DRIVE, ENCODER or TIME. channel: that is then wrong.
    """

    kind: str
    channel: str
    factor: float
    fitted: float
    declared: float
    unit: str


@dataclass(frozen=True)
class Ratio:
    """A parameter as these records have it over what is declared."""

    kind: str
    fitted: float
    declared: float

    @property
    def log(self) -> float:
        return float(np.log(self.fitted / self.declared))


def cause(ratios: Sequence[Ratio], step: float) -> tuple[str, float]:
    """Return (kind, factor) of the one reading that explains the ratios best: least squares on logarithms."""
    found = {}
    for kind, exponents in EFFECT.items():
        power = dict(zip(SPREAD, exponents, strict=True))
        spread = np.array([*(SPREAD[r.kind] for r in ratios), SPREAD["dry"]])
        # an encoder's step is scaled with what it reads, and by nothing else
        a = np.array([*(power[r.kind] for r in ratios), float(kind == ENCODER)]) / spread
        y = np.array([*(r.log for r in ratios), np.log(step)]) / spread
        x = float(a @ y) / float(a @ a)
        found[kind] = (float(np.sum((y - a * x) ** 2)), x)
    kind = min(found, key=lambda k: found[k][0])
    return kind, float(np.exp(found[kind][1]))

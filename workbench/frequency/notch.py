"""A notch for a mode: zeros on the mode's poles, and poles damped so that the resonance is level with the rest, or nearly."""

from dataclasses import dataclass

import numpy as np

from workbench.frequency.modes import Mode

DAMPEST, LEAST = 0.7, 0.1  # damping ratio of a notch's poles, at most and at least
SURE = 0.1  # share of the centre by which a mode may move and the notch still meet it


@dataclass(frozen=True)
class Notch:
    """(s^2 + 2 depth damping w s + w^2)/(s^2 + 2 damping w s + w^2), w = 2 pi centre.

    centre Hz. width Hz: between the frequencies where a deep notch has fallen by 3 dB, 2 damping centre. depth: gain at the
    centre, 0 to 1.
    """

    centre: float
    width: float
    depth: float

    @property
    def damping(self) -> float:
        return 0.5 * self.width / self.centre

    def at(self, frequency: np.ndarray) -> np.ndarray:
        """Return its response at frequency (n,) Hz."""
        x = np.asarray(frequency, dtype=float) / self.centre
        return (1 - x**2 + 2j * self.depth * self.damping * x) / (1 - x**2 + 2j * self.damping * x)

    @property
    def system(self):
        """python-control's TransferFunction."""
        import control

        w = 2 * np.pi * self.centre
        return control.TransferFunction(
            [1.0, 2 * self.depth * self.damping * w, w**2], [1.0, 2 * self.damping * w, w**2]
        )


def notch_for(mode: Mode) -> Notch:
    """Return the notch that brings a mode's resonance level with the rest, as far as poles of a damping up to DAMPEST do.

    A wider one would cost the loop more phase than the resonance. The zeros' damping is no less than what meets a mode that has moved by SURE of its frequency.
    """
    zeros = max(mode.damping, 0.2 * SURE)
    poles = float(np.clip(zeros * max(mode.rise, 1.0), LEAST, DAMPEST))
    return Notch(mode.frequency, 2 * poles * mode.frequency, min(zeros / poles, 1.0))

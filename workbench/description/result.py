"""What a description over amplitude is."""

from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError
from workbench.notebook import page


@dataclass(frozen=True, eq=False)
class Equivalent:
    """The force F = k_e x + c_e dx/dt that is the first harmonic of an effect under x = A cos(w t).

    amplitude: A (n,), zero to peak (half of the stroke between reversals), rad or m. stiffness: k_e (n,), and loss:
    c_e w (n,), both in N*m/rad or N/m; the energy lost in a cycle is pi A^2 c_e w. The arrays are read-only copies.
    """

    amplitude: np.ndarray
    stiffness: np.ndarray
    loss: np.ndarray

    def __post_init__(self):
        for name in ("amplitude", "stiffness", "loss"):
            array = np.array(getattr(self, name), dtype=float)
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    def _repr_html_(self) -> str:
        """Stiffness and loss over amplitude, as a table and as a drawing."""
        sentence = f"Equivalent stiffness and loss at {self.amplitude.size} amplitudes."
        rows = zip(self.amplitude, self.stiffness, self.loss, strict=True)
        return page(sentence, ("amplitude, rad or m", "stiffness, SI", "loss, SI"), rows, self._draw)

    def _draw(self, axes) -> None:
        (one,) = axes
        one.loglog(self.amplitude, self.stiffness, ".-", label="stiffness")
        one.loglog(self.amplitude, self.loss, ".--", label="loss")
        one.set_xlabel("amplitude, rad or m")
        one.set_ylabel("N·m/rad or N/m")
        one.legend()


def positive(amplitudes) -> np.ndarray:
    """Return amplitudes as an array (n,); WorkbenchError where one is not a finite number above zero."""
    array = np.atleast_1d(np.asarray(amplitudes, dtype=float))
    if array.ndim != 1 or not np.all((array > 0.0) & np.isfinite(array)):
        raise WorkbenchError(f"amplitudes are {amplitudes}; a list of finite numbers above zero is needed.")
    return array

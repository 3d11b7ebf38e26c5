"""What a measured response allows a loop: the largest gain that keeps the sensitivity within a bound at every line."""

from dataclasses import dataclass
from math import inf

import numpy as np

from workbench.errors import WorkbenchError
from workbench.frequency.response import Response

COHERENT = 0.8  # coherence below which a line says nothing about a loop


@dataclass(frozen=True)
class GainLimit:
    """gain: largest factor on the law, inf where no line limits it. frequency: Hz, of the line that does, else nan."""

    gain: float
    frequency: float


def sensitivity_peak(response: Response, law: np.ndarray, beside: np.ndarray | None = None) -> float:
    """Return the largest |S| = 1/|1 + L| over the coherent lines, 0 where there are none; L = law/(1/P + beside).

    P: position over drive as measured. beside (n,): what acts beside it, drive over position, as the equivalent stiffness and
    loss of presliding do where the response is that of sliding. That |S| is small does not say
    that the loop is stable: beyond the border of stability it may be small again.
    """
    sure = response.coherence >= COHERENT
    seen = response.receptance[sure]
    more = 1.0 if beside is None else 1.0 + beside[sure] * seen
    return float(np.max(1.0 / np.abs(1.0 + law[sure] * seen / more), initial=0.0))


def gain_limit(response: Response, law: np.ndarray, sensitivity: float = 2.0) -> GainLimit:
    """Return the largest g for which |1 + g' L| >= 1/Ms at every coherent line, for all g' up to g; L = law x position/drive.

    law (n,): the controller's response at response.frequency, position error to drive, with its delay and notches.
    sensitivity: Ms. The bound is the lower root of g^2 |L|^2 + 2 g Re L + 1 - 1/Ms^2 = 0, the smallest over the lines. As
    no g' up to it meets -1, a loop that is stable at small gain stays so, as far as the lines reach. A law that damps badly
    at small gain, as a PD does on a free mass, has its limit there: follow its sensitivity_peak along gains that damp alike.
    """
    if not sensitivity > 1.0:
        raise WorkbenchError(f"the sensitivity bound is {sensitivity:g}; it must be above 1.")
    if np.shape(law) != response.frequency.shape:
        raise WorkbenchError(f"the law has {np.size(law)} values for {response.frequency.size} lines of the response.")
    loop = np.asarray(law) * response.receptance
    power, real = np.abs(loop) ** 2, loop.real
    room = real**2 - power * (1.0 - 1.0 / sensitivity**2)
    meets = (room >= 0.0) & (real < 0.0) & (response.coherence >= COHERENT)
    if not meets.any():
        return GainLimit(inf, float("nan"))
    roots = (-real[meets] - np.sqrt(room[meets])) / power[meets]
    k = int(np.argmin(roots))
    return GainLimit(float(roots[k]), float(response.frequency[meets][k]))

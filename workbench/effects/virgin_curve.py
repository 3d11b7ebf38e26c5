"""Maxwell slip read off a measured virgin curve."""

from collections.abc import Sequence

from workbench.definition import Effect
from workbench.effects.hysteresis import maxwell_slip
from workbench.errors import WorkbenchError


def slip_of_curve(deflections: Sequence[float], forces: Sequence[float]) -> Effect:
    """Return the Maxwell-slip bank whose virgin curve passes through the given points, and stays level after the last.

    deflections (n,): above 0 and increasing, SI. forces (n,): SI. The slopes between points must not rise (the curve is
    concave) nor fall below 0: k_i is the drop of slope at point i, and a bank with a negative spring gives energy away.
    WorkbenchError says at which point a curve is convex.
    """
    x, y = [0.0, *map(float, deflections)], [0.0, *map(float, forces)]
    if len(x) != len(y) or len(x) < 2 or any(b <= a for a, b in zip(x[:-1], x[1:], strict=True)):
        raise WorkbenchError("a virgin curve needs as many forces as deflections, and these increasing from above 0.")
    slopes = [(y[i + 1] - y[i]) / (x[i + 1] - x[i]) for i in range(len(x) - 1)] + [0.0]
    springs = [a - b for a, b in zip(slopes[:-1], slopes[1:], strict=True)]
    slack = 1e-12 * max(map(abs, slopes))  # rounding on a straight piece
    for i, k in enumerate(springs, 1):
        if k < -slack:
            raise WorkbenchError(
                f"the virgin curve is convex at the deflection {x[i]:g}: its slope rises there from {slopes[i - 1]:g} to "
                f"{slopes[i]:g}, which no passive bank can do; smooth it, or add a hardening spring."
            )
    return maxwell_slip(tuple(x[1:]))(**{f"k{i}": max(k, 0.0) for i, k in enumerate(springs, 1)})

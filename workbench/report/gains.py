"""The headings of figures on gains: how they run over amplitude, and what steps under them come to."""

from collections.abc import Sequence

import numpy as np

from workbench.report import numbers

LEVEL = 0.99  # of the largest gain, from which on another counts as no smaller


def course(values: np.ndarray, unit: str) -> str:
    """Say how gains run over amplitude, by their ends and the largest: "rises from 11.2 to 46.4 and falls to 0.6 N·m/rad"."""
    first, top, last = (numbers.quantity(float(v), unit) for v in (values[0], values.max(), values[-1]))
    if values[0] > values.max() * LEVEL:
        return f"falls from {first} to {last}"
    return f"rises from {first} to {top}" + (f" and falls to {last}" if values[-1] < values.max() * LEVEL else "")


def step_heading(bound: float, times: Sequence[float], errors: Sequence[float], x: str) -> str:
    """Say how soon controllers are within 1 %, against the bound (s), and what error (rad or m, `x`) they leave."""
    within = [t for t in times if np.isfinite(t)]
    when = f"Within 1 % after {_span(within, 's')}" if within else "None comes within 1 %"
    never = f" ({len(times) - len(within)} of {len(times)} never)" if 0 < len(within) < len(times) else ""
    left = f"{_span(errors, x)} is left" if np.all(np.isfinite(errors)) else "not all come to rest"
    return f"{when}{never}, where the bound is {numbers.scaled(bound, 's')}; {left}"


def _span(values: Sequence[float], unit: str) -> str:
    """Return the range of values, or one of them where three figures do not part its ends."""
    low, high = numbers.scaled(min(values), unit), numbers.scaled(max(values), unit)
    return low if low == high else f"{low} to {high}"

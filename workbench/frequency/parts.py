"""From the modes of a response to effects of a plant: a part that swings for each, to start an identification from.

A mode of the free axis lies where all swings together; a part's own frequency is that with the axis held, where the axis
stands still under the drive: the zero of the response below its mode (driving-point responses alternate, Foster 1924).
"""

from math import prod

import numpy as np

from workbench.definition import Effect, find
from workbench.frequency.modes import LARGEST, Modes

PART = "flexible_mode"


def _zeros(modes: Modes) -> np.ndarray:
    """Return the zeros (n,) of acceleration over drive, delay apart, in the upper half plane, by frequency; rad/s."""
    one, poles = np.poly1d([1.0]), [np.poly1d([1.0, 2 * z * w, w**2]) for w, z in modes.poles]
    total = modes.residues[-1] * prod(poles, start=one)
    for k, (r, p) in enumerate(modes.residues[:-1].reshape(-1, 2)):
        total = total + np.poly1d([r, p, 0.0]) * prod(poles[:k] + poles[k + 1 :], start=one)
    roots = np.poly1d(total).roots
    return np.array(sorted(roots[roots.imag > 0], key=abs))


def flexible_modes(modes: Modes) -> tuple[Effect, ...]:
    """Return one `flexible_mode` a mode that has a zero below it, frequency and damping set, labelled where there are several.

    Masses are left to identification, in which they are linear. A mode without a zero below it (the encoder sits on another
    part than the drive) is none of these, and left out.
    """
    parts, below = [], 0.0
    for mode in modes.modes:
        between = [r for r in _zeros(modes) if below < abs(r) < 2 * np.pi * mode.frequency]
        between = [r for r in between if 0.0 < -r.real < LARGEST * abs(r)]
        if between:
            parts.append((abs(between[-1]) / (2 * np.pi), -between[-1].real / abs(between[-1])))
        below = 2 * np.pi * mode.frequency
    names = [str(i) for i in range(1, len(parts) + 1)] if len(parts) > 1 else [""]
    return tuple(find(PART)(frequency=f, damping=z, label=n) for (f, z), n in zip(parts, names, strict=False))

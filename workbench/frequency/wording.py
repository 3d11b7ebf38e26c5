"""What is said of a frequency response: each mode and the notch for it."""

from math import log10

from workbench.finding import MODE, Finding
from workbench.frequency.modes import RISES, Mode, Modes
from workbench.frequency.notch import Notch, notch_for
from workbench.frequency.response import Response


def decibels(gain: float) -> float:
    return 20.0 * log10(max(gain, 1e-9))


def findings(response: Response, modes: Modes) -> tuple[Finding, ...]:
    """Say each mode and the notch for it, or that there is none in the band."""
    found = [_mode(m, notch_for(m)) for m in modes.modes]
    if not found:
        low, high = response.frequency[[0, -1]]
        text = f"Record '{response.record}' shows no mode between {low:.3g} and {high:.3g} Hz that rises {decibels(RISES):.0f} dB."
        found.append(Finding("no mode", response.record, text))
    return tuple(found)


def _mode(m: Mode, n: Notch) -> Finding:
    sentence = (
        f"A mode at {m.frequency:.4g} Hz (within {m.frequency_half:.2g} Hz) with a damping ratio of {m.damping:.3g} (within "
        f"{m.damping_half:.1g}) rises {decibels(m.rise):.0f} dB above the rest of the response; a notch at {n.centre:.4g} Hz, "
        f"{n.width:.3g} Hz wide, takes {-decibels(n.depth):.0f} dB off it."
    )
    evidence = {"frequency": m.frequency, "damping": m.damping, "rise": m.rise, "width": n.width, "depth": n.depth}
    return Finding(
        MODE, f"{m.frequency:.4g} Hz", sentence, evidence, "put the notch into the loop, or stay below the mode"
    )

"""What a frequency response comes to: sentences, a table, and the modes as JSON."""

import json
from math import log10
from pathlib import Path

import numpy as np

from workbench.finding import Finding
from workbench.frequency.modes import RISES, Mode, Modes
from workbench.frequency.notch import Notch, notch_for
from workbench.frequency.response import Response

TABLE, JSON = "response.csv", "response.json"


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
        "mode", f"{m.frequency:.4g} Hz", sentence, evidence, "put the notch into the loop, or stay below the mode"
    )


def write(folder: Path, response: Response, modes: Modes, rotary: bool) -> None:
    """Write response.csv and response.json into an existing folder."""
    unit = "rad_per_s2_per_Nm" if rotary else "m_per_s2_per_N"
    rows = np.column_stack([
        response.frequency, np.abs(response.value), np.degrees(np.unwrap(np.angle(response.value))), response.coherence,
        response.deviation, np.abs(modes.at(response.frequency)),
    ])  # fmt: skip
    header = f"frequency_Hz,magnitude_{unit},phase_deg,coherence,deviation_{unit},fitted_{unit}"
    np.savetxt(folder / TABLE, rows, fmt="%.6g", delimiter=",", header=header, comments="")
    content = {
        "format": 1,
        "record": response.record,
        "method": response.method,
        "averages": float(response.averages),
        "delay": modes.delay,
        "misfit": modes.misfit,
        "modes": [
            {
                "frequency": m.frequency,
                "frequency_half_width": m.frequency_half,
                "damping": m.damping,
                "damping_half_width": m.damping_half,
                "rise": m.rise,
                "notch": {"centre": n.centre, "width": n.width, "depth": n.depth},
            }
            for m, n in ((m, notch_for(m)) for m in modes.modes)
        ],
        "sentences": [f.sentence for f in findings(response, modes)],
    }
    (folder / JSON).write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", encoding="utf-8")

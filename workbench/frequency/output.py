"""What a frequency response comes to as files: a table, and the modes as JSON."""

import json
from pathlib import Path

import numpy as np

from workbench.frequency.modes import Modes
from workbench.frequency.notch import notch_for
from workbench.frequency.response import Response
from workbench.frequency.wording import findings

TABLE, JSON = "response.csv", "response.json"


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

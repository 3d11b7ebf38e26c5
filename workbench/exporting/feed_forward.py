"""What the model knows of the motion, for firmware: mass, and sliding friction over speed, as a C header and as JSON."""

import json
from pathlib import Path

import numpy as np

from workbench.control import FeedForward
from workbench.errors import WorkbenchError
from workbench.exporting.document import floats
from workbench.exporting.header import harmless, table
from workbench.plant import Plant
from workbench.together import write_together

HEAD = """/* Feed-forward of an axis: torque = mass * acceleration + sgn(v) * friction(|v|), SI.
 * Between speeds friction lies on a straight line; below the first it falls to zero along one.
 * Plant {digest}:
{lines}
 */
#ifndef WB_{NAME}_H
#define WB_{NAME}_H

#define WB_{NAME}_COUNT {count}
#define WB_{NAME}_MASS {mass} /* {mass_said} {mass_unit} */

{tables}

#endif
"""


def export_feed_forward(known: FeedForward, plant: Plant, folder: Path, name: str = "feed_forward") -> tuple[Path, ...]:
    """Write `<name>.h` and `<name>.json` into a folder, both or neither; return their paths.

    WorkbenchError where float32 does not hold a value, or a folder cannot be written.
    """
    values = np.array([known.mass, *known.speeds, *known.friction], dtype=float)
    if not (np.abs(values) <= np.finfo(np.float32).max).all():
        raise WorkbenchError("feed-forward: a value is too large for float32, which the header holds.")
    x, f = plant.displacement, plant.effort
    units = {"mass": f"{f}*s^2/{x}", "speeds": f"{x}/s", "friction": f}
    document = {
        "format": "servo-workbench feed-forward",
        "format_version": 1,
        "units": units,
        "mass": float(known.mass),
        "speeds": floats(known.speeds),
        "friction": floats(known.friction),
        "plant": {"digest": plant.digest, "lines": list(plant.digest_lines())},
    }
    upper = name.upper()
    rows = {key: np.asarray(getattr(known, key), dtype=float).astype(np.float32) for key in ("speeds", "friction")}
    text = HEAD.format(
        digest=plant.digest,
        lines="\n".join(f" *   {harmless(line)}" for line in plant.digest_lines()),
        NAME=upper,
        count=known.speeds.size,
        mass=f"{float(np.float32(known.mass))!r}f",
        mass_said=f"{known.mass:.9g}",
        mass_unit=units["mass"],
        tables="\n\n".join(table(f"wb_{name}_{key}", units[key], row, f"WB_{upper}") for key, row in rows.items()),
    )
    files = {f"{name}.h": text.encode(), f"{name}.json": (json.dumps(document, indent=1) + "\n").encode()}
    return write_together(Path(folder), files)

"""Friction in steady sliding as a compensation table: the force to add to the command, over the speed asked for."""

import numpy as np

from workbench.drives.maps import Map, cells_of, read, values_of
from workbench.errors import WorkbenchError
from workbench.plant import Plant
from workbench.simulation.dynamics import is_friction

WHAT = "friction"
SAMPLES = 200  # of a slide over one rad or m, far beyond presliding: friction with memory has forgotten its start then


def _sliding(plant: Plant, speed: float) -> float:
    """Friction of one mass in N*m or N at a steady speed, rad/s or m/s, not zero."""
    way = np.sign(speed)
    one = np.ones(SAMPLES)
    dq = way / SAMPLES
    signals = {"v": speed * one, "dir": way * one, "dq": dq * one, "dt": abs(dq / speed) * one, "a": 0.0 * one}
    parts = [e for e in plant.effects if is_friction(e) and e.at == "axis" and set(e.reads) <= set(signals)]
    if not parts:
        raise WorkbenchError("the plant has no friction over speed that could be compensated; declare or trace it.")
    return float(sum(values_of(e, signals)[-1] for e in parts))


def write(plant: Plant, top: float, count: int = 64) -> str:
    """Return the table from -top to top, rad/s or m/s, `count` rows, none at zero, where friction has no one value.

    WorkbenchError without friction, for a top that is not positive, or for an odd count.
    """
    if not (np.isfinite(top) and top > 0.0) or cells_of(count) % 2:
        raise WorkbenchError(
            f"a table of friction up to {top:g} with {count} rows: a positive speed and an even count are needed."
        )
    half = (np.arange(count // 2) + 0.5) * (2.0 * top / count)
    v = np.concatenate([-half[::-1], half])
    y = np.array([_sliding(plant, x) for x in v])
    return Map(WHAT, f"speed [{plant.displacement}/s]", f"force [{plant.effort}]", v, y, 0.0, False).text()


def load(content: str) -> Map:
    """Return the map of a table, checked."""
    return read(content, WHAT)

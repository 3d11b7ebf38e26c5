"""What is known of the samples of a problem, and how much of a residual lies in a window of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import PLACES, Plant
from workbench.residual.window import Window


@dataclass(frozen=True, eq=False)
class Samples:
    """What is known of each row of a stacked problem: position, velocity, direction (1 forward, -1 backward, 0 neither),
    time, drive's balance or not, floor (rms)."""

    q: np.ndarray
    v: np.ndarray
    direction: np.ndarray
    t: np.ndarray
    drive: np.ndarray
    floor: np.ndarray


def samples(inverses: Sequence[InverseDynamics], plant: Plant, level: Mapping[str, float]) -> Samples:
    """Return the samples of a problem over these inverse dynamics. level: record -> rms of the floor.

    The direction is that of friction at the drive's side: what acts in one direction acts by it, and friction that remembers
    turns later than the velocity.
    """
    parts: list[list[np.ndarray]] = [[] for _ in fields(Samples)]
    for p in inverses:
        m, keep, balances = p.motion, p.motion.keep, p.rows(plant)
        n = keep.stop - keep.start
        drive = np.tile(np.arange(balances) == 0, n)
        floor = np.full(n, level[m.record.name])
        direction = np.sign(p.direction(plant, PLACES[plant.kind][0]))
        for part, x in zip(parts, (m.q[keep], m.v[keep], direction[keep], m.t[keep], None, floor), strict=True):
            part.append(drive if x is None else np.repeat(x, balances))
    return Samples(*(np.concatenate(part) for part in parts))


def excess_of(residual: np.ndarray, known: Samples) -> np.ndarray:
    """Return each row's squared residual less the floor's, zero where it is no drive's balance."""
    return np.where(known.drive, residual**2 - known.floor**2, 0.0)


def times_floor(residual: np.ndarray, known: Samples) -> float:
    """Return the rms of the drive's residual over that of the floor; zero where there is no floor."""
    power = float(np.sum(residual[known.drive] ** 2))
    floor = float(np.sum(known.floor[known.drive] ** 2))
    return (power / floor) ** 0.5 if floor > 0 else 0.0


def relative_rms(residual: np.ndarray, rows: np.ndarray, known: Samples) -> float:
    """Return the rms of the drive's residual over the floor's, in some rows (N,) of bool."""
    rows = rows & known.drive
    power, floor = np.sum(residual[rows] ** 2), np.sum(known.floor[rows] ** 2)
    return float(np.sqrt(power / floor)) if floor > 0 else float("inf") if power > 0 else 0.0


def left_in(window: Window, residual: np.ndarray, known: Samples) -> Window:
    """Return the window with what `residual` leaves inside and outside."""
    inside, outside = (relative_rms(residual, rows, known) for rows in (window.rows, ~window.rows))
    return replace(window, inside=inside, outside=outside)

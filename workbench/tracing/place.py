"""A place in which a residual may live, and what is known of the samples of a problem."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from workbench.identification.passes import InverseDynamics
from workbench.plant import PLACES, Plant

LOCAL = 0.55  # share of the excess in a place, less the share of samples, from which it lives there
CONTRAST = 2.0  # rms inside over rms outside
WAYS = {0: "either direction", 1: "forward", -1: "backward"}


@dataclass(frozen=True)
class Place:
    """coordinate: "position", "velocity" (spans of its magnitude) or "time". spans: (low, high), SI.

    direction: 1 forward, -1 backward, 0 either. share: of the excess power inside. covered: share of the samples inside.
    inside, outside: rms of the residual over the floor's. rows: (N,) of bool, the rows of the problem inside.
    """

    coordinate: str
    spans: tuple[tuple[float, float], ...]
    direction: int
    share: float
    covered: float
    inside: float
    outside: float
    rows: np.ndarray


@dataclass(frozen=True, eq=False)
class Samples:
    """What is known of each row of a stacked problem: position, velocity, way (1 forward, -1 backward, 0 neither), time,
    drive's balance or not, floor (rms)."""

    q: np.ndarray
    v: np.ndarray
    way: np.ndarray
    t: np.ndarray
    drive: np.ndarray
    floor: np.ndarray


def samples(passes: Sequence[InverseDynamics], plant: Plant, level: Mapping[str, float]) -> Samples:
    """Return the samples of a problem over these passes. level: record -> rms of the floor.

    The way is that of friction at the drive's side: what acts in one direction acts by it, and friction that remembers turns
    later than the velocity.
    """
    parts: list[list[np.ndarray]] = [[] for _ in fields(Samples)]
    for p in passes:
        m, keep, balances = p.motion, p.motion.keep, p.rows(plant)
        n = keep.stop - keep.start
        drive = np.tile(np.arange(balances) == 0, n)
        floor = np.full(n, level[m.record.name])
        way = np.sign(p.direction(plant, PLACES[plant.kind][0]))
        for part, x in zip(parts, (m.q[keep], m.v[keep], way[keep], m.t[keep], None, floor), strict=True):
            part.append(drive if x is None else np.repeat(x, balances))
    return Samples(*(np.concatenate(part) for part in parts))


def excess_of(residual: np.ndarray, known: Samples) -> np.ndarray:
    """Return each row's squared residual less the floor's, zero where it is no drive's balance."""
    return np.where(known.drive, residual**2 - known.floor**2, 0.0)


def weighed(place: Place, residual: np.ndarray, known: Samples) -> Place:
    """Return the place with what `residual` leaves inside and outside."""

    inside, outside = (over(residual, rows, known) for rows in (place.rows, ~place.rows))
    return Place(
        place.coordinate, place.spans, place.direction, place.share, place.covered, inside, outside, place.rows,
    )  # fmt: skip


def over(residual: np.ndarray, rows: np.ndarray, known: Samples) -> float:
    """Return the rms of the drive's residual over the floor's, in some rows (N,) of bool."""
    rows = rows & known.drive
    power, floor = np.sum(residual[rows] ** 2), np.sum(known.floor[rows] ** 2)
    return float(np.sqrt(power / floor)) if floor > 0 else float("inf") if power > 0 else 0.0


def score(place: Place) -> float:
    return place.share - place.covered


def local(place: Place | None) -> bool:
    """Whether a place is one: most of the excess, few of the samples, and calm outside."""
    return place is not None and score(place) > LOCAL and place.inside > CONTRAST * place.outside

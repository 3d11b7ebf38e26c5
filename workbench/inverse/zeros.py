"""Zeros of two encoders: where one says more than a joint can, what lies between them is where each was set to zero.

Two encoders that were set to zero with the joint relaxed agree at rest. Others have a zero of their own, and it changes from
record to record where one of them is incremental. It is read off the angle between them, from motion alone:

    q_m - q_l = x0 + c1 a_l + c2 v_l + c3 sign(v_l) + c4 (q_l - p)        x0 of each record, c of all

c1 to c3 are what drives the load, and lateness; c4 is a weight or a spring that the joint holds, which winds it up with place, as seen from p,
the place of the travel nearest to the encoder's zero. Without it an arm that hangs on its joint had zeros that lie apart.

Where the zeros lie apart by less, the first reading of a record that begins at rest tells, the joint relaxed but for a weight, if the
motion says nearly the same; one that begins in motion has the zero on which those agree, or what its motion says. Both
take with them what the joint carries then (x0 its mean). So where zeros are free the joint's mean torque is no reading
either: it is what closes the load's balance over the record (`closed`), in a fit and in a prediction alike.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from workbench.motion import MOTION_BAND, LowPass
from workbench.record import Record

# Angle between encoders at rest over the rms of what is left of it, the elastic deflection of a moving joint, from which
# their zeros are free. Of 78 axes it is 0.70 and more on six with zeros of their own, and 0.55 at most on others, of which it was up to 1.7
# where a weight winds the joint up and c4 was not asked; halved, seven more have free zeros; doubled, two have none. Also how far a first reading
# may lie from it: of 23 axes whose records begin with their encoders apart it does by
# 0.42 at most, and by 0.77 and 1.05 of two whose joints friction holds wound up, by 0.74 to 1.15 of four that a weight winds up; halved, four that
# have separate zeros have none.
APART = 0.5
# Of its usual (rms) speed, at which a record begins in motion. Of 146 axes with two encoders (649 records) 26 have other zeros for it, fifteen of which had
# what a joint carried for one. Halved, the zero of one more record is what its motion says; doubled, three of the fifteen have a false one
SLOW = 0.02
STARTS = 1.5  # coarser counts between the first readings, from which they are not one: two encoders with one zero round apart by one


def _angles(records: Sequence[Record], bandwidth: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Return (x0 (records,), rms of the angle about x0) of records with two encoders; None where these do not tell."""
    columns, apart, which = [], [], []
    places = np.concatenate([r.channels["load_position"] for r in records])
    nearest = float(np.clip(0.0, places.min(), places.max()))
    for k, r in enumerate(records):
        smooth = LowPass(MOTION_BAND * bandwidth, 1 / r.dt, r.time.size)
        q, v, a = smooth.derivatives(r.channels["load_position"], 3)
        keep = slice(smooth.trim, r.time.size - smooth.trim)
        columns.append(np.column_stack([a, v, np.sign(v), q - nearest])[keep])
        apart.append(smooth(r.channels["position"] - r.channels["load_position"])[keep])
        which.append(np.full(len(apart[-1]), k))
    which = np.concatenate(which)
    moving = np.concatenate(columns)
    norms = np.sqrt(np.einsum("ij,ij->j", moving, moving))
    own = (which[:, None] == np.arange(len(records))).astype(float)
    x = np.hstack([moving / np.where(norms > 0.0, norms, 1.0), own])
    found = np.linalg.lstsq(x, np.concatenate(apart), rcond=1e-9)[0]
    zero = found[moving.shape[1] :]
    left = np.concatenate(apart) - own @ zero
    return (zero, float(np.sqrt(np.mean(left**2)))) if np.isfinite(found).all() else None


def relaxed(records: Sequence[Record], bandwidth: float) -> tuple[Record, ...]:
    """Return the records with the zeros of their load encoders where the motors' are, if they lie apart anywhere.

    Records without a second encoder stay as they are. Of those whose load is held no motion tells: their first reading does.
    """
    both = [r for r in records if "load_position" in r.channels]
    free = [r for r in both if not r.locked]
    found = _angles(free, bandwidth) if free else None
    if found is None:
        return tuple(records)
    if np.max(np.abs(found[0])) > APART * found[1]:
        zero = {r.name: _first(r) for r in both if r.locked}
        zero |= dict(zip((r.name for r in free), found[0].tolist(), strict=True))
    elif any(abs(_first(r)) > STARTS * _coarser(r) > 0.0 for r in both if _rests(r)) and not _wound(free, *found):
        zero = _at_rest(both, dict(zip((r.name for r in free), found[0].tolist(), strict=True)))
    else:
        return tuple(records)
    return tuple(_shifted(r, zero[r.name]) if r.name in zero else r for r in records)


def _wound(records: Sequence[Record], zero: np.ndarray, deflection: float) -> bool:
    """Whether a record begins with its joint wound up, or at an edge of its gap: its first reading lies farther from what the whole motion
    says of its zero than APART of what a moving joint deflects."""
    return any(abs(_first(r) - x) > APART * deflection for r, x in zip(records, zero, strict=True) if _rests(r))


def _at_rest(records: Sequence[Record], of_motion: Mapping[str, float]) -> dict[str, float]:
    """Return record -> zero: the first reading of what begins at rest; of another record that on which those agree, or what its motion says."""
    zero = {r.name: _first(r) for r in records if _rests(r) or r.name not in of_motion}
    told = [zero[r.name] for r in records if _rests(r)]
    agree = max(told) - min(told) <= STARTS * min(_coarser(r) for r in records)
    moving = {name: told[0] if agree else x for name, x in of_motion.items() if name not in zero}
    return zero | moving


def _rests(record: Record) -> bool:
    """Whether both bodies of a record move by no more than STARTS counts within its first five samples, or begin at SLOW of their usual speed."""
    return all(_slow(record.channels[n], STARTS * _coarser(record)) for n in ("position", "load_position"))


def _slow(q: np.ndarray, counts: float) -> bool:
    """Whether a reading begins slowly: by the parabola of its first samples, since fine encoders see at once what starts from rest."""
    usual = float(np.sqrt(np.mean(np.diff(q) ** 2)))
    begins = abs(-3.0 * q[0] + 4.0 * q[2] - q[4]) / 4.0
    return float(np.ptp(q[:5])) <= counts or begins <= SLOW * usual


def _first(record: Record) -> float:
    """Return the angle between the encoders' first readings."""
    return float(record.channels["position"][0] - record.channels["load_position"][0])


def _coarser(record: Record) -> float:
    """Return the larger count of the two encoders, 0 where one is unknown."""
    counts = [record.resolution.get(n, 0.0) for n in ("position", "load_position")]
    return max(counts) if min(counts) > 0.0 else 0.0


def _shifted(record: Record, zero: float) -> Record:
    """Return a record whose load encoder reads `zero` (rad or m) more, and says so."""
    moved = record.channels["load_position"] + zero
    return replace(record, channels={**record.channels, "load_position": moved}, zero=zero)


def closed(change: np.ndarray, of: np.ndarray, keep: slice) -> np.ndarray:
    """Return `change` (..., 2, n) with the joint's mean torque where it closes the load's balance `of` (..., 2, n) over `keep`.

    What the load's balance leaves in the mean is a torque of the joint: it is taken from the load and given to the motor.
    """
    mean = of[..., 1, keep].mean(axis=-1)[..., None]
    return np.stack([change[..., 0, :] + mean, change[..., 1, :] - mean], axis=-2)

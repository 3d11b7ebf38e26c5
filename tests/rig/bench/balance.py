"""What the declared model leaves of a bench's records, and what a fit of its free parameters takes: sizes and errors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rig.bench.contacts import of_curve
from rig.bench.kernel import played, rubbed
from rig.bench.machines import Declared, Stand
from rig.bench.measuring import Log
from rig.signals import low_pass

ENDS = 0.1  # s, at both ends of a record, in which nothing is compared


def contact(x: np.ndarray, count: float, curve: tuple[float, float] | None, stretch: float = 1.0) -> np.ndarray:
    """Friction of height one, as declared, behind a dead band of one count."""
    bristles = np.array([[2.0 * count, 1.0]]) if curve is None else of_curve(stretch * curve[0], curve[1])
    return rubbed(played(x, count), bristles)


def terms(s: Stand, log: Log, band: float) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return column -> (in the motor's balance, in the load's), of one mass (in its balance, empty)."""
    q, v, a = (low_pass(log.q, log.rate, 2 * band, k) for k in range(3))
    none, f = np.zeros(0), s.machine.facts
    at = "motor" if s.machine.two else "axis"
    found = {"inertia": a, "viscous": v, "one": np.ones(q.size), "sine": np.sin(q), "cosine": np.cos(q), "place": q}
    curve = s.curves.get(at)
    found["dry"] = contact(log.q, f.count, curve)
    if curve:
        found["dry_x0"] = (contact(log.q, f.count, curve, 1.05) - found["dry"]) / 0.05
    if not s.machine.two:
        return {k: (x, none) for k, x in found.items()}
    ql, vl, al = (low_pass(log.ql, log.rate, 2 * band, k) for k in range(3))
    both, zero = {k: (x, np.zeros(x.size)) for k, x in found.items()}, np.zeros(q.size)
    both |= {
        "load_inertia": (zero, al),
        "load_viscous": (zero, vl),
        "load_dry": (zero, contact(log.ql, s.load_count, None)),
    }
    joint = {"stretch": q - ql, "rate": v - vl}
    if "joint" in s.curves:
        fine = f.count + s.load_count
        joint["joint_dry"] = contact(log.q - log.ql, fine, s.curves["joint"])
        joint["joint_dry_x0"] = (contact(log.q - log.ql, fine, s.curves["joint"], 1.05) - joint["joint_dry"]) / 0.05
    return both | {k: (x, -x) for k, x in joint.items()}


@dataclass(frozen=True, eq=False)
class Left:
    """Of some records: what the declared values leave (n,), the columns of what is free (n, k), which rows are the drive's own
    balance, and the drive's rms."""

    y: np.ndarray
    x: np.ndarray
    own: np.ndarray
    drive: float

    def fitted(self) -> np.ndarray:
        scale = np.maximum(np.linalg.norm(self.x, axis=0), 1e-300)
        return np.linalg.lstsq(self.x / scale, self.y, rcond=1e-9)[0] / scale

    def error(self, weights: np.ndarray) -> float:
        """rms of what is left of the drive's balance over the drive's."""
        return float(np.sqrt(np.mean((self.y - self.x @ weights)[self.own] ** 2)) / self.drive)

    def whole(self, weights: np.ndarray) -> float:
        """The same of all balances together."""
        return float(np.sqrt(np.sum((self.y - self.x @ weights) ** 2) / self.own.sum()) / self.drive)


def free(declared: Sequence[Declared]) -> list[str]:
    return [p.column for d in declared for p in d.parameters if p.column and not p.fixed]


def left(s: Stand, declared: Sequence[Declared], values: dict[str, float], logs: Sequence[Log], band: float) -> Left:
    """What the declared values leave of these records. values: column -> its factor (curves have theirs beside)."""
    names = free(declared)
    ys, xs, own, drive = [], [], [], []
    for log in logs:
        found = terms(s, log, band)
        keep = slice(round(ENDS * log.rate), -round(ENDS * log.rate))
        both = not log.locked and s.machine.two
        filtered = {
            k: np.concatenate([low_pass(x, log.rate, band)[keep] for x in parts[: 1 + both] if x.size])
            for k, parts in found.items()
            if k in names or values.get(k, 0.0) != 0.0
        }
        u = low_pass(log.u, log.rate, band)[keep]
        y = np.concatenate([u, np.zeros(u.size)]) if both else u
        ys.append(y - sum(values[k] * x for k, x in filtered.items() if k in values))
        xs.append(np.column_stack([filtered[k] for k in names]) if names else np.zeros((y.size, 0)))
        own.append(np.arange(y.size) < u.size)
        drive.append(u)
    rms = float(np.sqrt(np.mean(np.concatenate(drive) ** 2)))
    return Left(np.concatenate(ys), np.concatenate(xs), np.concatenate(own), rms)

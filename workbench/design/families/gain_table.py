"""A gain table as a family of few numbers: the ratio Kp/Kd at some amplitudes, and Kp as stiff along it as |S| allows.

Where gains are optimised on simulated steps over friction and inertia, the sensitivity stops nearly all of them: Kp then follows
from the ratio, and the ratio over amplitude is what is left to choose. It falls with amplitude, and so Kp does: no blend of two
curves can make it rise. The search begins at the ratios of the tuned gains, looked up at `ahead` times the amplitude: under
the rule "error" the amplitude is the error that is left, which is part of the step that the gains were tuned for.

The last number of a point is the velocity filter: one that is quick leaves phase to the gains, and more of the encoder's counts in
the command.
"""

from dataclasses import dataclass, replace

import numpy as np

from workbench.control import grid, scheduled_pd
from workbench.description import Equivalent
from workbench.design.families.family import Blend, Family
from workbench.design.families.linear import Linear
from workbench.design.families.shaped import FASTEST, FILTER
from workbench.tuning.axis import Axis
from workbench.tuning.reach import stiffest

NODES = 9  # ratios that are free, even in log amplitude, where no others are asked for
EDGE = 240  # ratios at which the stiffest Kp is computed; between them it is interpolated to 1e-4
SAFE = 0.999  # of the stiffest Kp: what interpolation between them and between knots may cost of |S|
FILTERS = np.geomspace(
    FASTEST, 4.0, 17
)  # samples: velocity filters at which the stiffest Kp is computed; between them to 1e-3
BEGUN = 0.4  # samples: where the search for the filter begins
FREE = 3.0  # a ratio is sought within this factor of the tuned gains' range


@dataclass(frozen=True, eq=False)
class GainTable:
    """Free ratios at nodes (n,), rad or m, on knots (m,). ratio (EDGE,): 1/s. filters (g,): s. stiff (g, EDGE): the stiffest Kp, SI,
    at each filter and ratio. most (g,): the ratio at which it is largest."""

    nodes: np.ndarray
    knots: np.ndarray
    ratio: np.ndarray
    filters: np.ndarray
    stiff: np.ndarray
    most: np.ndarray
    reversal: float

    def gains(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (kp, kd) (points, m), SI, of ratios and filter (points, n + 1): straight in log-log between nodes, never rising."""
        where, ratios = np.log(self.knots), np.log(points[:, :-1])
        return self.along(np.stack([np.interp(where, np.log(self.nodes), row) for row in ratios]), points[:, -1])

    def switched(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (kp, kd) (points, m) of points (p, 4): the ratio up to an amplitude, that beyond it, the amplitude, and the filter."""
        near, far, switch = (points[:, k : k + 1] for k in range(3))
        return self.along(np.log(np.where(self.knots <= switch, near, far)), points[:, 3])

    def along(self, curves: np.ndarray, filters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (kp, kd) (points, m) of the logarithm of the ratio at every knot (points, m), held from rising, with filters (points,)."""
        most = np.interp(np.log(filters), np.log(self.filters), np.log(self.most))
        curves = np.minimum.accumulate(np.clip(curves, np.log(self.ratio[0]), most[:, None]), axis=1)
        kp = SAFE * self.stiffest(np.exp(curves), filters)
        return kp, kp / np.exp(curves)

    def stiffest(self, ratio: np.ndarray, filters: np.ndarray) -> np.ndarray:
        """Return the stiffest Kp (points, m) at ratios (points, m) with filters (points,)."""
        at = np.clip(
            np.interp(np.log(filters), np.log(self.filters), np.arange(self.filters.size)), 0, self.filters.size - 1
        )
        low = np.minimum(at.astype(int), self.filters.size - 2)
        known, wanted, rows = np.log(self.ratio), np.log(ratio), np.log(self.stiff)
        either = [
            np.stack([np.interp(w, known, rows[i + k]) for w, i in zip(wanted, low, strict=True)]) for k in (0, 1)
        ]
        share = (at - low)[:, None]
        return np.exp((1.0 - share) * either[0] + share * either[1])


def gain_table(
    linear: Linear,
    amplitude: np.ndarray,
    reversal: float,
    sensitivity: float,
    per_octave: int = 2,
    nodes: np.ndarray | None = None,
) -> GainTable:
    """Return the table over amplitudes (n,) that keeps |S| <= sensitivity, sliding and on the stiffest spring. nodes (m,): amplitudes
    at which its ratio is free; NODES of them where absent."""
    ratio, filters = np.geomspace(1e-3, 1.0, EDGE) / linear.loop.sample_time, FILTERS * linear.loop.sample_time
    stiff = np.stack([_stiff(linear, ratio, f, sensitivity) for f in filters])
    most = ratio[
        stiff.argmax(axis=1)
    ]  # a larger ratio has to be softer again: damping, not stiffness, is then what is short
    nodes = np.geomspace(amplitude[0], amplitude[-1], NODES) if nodes is None else nodes
    knots = grid(float(amplitude[0]), float(amplitude[-1]), per_octave)
    return GainTable(nodes, knots, ratio, filters, stiff, most, reversal)


def _stiff(linear: Linear, ratio: np.ndarray, velocity_filter: float, sensitivity: float) -> np.ndarray:
    """Return the stiffest Kp (m,), SI, at ratios (m,), 1/s, with one velocity filter, s: over all springs."""
    springs = linear.stiffnesses
    described = Equivalent(np.geomspace(1.0, 2.0, springs.size), springs, 0.0 * springs)
    axis = Axis.of(described, linear.inertia, linear.viscous, replace(linear.loop, velocity_filter=velocity_filter))
    per = axis.unit_kd / axis.unit_kp
    return stiffest(axis, np.tile(ratio * per, (springs.size, 1)), sensitivity).min(axis=0) * axis.unit_kp


def table_family(table: GainTable, gains, linear: Linear, rule: str, ahead: float) -> Family:
    """Return the family of tables under a rule, starting at the ratios of `gains` (amplitude, kp, kd) looked up `ahead`."""
    start = np.minimum.accumulate(_looked_up(table, gains, ahead * table.nodes))
    return _ratio_family(
        f"gain table ({rule})", tuple(f"ratio at {a:.2g}" for a in table.nodes), table, gains, linear, rule, table.gains,
        start, lambda points: _joined(np.minimum.accumulate(points[..., :-1], axis=-1), points[..., -1:]),
    )  # fmt: skip


def fixed_family(table: GainTable, gains, linear: Linear, rule: str, at: float) -> Family:
    """Return fixed gains as tables of one ratio, starting at that of amplitude `at`."""
    one = replace(table, nodes=np.array([at]))
    start = _looked_up(table, gains, one.nodes)
    return _ratio_family("fixed gains", ("ratio",), one, gains, linear, rule, one.gains, start)


def switched_family(table: GainTable, gains, linear: Linear, rule: str) -> Family:
    """Return tables of two ratios and the amplitude at which they switch, starting at the middle of the range."""
    first, last = table.knots[0], table.knots[-1]
    middle = np.sqrt(first * last)
    start = np.array([*_looked_up(table, gains, np.array([np.sqrt(first * middle), np.sqrt(middle * last)])), middle])
    made = _ratio_family(
        "two-level switch", ("ratio below", "ratio above", "switch"), table, gains, linear, rule, table.switched, start,
        lambda points: _joined(np.minimum.accumulate(points[..., :2], axis=-1), points[..., 2:]),
    )  # fmt: skip
    lower, upper = made.lower.copy(), made.upper.copy()
    lower[2], upper[2] = first, last
    return replace(made, lower=lower, upper=upper)


def _joined(*parts: np.ndarray) -> np.ndarray:
    """Return the parts of points as one."""
    return np.concatenate(parts, axis=-1)


def _looked_up(table: GainTable, gains, amplitudes: np.ndarray) -> np.ndarray:
    """Return the ratios (n,) of tuned gains at amplitudes (n,), within those of the table."""
    found = np.exp(np.interp(np.log(amplitudes), np.log(gains.amplitude), np.log(gains.kp / gains.kd)))
    return np.clip(found, table.ratio[0], table.most.max())


def _ratio_family(
    name, numbers, table: GainTable, gains, linear: Linear, rule: str, of, start, settled=lambda p: p
) -> Family:
    """Return a family of tables. of(points) -> (kp, kd) (points, m). numbers, start (n,): of the family, ratios unless changed; the
    velocity filter comes to them."""

    def controller(points, lanes):
        kp, kd = of(points)
        tables = [Blend(table.knots, p, d, rule, table.reversal) for p, d in zip(kp, kd, strict=True)]
        made = scheduled_pd(tables, rule, table=np.repeat(np.arange(len(points)), lanes))
        return replace(made, velocity_filter=np.repeat(points[:, -1], lanes))

    def sensitivity(points):
        return linear.scheduled_peak(table.knots, *of(points), points[:, -1:])

    dt = linear.loop.sample_time
    low = np.maximum((gains.kp / gains.kd).min() / FREE, table.ratio[0])
    lower, upper = np.append(np.full(start.size, low), table.filters[0]), np.full(start.size + 1, table.most.max())
    upper[-1] = table.filters[-1]
    return Family(
        name, (*numbers, *FILTER), lower, upper, np.append(start, BEGUN * dt), controller, sensitivity, settled
    )

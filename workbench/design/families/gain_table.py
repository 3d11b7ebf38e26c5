"""A gain table as a family of few numbers: the ratio Kp/Kd at some amplitudes, and Kp as stiff along it as |S| allows.

Where gains are optimised on simulated steps over friction and inertia, the sensitivity stops nearly all of them: Kp then follows
from the ratio, and the ratio over amplitude is what is left to choose. It falls with amplitude, and so Kp does: no blend of two
curves can make it rise. The search begins at the ratios of the tuned gains, looked up at `ahead` times the amplitude: under
the rule "error" the amplitude is the error that is left, which is part of the step that the gains were tuned for.

The last numbers of a point are the velocity filter, and a notch behind the law: a filter that is quick leaves phase to the gains, and more
of the encoder's counts in the command; beyond its centre a wide notch leads in phase, and Kp may be 1.5 to 1.66 times as stiff at every ratio.
One notch serves all knots: the best centre lies between 0.07 of the sampling rate at ratios up to 200/s and 0.04 at 500/s (on the
main study's axis), the best depth between 0.5 and 0.6. At a depth of 1 there is none.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from workbench.control import grid, scheduled_pd
from workbench.control.notched import notched
from workbench.design.families.family import Blend, Family
from workbench.design.families.linear import Linear
from workbench.design.families.shaped import DEEPEST, FASTEST, FILTER, HIGH, LOW, NOTCH, judged_by, notches
from workbench.design.families.stiffness import Stiffness
from workbench.frequency import Notch
from workbench.frequency.notch import DAMPEST

NODES = 9  # ratios that are free, even in log amplitude, where no others are asked for
SAFE = 0.999  # of the stiffest Kp: what lies between the frequencies at which it is computed, and between knots, may cost of |S|
SLOWEST = 4.0  # samples: the slowest velocity filter; on one mass it costs phase alone
BEGUN = 0.4  # samples: where the search for the filter begins
LEADS, SHALLOW = 0.075, 0.8  # of the sampling rate, and at its centre: the notch at which it begins
# Of what ratios are moved by: where a search begins with filter and notch, which act on every move. Six searches of the main study end within 4 %
# of the best; with 0.1 one ends 18 % above it, with 1 half of the members begin without a notch.
ABOUT = 0.3
FREE = 3.0  # a ratio is sought within this factor of the tuned gains' range
BEYOND = 1.5  # times the largest ratio without a notch: with one Kp is largest at up to 1.4 times
HELD = 1000  # points whose gains are kept at most: more than a search has at once
OWN = 3  # numbers of a point that are no ratios: filter, centre, depth


@dataclass(frozen=True, eq=False)
class GainTable:
    """Free ratios at nodes (n,), rad or m, on knots (m,), rad or m. stiff: how stiff Kp may be. reversal: rad or m."""

    nodes: np.ndarray
    knots: np.ndarray
    stiff: Stiffness
    reversal: float

    @property
    def sample_time(self) -> float:
        return self.stiff.linear.loop.sample_time

    @property
    def begun(self) -> np.ndarray:
        """Filter and notch (3,) at which a search begins."""
        return np.array([BEGUN * self.sample_time, LEADS / self.sample_time, SHALLOW])

    @property
    def bare(self) -> np.ndarray:
        """Centre and depth (2,) of no notch."""
        return np.array([LEADS / self.sample_time, 1.0])

    @property
    def most(self) -> float:
        """The largest ratio that is sought, 1/s."""
        return BEYOND * float(self.stiff.largest(_joined(np.array([FASTEST * self.sample_time]), self.bare)[None])[0])

    def gains(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (kp, kd) (points, m), SI, of ratios, filter and notch (points, n + 3): straight in log-log between nodes, never rising."""
        where, ratios = np.log(self.knots), np.log(points[:, :-OWN])
        curves = np.stack([np.interp(where, np.log(self.nodes), row) for row in ratios])
        return self._along(curves, points[:, -OWN:])

    def acting(self, points: np.ndarray, ratios: int) -> np.ndarray:
        """Return points whose first numbers, so many ratios, never rise, and none of which is beyond what its filter and notch let act:
        a search that moved it there would see nothing."""
        most = self.stiff.largest(points[:, -OWN:])[:, None]
        falling = np.minimum.accumulate(np.minimum(points[:, :ratios], most), axis=1)
        return _joined(falling, points[:, ratios:])

    def held(self, point: np.ndarray) -> dict[str, object]:
        """Return what a schedule holds of one point (n + 3,): knots, gains, velocity filter and notch."""
        kp, kd = self.gains(point[None, :])
        filtered, centre, depth = map(float, point[-OWN:])
        notch = Notch(centre, 2.0 * DAMPEST * centre, depth) if depth < 1.0 else None
        return {"knots": self.knots, "kp": kp[0], "kd": kd[0], "velocity_filter": filtered, "notch": notch}

    def switched(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (kp, kd) (points, m) of points (p, 6): the ratio up to an amplitude, that beyond it, the amplitude, filter and notch."""
        near, far, switch = (points[:, k : k + 1] for k in range(3))
        return self._along(np.log(np.where(self.knots <= switch, near, far)), points[:, -OWN:])

    def _along(self, curves: np.ndarray, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (kp, kd) (points, m) of the logarithm of the ratio at every knot (points, m), held from rising."""
        keys = [c.tobytes() + o.tobytes() for c, o in zip(curves, own, strict=True)]
        if any(k not in self._held for k in keys):
            made = self._made(curves, own)
            if len(self._held) > HELD:
                self._held.clear()
            self._held.update(zip(keys, zip(*made, strict=True), strict=True))
            return made
        kp, kd = zip(*(self._held[k] for k in keys), strict=True)
        return np.stack(kp), np.stack(kd)

    @cached_property
    def _held(self) -> dict[bytes, tuple[np.ndarray, np.ndarray]]:
        """Gains of points: a search asks for those of one several times, for its margin and for each part of the ladder."""
        return {}

    def _made(self, curves: np.ndarray, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        most = np.log(self.stiff.largest(own))[:, None]
        ratio = np.exp(np.minimum.accumulate(np.clip(curves, np.log(self.stiff.least), most), axis=1))
        kp = SAFE * np.minimum.accumulate(self.stiff.along(ratio, own), axis=1)
        return kp, kp / ratio


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
    nodes = np.geomspace(amplitude[0], amplitude[-1], NODES) if nodes is None else nodes
    knots = grid(float(amplitude[0]), float(amplitude[-1]), per_octave)
    return GainTable(nodes, knots, Stiffness(linear, sensitivity), reversal)


def table_family(table: GainTable, gains, linear: Linear, rule: str, ahead: float) -> Family:
    """Return the family of tables under a rule, starting at the ratios of `gains` (amplitude, kp, kd) looked up `ahead`."""
    start = np.minimum.accumulate(_looked_up(table, gains, ahead * table.nodes))
    return _ratio_family(
        f"gain table ({rule})", tuple(f"ratio at {a:.2g}" for a in table.nodes), table, gains, linear, rule, table.gains,
        start, lambda points: table.acting(points, table.nodes.size),
    )  # fmt: skip


def fixed_family(table: GainTable, gains, linear: Linear, rule: str, at: float) -> Family:
    """Return fixed gains as tables of one ratio, starting at that of amplitude `at`."""
    one = replace(table, nodes=np.array([at]))
    start = _looked_up(table, gains, one.nodes)
    return _ratio_family(
        "fixed gains", ("ratio",), one, gains, linear, rule, one.gains, start, lambda points: one.acting(points, 1)
    )


def switched_family(table: GainTable, gains, linear: Linear, rule: str) -> Family:
    """Return tables of two ratios and the amplitude at which they switch, starting at the middle of the range."""
    first, last = table.knots[0], table.knots[-1]
    middle = np.sqrt(first * last)
    start = np.array([*_looked_up(table, gains, np.array([np.sqrt(first * middle), np.sqrt(middle * last)])), middle])
    made = _ratio_family(
        "two-level switch", ("ratio below", "ratio above", "switch"), table, gains, linear, rule, table.switched, start,
        lambda points: table.acting(points, 2),
    )  # fmt: skip
    lower, upper = made.lower.copy(), made.upper.copy()
    lower[2], upper[2] = first, last
    return replace(made, lower=lower, upper=upper)


def without_notch(table: GainTable, family: Family) -> Family:
    """Return a family of a table's with its notch fixed at none."""

    def whole(points):
        return _joined(points, np.tile(table.bare, (len(points), 1)))

    bounds = {n: getattr(family, n)[: -table.bare.size] for n in ("numbers", "lower", "upper", "start", "about")}
    return replace(
        family,
        **bounds,
        controller=lambda points, lanes: family.controller(whole(points), lanes),
        sensitivity=lambda points: family.sensitivity(whole(points)),
        settled=lambda points: family.settled(whole(points))[:, : -table.bare.size],
    )


def _joined(*parts: np.ndarray) -> np.ndarray:
    """Return the parts of points as one."""
    return np.concatenate(parts, axis=-1)


def _looked_up(table: GainTable, gains, amplitudes: np.ndarray) -> np.ndarray:
    """Return the ratios (n,) of tuned gains at amplitudes (n,), within those of the table."""
    found = np.exp(np.interp(np.log(amplitudes), np.log(gains.amplitude), np.log(gains.kp / gains.kd)))
    return np.clip(found, table.stiff.least, table.most)


def _ratio_family(
    name, numbers, table: GainTable, gains, linear: Linear, rule: str, of, start, settled=lambda p: p
) -> Family:
    """Return a family of tables. of(points) -> (kp, kd) (points, m). numbers, start (n,): of the family, ratios unless changed; the
    velocity filter and the notch come to them."""
    dt = table.sample_time

    def controller(points, lanes):
        kp, kd = of(points)
        tables = [Blend(table.knots, p, d, rule, table.reversal) for p, d in zip(kp, kd, strict=True)]
        made = scheduled_pd(tables, rule, table=np.repeat(np.arange(len(points)), lanes))
        made = replace(made, velocity_filter=np.repeat(points[:, -OWN], lanes))
        behind = points[:, 1 - OWN :]
        return notched(made, notches(behind, lanes=lanes), dt) if (behind[:, 1] < 1.0).any() else made

    def sensitivity(points):
        return judged_by(linear, points[:, -OWN:]).scheduled_peak(table.knots, *of(points))

    low = np.maximum((gains.kp / gains.kd).min() / FREE, table.stiff.least)
    lower = _joined(np.full(start.size, low), np.array([FASTEST * dt, LOW / dt, DEEPEST]))
    upper = _joined(np.full(start.size, table.most), np.array([SLOWEST * dt, HIGH / dt, 1.0]))
    about = _joined(np.ones(start.size), np.full(OWN, ABOUT))
    return Family(
        name,
        (*numbers, *FILTER, *NOTCH),
        lower,
        upper,
        _joined(start, table.begun),
        controller,
        sensitivity,
        settled,
        about=about,
    )

"""Where a candidate's shape parameters start: from the data, by the word in each parameter's `scale`.

A residual is binned over position and transformed, so that orders are read off its spectrum over angle; speeds, strokes
and times come from what the records cover.
"""

from collections.abc import Sequence
from itertools import product

import numpy as np

from workbench.definition import TIME, Effect
from workbench.encoders.deflection import deflection_of
from workbench.frequency.spectra import densities
from workbench.identification.problem import to_search
from workbench.inverse.bodies import POSITION
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import SENSORS, Plant
from workbench.residual.orders import order_spectrum, peaks
from workbench.tracing.budget import BUDGET, Budget

SHORTEST = 4.0  # counts, of the shortest stroke that is tried
APART = 8.0  # factor between two strokes, at least
SEGMENT, NEAR, WIDE = 1.0, 0.1, 6  # s; relative distance of two peaks; values over the whole band beside them
SLOW = 0.05  # share of the distance travelled at a speed at which a wave must pass the evaluation filter


def resolved(inverses: Sequence[InverseDynamics]) -> float:
    """Return the highest order, in 1/x, that the records can show: min(pi/count, 2 pi f_c/v).

    A wave shorter than two encoder counts is a slow one in disguise (Nyquist). One that passes faster than the evaluation
    filter f_c is seen where the axis stands, and nowhere else: v is the speed below which SLOW of the distance is travelled.
    """
    counts = max(p.motion.counts for p in inverses)
    least = np.inf
    for p in inverses:
        speed = np.sort(np.abs(p.motion.v))
        distance = np.cumsum(speed)
        slow = float(speed[np.searchsorted(distance, SLOW * distance[-1])])
        least = min(least, slow / (2 * np.pi * p.motion.filter.bandwidth))
    return min(1.0 / max(least, 1e-300), np.pi / max(counts, 1e-300))


def strokes(inverses: Sequence[InverseDynamics], plant: Plant, at: str, many: int = BUDGET.strokes) -> list[float]:
    """Return start values for a stroke, `many` at most: from SHORTEST to a fifth of the travel or, at a joint, to half of its deflection."""
    if at == "joint":
        most = 0.5 * max(float(np.ptp(p.bodies.body(plant, "joint")[1][POSITION])) for p in inverses)
    else:
        most = 0.2 * max(float(np.ptp(p.motion.q)) for p in inverses)
    least = min(max(SHORTEST * max(p.motion.counts for p in inverses), 5e-5 * most), 0.5 * most)
    many = min(many, 2 + int(np.log(most / least) / np.log(APART))) if most > least > 0.0 else 1
    return list(np.geomspace(least, most, many)) if many > 1 else [most]


def _grid(
    scale: str,
    inverses: Sequence[InverseDynamics],
    residuals: Sequence[np.ndarray],
    plant: Plant,
    effect: Effect,
    budget: Budget,
) -> list[float]:
    """Return start values for one shape parameter of an effect, in SI."""
    motions = [p.motion for p in inverses]
    if scale == "speed":
        top = max(float(np.abs(m.v).max()) for m in motions)
        return list(top * np.array([0.003, 0.01, 0.03, 0.07, 0.15, 0.3]))
    if scale == "stroke":
        # of what deflects without the effect: a gap of its default width may hold all that a stiff joint does
        beside = plant.without(effect.key) if effect.key in {e.key for e in plant.effects} else plant
        return strokes(inverses, beside, effect.at, budget.strokes)
    if scale == "place":  # within the stroke that all the records cover
        low, high = min(float(m.q.min()) for m in motions), max(float(m.q.max()) for m in motions)
        return list(np.linspace(low, high, budget.strokes + 2)[1:-1])
    if scale == "load":
        # either way, from a fourteenth of the drive's rms on: a smaller constant changes little of a load's size
        rms = float(np.sqrt(np.mean(np.concatenate([m.u for m in motions]) ** 2)))
        return list(rms * np.array([-0.6, -0.2, -0.07, 0.07, 0.2, 0.6]))
    if scale == "time":
        return list(min(m.dt for m in motions) * np.array([0.1, 0.5, 1.5, 4.0]))
    if scale == "rate":
        longest = max(float(np.ptp(m.t)) for m in motions)
        return list(np.geomspace(3.0 / longest, 0.1 / min(m.dt for m in motions), 6))
    if scale == "resonance":
        return resonances(inverses, residuals, budget.resonances)
    if scale == "settling":  # from hardly within all the records to within a third of one
        span = max(float(m.t[-1]) for m in motions) - min(float(m.t[0]) for m in motions)
        return list(np.array([0.3, 1.0, 3.0, 10.0]) / span)
    if scale == "exponent":
        # either side of what is straight: from the wrong one a law that pushes one way alone takes nothing
        return [0.5, 1.5, 2.5]
    if scale == "order":
        travel = max(float(np.ptp(m.q)) for m in motions)
        most = resolved(inverses)
        if "dir" in effect.reads:  # to and fro cancel in the spectrum of what changes sign with the way
            residuals = [np.sign(p.motion.v) * r for p, r in zip(inverses, residuals, strict=True)]
        found = peaks(*order_spectrum(inverses, residuals), travel, most)
        halves = [f / 2 for f in found]  # a peak may be the second harmonic
        if plant.rotary:  # orders that a motor behind a gear makes; the spectrum decides among them
            ratio, pairs = plant.geometry.gear_ratio, plant.geometry.pole_pairs
            known = {1.0, 2.0, ratio, 2 * ratio, pairs * ratio, 2 * pairs * ratio, 6 * pairs * ratio}
            found += sorted(k for k in known if 2 * np.pi < k * travel and k <= most)
        return found + halves
    return []


def resonances(
    inverses: Sequence[InverseDynamics], residuals: Sequence[np.ndarray], many: int = BUDGET.resonances
) -> list[float]:
    """Return frequencies in Hz, the most telling first, at which residuals go with the acceleration: local maxima of

    |S_ra|^2/S_aa, the power of a residual that a linear answer to acceleration explains at a frequency (Welch's segments of half
    overlap), below the evaluation bandwidth. A swinging part shows there, within a segment's resolution; beside them WIDE even ones.
    """
    motions = [p.motion for p in inverses]
    band = min(m.filter.bandwidth for m in motions)
    found = []
    for m, r in zip(motions, residuals, strict=True):
        size = min(max(int(SEGMENT / m.dt), 16), m.a.size)
        rate = 1.0 / m.dt
        f, own, _, cross = densities(m.a, r, rate, size)
        power = np.abs(cross) ** 2 / np.maximum(own, 1e-12 * own.max(initial=1e-300)) * r.size
        inside = np.flatnonzero(
            (power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:]) & (f[1:-1] > 2.0 / (size * m.dt)) & (f[1:-1] < band)
        )
        found += [(float(power[i + 1]), float(f[i + 1])) for i in inside]
    tops = [f for _, f in sorted(found, reverse=True)]
    chosen = [f for i, f in enumerate(tops) if all(abs(f / g - 1.0) > NEAR for g in tops[:i])][:many]
    longest = max(float(np.ptp(m.t)) for m in motions)
    return [*chosen, *np.geomspace(3.0 / longest, 0.1 / min(m.dt for m in motions), WIDE)]


def lateness(inverses: Sequence[InverseDynamics], plant: Plant, channel: str) -> dict[str, float]:
    """Return how late a channel of two encoders is, by the angle between them: {"time": d, "drift": s}, s and s a second.

    Empty with one encoder, and where the drive feels no inertia.
    """
    found = deflection_of(inverses, plant)
    if found is None:
        return {}
    sign = 1.0 if channel == "load_position" else -1.0
    return {"time": sign * found.start, "drift": sign * found.gains}


def starts(
    effect: Effect,
    inverses: Sequence[InverseDynamics],
    residuals: Sequence[np.ndarray],
    plant: Plant,
    budget: Budget = BUDGET,
) -> list[dict[str, float]]:
    """Return starts of a candidate: {shape parameter: search value}, every combination of its grids, and of a channel's clock
    what two encoders say of it."""
    free = [n for n in effect.shape if not effect.parameters[n].fixed]
    grids = []
    for n in free:
        p = effect.parameters[n]
        values = [
            float(np.clip(v, p.lower, p.upper)) for v in _grid(p.scale, inverses, residuals, plant, effect, budget)
        ] or [p.value]
        if p.scale == "time" and p.value == 0.0:
            values.insert(0, 0.0)  # what changes nothing: from there the slope points to either side
        grids.append([to_search(p.at(v)) for v in dict.fromkeys(values)])
    found = [dict(zip(free, combination, strict=True)) for combination in product(*grids)][: budget.starts]
    channel = effect.at.partition(".")[2]
    if effect.port == TIME and channel in SENSORS:
        late = lateness(inverses, plant, channel)
        own = {n: p for n in free if (p := effect.parameters[n]).scale in late}
        told = {n: to_search(p.at(float(np.clip(late[p.scale], p.lower, p.upper)))) for n, p in own.items()}
        found += [told] if told else []
    return found

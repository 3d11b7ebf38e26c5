"""The law of a family as a curve over its coordinate, with its band: every effect of the family at one place, added up."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from workbench.definition import ANGLE, COMMAND, Effect
from workbench.effects.families import FREE_FORMS, family_of
from workbench.errors import WorkbenchError, nearest
from workbench.identification.problem import Name
from workbench.identification.result import Fit
from workbench.kernel.step import build
from workbench.parameter import ROOM
from workbench.units import effect_unit

POINTS = 201  # of a curve that is drawn
STEP = 1e-5  # relative, of a derivative by a shape parameter
UNITS = {"v": "x/s", "q": "x", "t": "s", "tau": "F", "u": "F", "motor_q": "x", "dq": "x"}


@dataclass(frozen=True, eq=False)
class Curve:
    """value (n,) over x (n,), SI, and its 95 % band low to high, each point by itself. coordinate: the signal that x is.

    Of friction x is signed (the way), over position, time and load the value is that of motion forward. Of a map the value is
    what it adds to its input. effects: keys of what was added up.
    """

    family: str
    at: str
    coordinate: str
    x: np.ndarray
    value: np.ndarray
    low: np.ndarray
    high: np.ndarray
    unit: str
    x_unit: str
    effects: tuple[str, ...]


def _signals_on(coordinate: str, x: np.ndarray) -> dict[str, np.ndarray | float]:
    """Return what effects read where one coordinate goes over x and all else rests, moving forward.

    Over "dq" x is the distance from rest, each point reached from the one before: the virgin curve.
    """
    rest = dict.fromkeys(("q", "v", "a", "t", "u", "tau", "dq", "motor_q", "load_q", "locked"), 0.0)
    rest |= {"dir": 1.0, "dt": 1e-3, "ratio": 1.0, "pole_pairs": 1.0, "temperature": ROOM, coordinate: x}
    if coordinate == "v":
        rest["dir"] = np.sign(x)
    if coordinate == "dq":
        rest["dq"] = np.diff(x, prepend=0.0)
    return rest


def _law(effect: Effect, coordinate: str, x: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return an effect's output (n,) over a coordinate and its derivative by each inside parameter that is not held."""
    signals = {n: np.broadcast_to(np.asarray(s, dtype=float), x.shape) for n, s in _signals_on(coordinate, x).items()}
    inputs = {n: signals[n] for n in effect.reads} or {"t": signals["t"]}
    values = {n: p.value for n, p in effect.parameters.items()}
    step = build(effect)

    def output(given: Mapping[str, float]) -> np.ndarray:
        columns = step.run(inputs, given)
        weights = [given[n] for n in effect.linear] or [1.0]
        return sum(w * c for w, c in zip(weights, columns, strict=False))

    slopes = dict(zip(effect.linear, step.run(inputs, values), strict=False))
    for n in effect.shape:
        p = effect.parameters[n]
        if not p.fixed:
            h = STEP * max(abs(p.value), 1e-6)
            h = -h if p.value + h > p.upper else h
            slopes[n] = (output(values | {n: p.value + h}) - output(values)) / h
    through = {COMMAND: "u", ANGLE: "q"}.get(effect.port)
    return output(values) - (signals[through] if through else 0.0), slopes


def curve(
    effects: tuple[Effect, ...],
    x: np.ndarray,
    covariance: tuple[list[Name], np.ndarray, float],
    family: str = "",
    rotary: bool = True,
) -> Curve:
    """Return the sum of effects of one family at one place over its coordinate, with its band.

    x (n,): SI. covariance: (names, (m, m), t) of free inside parameters and the quantile of the band, as fit.details holds it;
    a parameter that is not named there has no width. WorkbenchError for a family without a coordinate, or no effect.
    """
    family = family or (family_of(effects[0]) if effects else "")
    if family not in FREE_FORMS or family == "creep":
        known = [f for f in FREE_FORMS if f != "creep"]
        raise WorkbenchError(f"family '{family}' has no curve over one coordinate; {nearest(family, known)}")
    if not effects:
        raise WorkbenchError(f"there is no effect of the family '{family}' to draw a curve of.")
    names, cov, t = covariance
    coordinate, x = FREE_FORMS[family].signal, np.asarray(x, dtype=float)
    value, slopes = np.zeros(x.size), np.zeros((len(names), x.size))
    index = {(n.key, n.parameter): i for i, n in enumerate(names)}
    for e in effects:
        own, by = _law(e, coordinate, x)
        value = value + own
        for n, slope in by.items():
            if (e.key, n) in index:
                slopes[index[e.key, n]] += slope
    half = t * np.sqrt(np.maximum(np.einsum("in,ij,jn->n", slopes, cov, slopes), 0.0))
    unit = "x" if effects[0].port == ANGLE else "F"
    units = (effect_unit(u, rotary, {}) for u in (unit, UNITS[coordinate]))
    keys = tuple(e.key for e in effects)
    return Curve(family, effects[0].at, coordinate, x, value, value - half, value + half, *units, keys)


def _reach(fit: Fit, family: str) -> np.ndarray:
    """Return POINTS values of a family's coordinate over what the identification records of a fit cover, (n,)."""
    seen = [s for s in fit.series.values() if s.role == "identification"] or list(fit.series.values())
    what = {"v": "velocity", "t": "time", "tau": "measured", "u": "measured", "dq": "position"}
    arrays = [getattr(s, what.get(FREE_FORMS[family].signal, "position"))[s.keep] for s in seen]
    low, high = min(float(a.min()) for a in arrays), max(float(a.max()) for a in arrays)
    if FREE_FORMS[family].signal == "dq":
        return np.geomspace(1e-5, 0.5, POINTS) * (high - low)
    if FREE_FORMS[family].signal in ("tau", "u"):
        return np.linspace(0.0, max(abs(low), abs(high)), POINTS)
    return np.linspace(low, high, POINTS)


def curve_of(fit: Fit, family: str, at: str, x: np.ndarray | None = None) -> Curve:
    """Return the curve of a family at a place of a fitted plant: what is declared and what was added, together.

    x: coordinates (n,), SI; over what the records cover where absent (at a joint give the deflections).
    """
    effects = tuple(e for e in fit.plant.effects if e.at == at and family_of(e) == family)
    x = _reach(fit, family) if x is None and family in FREE_FORMS else x
    return curve(effects, x if x is not None else np.zeros(1), fit.details["covariance"], family, fit.plant.rotary)

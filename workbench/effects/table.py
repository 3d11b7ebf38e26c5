"""What tables of linear parameters are made of: hat functions, their knots, and what is held where a declared effect is free.

Between knots a table is a straight line, sum_i c_i hat_i(x) with the hats of de Boor (A Practical Guide to Splines, 1978);
beyond the first and the last knot it is held or, where springs and loads are meant, goes on along the chord of the whole.
"""

from collections.abc import Sequence
from dataclasses import replace

from workbench.definition import Effect
from workbench.effects.elementary import clip, cos, maximum, minimum, sin
from workbench.errors import WorkbenchError
from workbench.parameter import Parameter

SOURCE = "linear interpolation between knots, de Boor 1978"
LEAST = 3  # knots: of fewer, nothing is left between two held ends


def hats(x, knots: Sequence) -> list:
    """Return hat_i(x), one a knot: 1 at its own, 0 at the others, straight between, held beyond the ends. knots: increasing."""
    x = clip(x, knots[0], knots[-1])
    up = [(x - a) / (b - a) for a, b in zip(knots[:-1], knots[1:], strict=True)]
    inner = [maximum(minimum(rise, 1.0 - fall), 0.0) for rise, fall in zip(up[:-1], up[1:], strict=True)]
    return [maximum(1.0 - up[0], 0.0), *inner, maximum(up[-1], 0.0)]


def names(word: str, count: int) -> tuple[str, ...]:
    """word1, word2, ..."""
    return tuple(f"{word}{i}" for i in range(1, count + 1))


def at(p, word: str, count: int) -> list:
    """The parameters word1, word2, ... of a step's namespace."""
    return [getattr(p, n) for n in names(word, count)]


def table(p, x, word: str, count: int, onward: bool = False):
    """sum word_i hat_i(x) over the knots of a step's namespace. onward: beyond the ends it goes on along the chord of the whole.

    The chord, and not the last piece: through two noisy knots a line goes anywhere, and a spring that is held is none.
    """
    values, knots = at(p, word, count), at(p, "knot", count)
    terms = [c * h for c, h in zip(values, hats(x, knots), strict=True)]
    if onward:
        first, last = knots[0], knots[-1]
        terms.append((values[-1] - values[0]) * ((x - clip(x, first, last)) / (last - first)))
    return sum(terms[1:], terms[0])


def waves(p, x, count: int):
    """sum sine_i sin(order_i x) + cosine_i cos(order_i x) of a step's namespace; 0 of none."""
    total = 0.0
    for a, b, k in zip(at(p, "sine", count), at(p, "cosine", count), at(p, "order", count), strict=True):
        total = total + a * sin(k * x) + b * cos(k * x)
    return total


def wave_parameters(orders: Sequence[float]) -> dict[str, Parameter]:
    """Amplitudes, linear, in F, and held orders in 1/x; WorkbenchError for an order that is not above 0."""
    wrong = [k for k in orders if not k > 0.0]
    if wrong:
        raise WorkbenchError(f"an order is a number of waves in 2 pi of displacement, above 0; given: {wrong[0]:g}.")
    found = {}
    for word in ("sine", "cosine"):
        for i, n in enumerate(names(word, len(orders)), 1):
            found[n] = Parameter(0.0, "F", f"{word} amplitude of order {i}")
    for i, (n, k) in enumerate(zip(names("order", len(orders)), orders, strict=True), 1):
        found[n] = Parameter(k, "1/x", f"order {i}", lower=1e-9, fixed=True, scale="order")
    return found


def increasing(knots: Sequence[float], what: str, positive: bool) -> tuple[float, ...]:
    """Return knots as floats; WorkbenchError unless LEAST or more increase (from above 0, where they must be positive)."""
    found = tuple(float(k) for k in knots)
    least = 0.0 if positive else -float("inf")
    if len(found) < LEAST or not all(b > a for a, b in zip((least, *found), found, strict=False)):
        above = ", increasing from above 0" if positive else ", increasing"
        given = ", ".join(f"{k:g}" for k in found) or "none"
        raise WorkbenchError(f"a free-form law needs {LEAST} or more {what}{above}; given: {given}.")
    return found


def held_knots(knots: Sequence[float], unit: str, scale: str = "") -> dict[str, Parameter]:
    """The knots as parameters that are held."""
    numbered = enumerate(zip(names("knot", len(knots)), knots, strict=True), 1)
    return {n: Parameter(k, unit, f"knot {i}", fixed=True, scale=scale) for i, (n, k) in numbered}


def levels(word: str, count: int, meaning: str) -> dict[str, Parameter]:
    """One linear parameter a knot, in F, of either sign."""
    return {n: Parameter(0.0, "F", f"{meaning} at knot {i}") for i, n in enumerate(names(word, count), 1)}


def without(effect: Effect, zero: Sequence[str]) -> Effect:
    """Return a table with these parameters held at zero by definition: a free declared effect takes their part."""
    zero = tuple(dict.fromkeys(zero))
    if not zero:
        return effect
    return replace(effect(fixed=True, **dict.fromkeys(zero, 0.0)), knots=(*effect.knots, *zero))


def free(declared: Sequence[Effect], place: str, *what: tuple[str, str]) -> bool:
    """Whether one of (effect, parameter) is declared at a place and not held there."""
    return any(
        e.at == place and e.name == name and parameter in e.parameters and not e.parameters[parameter].fixed
        for e in declared
        for name, parameter in what
    )


def free_level(declared: Sequence[Effect], place: str) -> bool:
    """Whether a free height of friction is declared at a place: Coulomb friction, or a friction with memory."""
    giver = [e for e in declared if e.at == place and (e.name == "coulomb_friction" or "dir" in e.provides)]
    return any(not e.parameters[n].fixed for e in giver for n in e.linear)

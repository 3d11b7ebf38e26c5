"""The pool that a plan picks from: motions that show friction at rest, friction in motion, forces of position, inertia."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import ceil

import numpy as np

from workbench.definition import Effect
from workbench.planning.envelope import Envelope, Sensing
from workbench.planning.motions import REST, Reference, moves, multisine, ramps, sine

LEAST = 30.0  # counts: a smaller amplitude shows the encoder more than the axis
FASTEST = 0.3  # of the evaluation bandwidth: the highest frequency of a sine; a multisine goes to twice that
APART = 1.5  # factor between sizes of the pool: what lies between them is found by resizing


def _spaced(wanted: Sequence[float], least: float, most: float) -> list[float]:
    """Return the values within the bounds, in order, none closer than APART to the one before."""
    kept: list[float] = []
    for x in sorted(wanted):
        if least <= x <= most and (not kept or x > APART * kept[-1]):
            kept.append(float(x))
    return kept


def _scales(effects: Sequence[Effect], scale: str) -> list[float]:
    """Return the values of all parameters with this scale."""
    return [p.value for x in effects for p in x.parameters.values() if p.scale == scale and p.value > 0.0]


def pool(effects: Sequence[Effect], e: Envelope, s: Sensing, seconds: float, unit: str) -> Iterator[Reference]:
    """Yield motions of one length within the envelope. Sizes follow the strokes and speeds that the effects have."""

    def made(make, size: float, **rest) -> Reference:
        reference = make(e, size, seconds, s.dt, unit, **rest)
        return replace(reference, sized=lambda factor: made(make, factor * size, **rest))

    least = 2.0 / (seconds - 2 * REST)
    top = max(FASTEST * s.bandwidth, least)
    smallest, largest = max(LEAST * s.counts, 1e-5 * e.span), 0.49 * e.span
    strokes = [f * x for x in _scales(effects, "stroke") for f in (0.5, 2.0, 8.0)]
    tried = []
    for a in _spaced([*np.geomspace(smallest, largest, 4), *strokes], smallest, 1.001 * largest):
        fastest = min(0.9 * e.speed / a, (0.9 * e.acceleration / a) ** 0.5, 2 * np.pi * top) / (2 * np.pi)
        count = 1 + min(2, ceil(fastest / least))
        frequencies = dict.fromkeys(float(x) for x in np.geomspace(least, max(fastest, least), count))
        tried += [made(sine, a, frequency=f) for f in frequencies]
        if a < 0.1 * e.span and 3.0 * least <= fastest:
            places = (e.low + 1.2 * a, e.centre, e.high - 1.2 * a)
            tried.append(made(sine, a, frequency=min(2.0, fastest), places=places))
    speeds = [
        *(e.speed * np.array([0.003, 0.03, 0.2, 0.9])),
        *(f * v for v in _scales(effects, "speed") for f in (0.4, 1.2, 3.0)),
    ]
    tried += [made(ramps, v, stroke=0.95 * e.span) for v in _spaced(speeds, 0.0, 0.95 * e.speed)]
    tried += [made(multisine, level, top=2 * top) for level in (0.1, 0.5, 0.9)]
    tried.append(made(multisine, 0.6, top=2 * top, sweep=0.3 * min(e.span, e.speed * seconds / 7)))
    tried += [made(moves, part * e.span) for part in (0.05, 0.3, 0.95)]
    yield from (reference for reference in tried if reference.within(e))

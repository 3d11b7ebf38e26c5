"""Whether two records of a fit disagree on a parameter, by what each says of it alone."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import pi

import numpy as np

from workbench.definition import Effect
from workbench.identification.by_record import Own, depends, outside_of
from workbench.identification.problem import Name, Problem
from workbench.plant import Plant

ERROR = 0.05  # chance, over all pairs of records and parameters of a fit, that one of them is said to disagree
MATTERS = 0.05  # of the value: records that differ by less are not worth a sentence, however sure it is


@dataclass(frozen=True, eq=False)
class Disagreement:
    """One declared parameter, by two records alone: the lower value with its record, and the higher one.

    times_allowed: how far they lie apart, over what their intervals allow.
    """

    effect: Effect
    parameter: str
    meaning: str
    low: float
    lower: str
    high: float
    higher: str
    times_allowed: float


def disagreements(problem: Problem, plant: Plant, names: Sequence[Name], owns: Sequence[Own]) -> list[Disagreement]:
    """Return of which parameters two records' own estimates differ by more than their intervals allow.

    Of each linear parameter the pair with the largest |b_i - b_k| / sqrt(s_i^2 + s_k^2) is compared with Student's quantile
    at the smaller of the two degrees of freedom, at ERROR over the number of pairs and parameters (Bonferroni). What is
    returned is of the parameter that is declared. plant: as fitted.
    """
    from scipy.special import stdtrit

    pairs = [
        (j, a, b)
        for j in range(len(names))
        for a, b in combinations(owns, 2)
        if min(a.freedom, b.freedom) > 0 and a.deviation[j] + b.deviation[j] > 0.0
    ]
    worst: dict[int, tuple[float, Own, Own]] = {}
    for j, a, b in pairs:
        apart = abs(a.value[j] - b.value[j]) / np.hypot(a.deviation[j], b.deviation[j])
        allowed = stdtrit(min(a.freedom, b.freedom), 1.0 - ERROR / (2 * len(pairs)))
        if apart > max(allowed, worst.get(j, (0.0,))[0] * allowed):
            worst[j] = (apart / allowed, a, b)
    found: dict[str, Disagreement] = {}
    for j, (ratio, a, b) in sorted(worst.items(), key=lambda one: -one[1][0]):
        if abs(b.value[j] - a.value[j]) > MATTERS * max(abs(a.value[j]), abs(b.value[j])):
            one = _disagreement(plant, names, j, ratio, a, b)
            found.setdefault(f"{one.effect.key}.{one.parameter}", one)
    return list(found.values())


def _disagreement(plant: Plant, names: Sequence[Name], j: int, ratio: float, a: Own, b: Own) -> Disagreement:
    """Return how two records disagree on linear parameter j, by the declared parameter in which it shows most."""
    e = plant[names[j].key]
    one, other = outside_of(plant, names, a), outside_of(plant, names, b)
    shown = {
        n: p
        for n, p in e.outside.items()
        if names[j].parameter in depends(e, n) and (e.key, n) in one.keys() & other.keys()
    }
    if not shown:  # declared by a pair of which a record determines only this part
        shown, key = {names[j].parameter: e.parameters[names[j].parameter]}, (e.key, names[j].parameter)
        one, other = {key: float(a.value[j])}, {key: float(b.value[j])}

    def difference(name: str) -> float:
        x, y = one[e.key, name], other[e.key, name]
        return abs(x - y) / (pi if shown[name].unit == "rad" else max(abs(x), abs(y), 1e-300))

    name = max(shown, key=difference)
    p = shown[name]
    (low, lower), (high, higher) = sorted([(one[e.key, name], a.record), (other[e.key, name], b.record)])
    return Disagreement(e, name, p.meaning, low, lower, high, higher, float(ratio))

"""Findings on the records of a fit: that they disagree on a parameter, and that they do not excite one."""

from collections.abc import Mapping, Sequence
from itertools import combinations
from math import pi

import numpy as np

from workbench.definition import Effect
from workbench.finding import Finding
from workbench.identification.by_record import Own, depends, outside_of
from workbench.identification.problem import Name, Problem
from workbench.identification.solve import Solution
from workbench.plant import Plant

DISAGREE = "records disagree"
ERROR = 0.05  # chance, over all pairs of records and parameters of a fit, that one of them is said to disagree
MATTERS = 0.05  # of the value: records that differ by less are not worth a sentence, however sure it is
FAINT = 0.5  # half width over value beyond which a parameter that stays below the noise is said to lack excitation

REMEDY = {  # by the signal that the effect reads, the first that fits
    "a": "record a motion with more acceleration",
    "dir": "record a motion that reverses, several times and at several strokes",
    "dq": "record a motion that reverses, several times and at several strokes",
    "v": "record a motion at higher and at lower speeds",
    "q": "record a motion over more of the travel",
}


def disagreements(problem: Problem, plant: Plant, names: Sequence[Name], owns: Sequence[Own]) -> list[Finding]:
    """Say of which parameters two records' own estimates differ by more than their intervals allow.

    Of each linear parameter the pair with the largest |b_i - b_k| / sqrt(s_i^2 + s_k^2) is compared with Student's quantile
    at the smaller of the two degrees of freedom, at ERROR over the number of pairs and parameters (Bonferroni). What is
    said is said of the parameter that is declared. plant: as fitted.
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
    said: dict[str, Finding] = {}
    for j, (ratio, a, b) in sorted(worst.items(), key=lambda found: -found[1][0]):
        if abs(b.value[j] - a.value[j]) > MATTERS * max(abs(a.value[j]), abs(b.value[j])):
            finding = _disagreement(plant, names, j, ratio, a, b)
            said.setdefault(finding.subject, finding)
    return list(said.values())


def _disagreement(plant: Plant, names: Sequence[Name], j: int, ratio: float, a: Own, b: Own) -> Finding:
    """Say that two records disagree on linear parameter j, by the declared parameter in which it shows most."""
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
    return Finding(
        DISAGREE, f"{e.key}.{name}",
        f"{e.named}: {p.meaning} is {low:.3g} by record '{lower}' alone and {high:.3g} by '{higher}', {ratio:.1f} times what "
        "their intervals allow; one value does not serve both.",
        {"lowest": low, "highest": high, "times_allowed": float(ratio)},
        "look for an effect that the plant lacks, or for what changed between the records",
    )  # fmt: skip


def excitation(
    problem: Problem, solution: Solution, half: Mapping[Name, float], noise: float, called: str = "residual"
) -> list[Finding]:
    """Say which free parameters the records do not excite.

    A linear one: its column is zero; or the column at its value (the larger of declared and fitted) stays below the
    `noise`, the residual's rms, while its interval is wide or it has none. One of an effect with memory: no record
    reverses, or, of a linear one, all records together move one way.

    half: half widths of the 95 % intervals, of the parameters that have one. called: what `noise` is, in sentences.
    """
    turns, ways = _motion_of(problem)
    said = []
    for n in [*problem.free_linear, *problem.free_shape]:
        e, p = problem.plant[n.key], problem.parameter(n)
        linear = n in problem.free_linear
        why, evidence = "", {}
        if linear:
            j = problem.free_linear.index(n)
            column = float(np.sqrt(np.mean(solution.phi[:, j] ** 2)))
            fitted = float(solution.c[j])
            share = column * max(abs(fitted), abs(p.value))
            wide = half.get(n, np.inf) > FAINT * abs(fitted)
            if column == 0.0:
                why = "has no part in the drive on these records"
            elif 0.0 < share < noise and wide:
                why = f"moves the drive by {share:.2g} rms at its value, less than the {called} of {noise:.2g}"
            evidence = {"contribution": share, "noise": noise}
        if not why and _remembers(e):
            if linear and ways < 2:
                why, evidence = "shows in the direction of motion, and these records move one way only", {"ways": ways}
            elif not linear and turns == 0:
                why, evidence = "shows where the motion reverses, and no record reverses", {"reversals": turns}
        if why:
            remedy = _remedy_of(e, turns, ways, called)
            said.append(
                Finding(
                    "excitation missing", f"{n.key}.{n.parameter}", f"{e.named}: {p.meaning} {why}.", evidence, remedy
                )
            )
    return said


def _remedy_of(effect: Effect, turns: int, ways: int, called: str) -> str:
    """Say what would show an effect: no motion of a kind that the records have already."""
    signal = next((s for s in REMEDY if s in effect.reads), "")
    if signal in ("dir", "dq") and turns > 0 and ways == 2:
        return (
            "let the trace say what else is in the drive"
            if called == "residual"
            else "leave it out, or log the drive with less noise"
        )
    return REMEDY.get(signal, "record a motion that shows it")


def _remembers(effect: Effect) -> bool:
    """Whether an effect acts through reversals of the motion: it sums increments up, or reads the direction."""
    return bool({"dq", "dir"} & set(effect.reads))


def _motion_of(problem: Problem) -> tuple[int, int]:
    """Return (reversals within the records, ways moved: 0, 1 or 2), of the position behind its dead band of a count."""
    turns, ways = 0, set()
    for p in problem.passes:
        dq = p.motion.dq[p.motion.keep]
        way = np.sign(dq[dq != 0.0])
        turns += int(np.count_nonzero(np.diff(way)))
        ways |= set(way.tolist())
    return turns, len(ways)

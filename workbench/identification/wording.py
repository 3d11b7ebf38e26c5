"""What is said of a fit: what its records do not excite, what they do not determine, and on what they disagree."""

from collections.abc import Sequence

import numpy as np

from workbench.definition import Effect
from workbench.finding import KNOWN_TOGETHER, Finding
from workbench.identification import excitation
from workbench.identification.disagreement import Disagreement
from workbench.identification.excitation import Unexcited
from workbench.identification.intervals import at_bounds, known_together, wider_than_value
from workbench.identification.problem import Name, Problem
from workbench.identification.result import Estimate

DISAGREE = "records disagree"
REMEDY = {  # by the signal that the effect reads, the first that fits
    "a": "record a motion with more acceleration",
    "dir": "record a motion that reverses, several times and at several strokes",
    "dq": "record a motion that reverses, several times and at several strokes",
    "v": "record a motion at higher and at lower speeds",
    "q": "record a motion over more of the travel",
}


def unexcited(one: Unexcited, called: str = "residual") -> Finding:
    """Say that records do not excite a parameter. called: what its noise is."""
    e, evidence = one.effect, {"contribution": one.contribution, "noise": one.noise}
    if one.reason == excitation.ABSENT:
        why = "has no part in the drive on these records"
    elif one.reason == excitation.BELOW_NOISE:
        why = f"moves the drive by {one.contribution:.2g} rms at its value, less than the {called} of {one.noise:.2g}"
    elif one.reason == excitation.ONE_WAY:
        why, evidence = "shows in the direction of motion, and these records move one way only", {"ways": one.ways}
    else:
        why, evidence = "shows where the motion reverses, and no record reverses", {"reversals": one.turns}
    sentence = f"{e.named}: {e.parameters[one.parameter].meaning} {why}."
    remedy = _remedy_of(e, one.turns, one.ways, called)
    return Finding("excitation missing", f"{e.key}.{one.parameter}", sentence, evidence, remedy)


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


def disagreement(one: Disagreement) -> Finding:
    """Say that two records disagree on a parameter."""
    return Finding(
        DISAGREE, f"{one.effect.key}.{one.parameter}",
        f"{one.effect.named}: {one.meaning} is {one.low:.3g} by record '{one.lower}' alone and {one.high:.3g} by '{one.higher}', "
        f"{one.times_allowed:.1f} times what their intervals allow; one value does not serve both.",
        {"lowest": one.low, "highest": one.high, "times_allowed": one.times_allowed},
        "look for an effect that the plant lacks, or for what changed between the records",
    )  # fmt: skip


def undetermined(problem: Problem, found: Sequence[Estimate], names: Sequence[Name], cov: np.ndarray) -> list[Finding]:
    """Say what the data do not determine: parameters on a bound, wider than their value, or known only together."""
    said = [
        *(_at_bound(problem, n) for n in at_bounds(problem, names)),
        *(_not_determined(e) for e in wider_than_value(found)),
        *(_together([names[k] for k in group], r) for group, r in known_together(cov)),
    ]
    return sorted(said, key=lambda f: (f.kind, f.subject))


def _at_bound(problem: Problem, n: Name) -> Finding:
    p = problem.parameter(n)
    return Finding(
        "at bound", f"{n.key}.{n.parameter}",
        f"{problem.plant[n.key].named}: {p.meaning} came out on its bound or without any effect on these records; "
        "it is not determined.",
        {"lower": p.lower, "upper": p.upper},
        "record a motion that excites it, or declare it fixed",
    )  # fmt: skip


def _not_determined(e: Estimate) -> Finding:
    half = e.high - e.value
    return Finding(
        "not determined", f"{e.effect}@{e.at}.{e.parameter}",
        f"{e.effect}: {e.meaning} is {e.value:.3g} with a 95 % interval of +-{half:.2g} {e.unit}, "
        "wider than its value; these records do not determine it.",
        {"value": e.value, "half_width": half},
        "record a motion in which this effect is a larger part of the drive",
    )  # fmt: skip


def _together(group: Sequence[Name], correlation: float) -> Finding:
    names = [f"{n.key}.{n.parameter}" for n in group]
    return Finding(
        KNOWN_TOGETHER, ", ".join(names),
        f"{', '.join(names[:-1])} and {names[-1]} are known only together (correlation up to {correlation:.3f}): these "
        "records hardly tell them apart.",
        {"correlation": correlation},
        "record motions of other amplitudes and speeds",
    )  # fmt: skip

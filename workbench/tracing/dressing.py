"""Whether causes only dress what no effect of the catalogue is: what changes along the stroke or in bench time, and what no machine has."""

from workbench.record import IDENTIFICATION
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import CORRECTION, FORMULA, Evidence, Weighed

DRIFTS = ("friction_drift", "friction_run_in")  # laws of bench time alone


def of_a_change(evidence: Evidence, causes: list[Weighed], criteria: Criteria) -> bool:
    """Whether causes, at least one, only dress what changes along the stroke or in bench time: that is there, whatever the reference foretells."""
    return _less_than_places(evidence, causes, criteria) or _of_what_changes(evidence, causes, criteria)


def _less_than_places(evidence: Evidence, causes: list[Weighed], criteria: Criteria) -> bool:
    """Whether causes together take plainly less than a stiffness of the joint, or an inertia, that changes along the stroke does, out of
    sample: theirs are laws of the deflection and of the motion, the same at every place. An eccentric encoder is such an inertia by
    another name, so that what takes as much stays the cause; beside what takes most, values that no machine has say nothing against it. Where
    what takes most has such values itself, `near` of it is as much: an arm whose inertia changes is an encoder that is eccentric by ten degrees."""
    more = max(evidence.before.joint, evidence.before.inertia) ** 2 - criteria.explainable**2
    first = largest(causes, criteria)
    counted = (a.size(IDENTIFICATION) for a in causes if not a.implausible or a is first)
    taken = sum(max(size, 0.0) ** 2 for size in counted)
    return more > taken * (criteria.near if first is not None and first.implausible else 1.0)


def changes(evidence: Evidence, criteria: Criteria) -> bool:
    """Whether an inertia that changes along the stroke, or a drive's gain that does in bench time, takes `held` of what the declared model leaves of
    the identification records: of the drive it is at least `explainable`. An inertia takes 0.84 and 0.92 of two cranks, 0.24 at most of some 340 other
    traces; a gain 0.78 of a level that wanders, 0.40 at most of 78 axes that lack an effect, which takes it, and nothing of 17 complete models.
    Halved, the same; doubled, a bell crank is "nothing is missing"."""
    most = max(evidence.before.inertia, evidence.before.gain)
    return most >= criteria.explainable and most**2 >= criteria.held * evidence.declared[IDENTIFICATION] ** 2


def largest(causes: list[Weighed], criteria: Criteria) -> Weighed | None:
    """Return the cause that takes most, or None."""
    return max(causes, key=lambda a: a.order(criteria.practical), default=None)


def doubtful(evidence: Evidence, causes: list[Weighed], criteria: Criteria) -> bool:
    """Whether what takes most leaves `beside` of the drive to be explained, and has values that no machine has or is a curve of no formula: any law
    of a class is in its curve, so that what stays is of none (two joints of a rail left 5.7 % of the drive beside a curve over place; of five other
    traces with a curve among their causes none left anything)."""
    first = largest(causes, criteria)
    free = first is not None and (bool(first.implausible) or first.law != FORMULA)
    return (free and evidence.after.size >= criteria.beside) or _of_rest(evidence, first, criteria)


def _of_rest(evidence: Evidence, first: Weighed | None, criteria: Criteria) -> bool:
    """Whether what takes most is a friction that drifts, and leaves `explainable` that bench time foretells: a drift is any smooth change there. What
    builds up while an axis rests and is worn down as it runs (a thixotropic seal or grease) left 0.034, 0.020 and 0.010, of 0.055, 0.058 and 0.041 that
    were foretold; of seventeen drifts that lead none left more than 0.0032. Halved, the third is unknown, too; doubled, none of these changes."""
    return first is not None and _drifts(first) and evidence.after.time >= criteria.explainable


def _drifts(a: Weighed) -> bool:
    return a.effect.partition(" ")[0] in DRIFTS


def _of_what_changes(evidence: Evidence, causes: list[Weighed], criteria: Criteria) -> bool:
    """Whether an inertia, or a drive's constant, that changes along the stroke takes `held` of what causes leave, at least `beside` of the drive (of a coil
    on springs that leaves its gap two springs and a saturation left 4.9 %, of which it takes 4.6; beside the causes of 71 other axes of one mass 0.2 at most);
    or a drive's gain that changes in bench time (`_of_gain`)."""
    left = causes[-1].after[IDENTIFICATION]
    along = evidence.after.inertia
    return (along >= criteria.beside and along**2 >= criteria.held * left**2) or _of_gain(
        evidence, causes, left, criteria
    )


def _of_gain(evidence: Evidence, causes: list[Weighed], left: float, criteria: Criteria) -> bool:
    """Whether causes are the mean of a drive's gain that changes in bench time, and the rest of it stays: more than `left` of what they leave, and
    `beside` of the drive, beside data-sheet values and drifts alone, or beside any that take half of it. The mean of such a gain is a mass that
    was declared too small (of a coil that warms up 4.5 % of the drive stayed, of an amplifier that folds its current back 4.5 % beside two
    inertias and a drift, of magnets that warm up 3.7 beside two inertias), or a mass that swings (6.0 % fell to 3.2). Of some 480 right causes
    none left more than 1.0 %: a peak of friction is such a gain, too, and takes all of it.
    """
    was, stays = evidence.before.gain, evidence.after.gain
    mean = all(a.kind == CORRECTION or _drifts(a) for a in causes) or stays**2 < (1.0 - criteria.held) * was**2
    return mean and stays >= criteria.beside and stays**2 >= criteria.left * left**2

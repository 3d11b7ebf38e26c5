"""Whether something changes along the stroke or in bench time that no effect of the catalogue is, and causes only dress it."""

from workbench.record import IDENTIFICATION
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import Evidence, Weighed


def less_than_places(evidence: Evidence, causes: list[Weighed], criteria: Criteria) -> bool:
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

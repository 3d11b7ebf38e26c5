"""The verdict of a trace as one sentence that a person reads first: what is missing, and what becomes of the errors with it."""

from collections.abc import Sequence
from math import isfinite

from workbench.definition import DRIVE_CHANNELS, catalogue
from workbench.finding import capital, in_per_cent, place, title
from workbench.identification.result import Fit
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.residual.window import DIRECTIONS, Window, local
from workbench.tracing.candidates import periodic
from workbench.tracing.decide import CAUSE, UNKNOWN
from workbench.tracing.evidence import ADDITION, CORRECTION, Evidence, Explainable
from workbench.tracing.mending import Mended
from workbench.tracing.result import Cause
from workbench.tracing.unexplained import Unexplained

SPANS = 6  # that are told in words
UNSEEN = 1e-4  # of the drive, a floor below which the records show no noise that could be told
# what each kind of what is explainable could be predicted from
FROM = {
    "exogenous": "what is outside the loop: the reference's place, speed and direction",
    "time": "bench time: a friction, a damping or a mass that changes, or a force that comes and goes",
    "line": "a line of the spectrum",
    "burst": "moments far outside what is usual",
    "joint": "the joint's deflection: its stiffness is another one elsewhere on the stroke",
}


def _lives(place: Window, displacement: str) -> str:
    """Return "at positions from 0.1 to 0.2 rad, moving forward": where something lives, in SI units. displacement: rad or m."""
    name, unit = {
        "position": ("at positions", displacement),
        "velocity": ("at speeds", displacement and f"{displacement}/s"),
        "time": ("at the times", "s"),
    }[place.coordinate]
    spans = ", ".join(f"{low:.4g} to {high:.4g}" for low, high in place.spans[:SPANS])
    more = f" and {len(place.spans) - SPANS} more" if len(place.spans) > SPANS else ""
    way = f", moving {DIRECTIONS[place.direction]}" if place.direction else ""
    return f"{name} from {spans}{unit and f' {unit}'}{more}{way}"


def _what_of(causes: Sequence[Cause], plant: Plant) -> str:
    """Return "a and b are missing, and c is declared with a wrong value". plant: with all causes in it."""
    parts = []
    for kind, one, many in (
        (ADDITION, "is missing", "are missing"),
        (CORRECTION, "is declared with a wrong value", "are declared with wrong values"),
    ):
        of_kind = [c for c in causes if c.kind == kind]
        names = [*_named(of_kind, plant), *(title(n) for c in of_kind for n in c.also)]
        if names:
            parts.append(f"{_enumerated(names)} {one if len(names) == 1 else many}")
    return ", and ".join(parts)


def _enumerated(names: Sequence[str]) -> str:
    """Return "a, b and c"; a name that is there several times once, with its number."""
    counted = [f"{n} ({names.count(n)} of it)" if names.count(n) > 1 else n for n in dict.fromkeys(names)]
    return " and ".join(p for p in (", ".join(counted[:-1]), *counted[-1:]) if p)


def _named(causes: Sequence[Cause], plant: Plant) -> list[str]:
    """Return the names of causes; of one that is there several times at its place, once for all of them: a wave of several orders, or a
    force whose curve is more than one formula."""
    discs = {c.effect: c.at for c in causes if c.at != "joint" and catalogue()[c.effect.partition(" ")[0]].harmonic}
    orders = [(c.effect.partition(" ")[0], discs.get(c.effect, c.at)) for c in causes]
    several = {of for of in orders if orders.count(of) > 1}
    names = [
        title(of[0]) + (f" of {orders.count(of)} orders" if periodic(catalogue()[of[0]]) else "")
        if of in several
        else _name_of(c, plant)
        for c, of in zip(causes, orders, strict=True)
    ]
    return list(dict.fromkeys(names)) if several else names


def _name_of(c: Cause, plant: Plant) -> str:
    """Return the name of a cause, with its place where the plant has another effect of this name, or where it is what the drive reports."""
    if c.at in DRIVE_CHANNELS:
        return f"{c.title} of the drive's report"
    alike = [e for e in plant.effects if e.named == c.effect]
    return f"{c.title} at the {place(c.at)}" if len(alike) > 1 else c.title


def _at_least(floor: float) -> str:
    """Return what noise leaves, in brackets; "" where the records show none."""
    return f" (noise alone would leave {100 * floor:.2g} % or more)" if floor > UNSEEN else ""


def _humming(size: Explainable) -> str:
    """Return what of the drive is hum of the mains, "" where none is."""
    return f"{100 * size.hum:.2g} % is hum of the mains, and " if size.hum > 0.0 else ""


def _caused(causes: Sequence[Cause], before: Fit, after: Fit, evidence: Evidence, refined: Fit | None) -> str:
    """Return what is missing, and what becomes of the errors with it; what refinements take away besides is not its own."""
    what = _what_of(causes, after.plant)
    one = what.count(" is ") == 1 and " are " not in what
    them = "it" if one else "them"
    if refined is not None and not evidence.clock and after.validation >= before.validation > refined.validation:
        # what they take shows beside the refinements alone: a load's friction that gives way at rest bends what is fitted
        them, after, refined = f"{them} and the refinements", refined, None
    alone = not isfinite(before.validation)  # no record was kept from the fit
    errors = (before.identification, after.identification) if alone else (before.validation, after.validation)
    falls = "falls" if errors[1] < 0.99 * errors[0] else "goes"
    where = (
        ", which shows in the angle between the two encoders"
        if [c.effect for c in causes] == ["clock_skew"] and evidence.clock
        else ""
    )
    said = f"{capital(what)}{where}. With {them}, the {IDENTIFICATION if alone else VALIDATION} error {falls} from {_pair(*errors)}"
    if not alone:
        said = f"{said} and the identification error from {_pair(before.identification, after.identification)}"
    said = f"{said}{_at_least(evidence.floor[IDENTIFICATION])}{'; no validation record bears it out' if alone else ''}."
    if refined is None:
        return said
    they = f"it is {100 * refined.identification:.2f} %"
    if not alone:
        they = f"they are {100 * refined.validation:.2f} % and {100 * refined.identification:.2f} %"
    return f"{said} With the refinements, too, {they}."


def _pair(before: float, after: float) -> str:
    """Return "4.31 % to 0.66 %"."""
    return f"{100 * before:.2f} % to {100 * after:.2f} %"


def _foretold(size: Explainable) -> str:
    """Return how much of the drive could be predicted from outside the loop, where that is little."""
    return "nothing" if size.size == 0.0 else f"no more than {100 * size.size:.2f} %"


def _unexplained(evidence: Evidence, place: Window | None, displacement: str) -> str:
    """Return how much of the drive no effect explains, from what it could be predicted, and where it lives."""
    size = evidence.before
    said = (
        f"Something is missing that no effect of the catalogue explains: {100 * size.size:.1f} % of the drive's rms could be "
        f"predicted from {FROM[size.kind]}"
    )
    if size.inertia > size.size:
        return (
            f"Something is missing that no effect of the catalogue explains: an inertia that changes along the stroke (a crank, a "
            f"toggle), or a drive's constant that does, would take {100 * size.inertia:.1f} % of the drive's rms."
        )
    if size.gain > size.size:
        return (
            f"Something is missing that no effect of the catalogue explains: a drive whose gain changes slowly in bench time (a magnet that "
            f"warms up, a supply that sags) would take {100 * size.gain:.1f} % of the drive's rms."
        )
    if evidence.astray:
        return (
            f"Something is missing that no effect of the catalogue explains: what the declared model leaves of the validation record is "
            f"{100 * evidence.declared[VALIDATION]:.0f} % of its drive, more than no model at all would leave; on identification "
            f"it leaves {100 * evidence.declared[IDENTIFICATION]:.1f} %."
        )
    tried = max((*evidence.added, *evidence.refused), key=lambda a: a.size(IDENTIFICATION), default=None)
    taken = tried.size(IDENTIFICATION) if tried is not None else 0.0
    if evidence.unaccounted > 2.0 * max(size.size, taken):
        said = (
            f"Something is missing that no effect of the catalogue explains: {100 * evidence.unaccounted:.1f} % of the drive's rms stays "
            f"beyond what noise may leave, and {_foretold(size)} of it could be predicted from outside the loop"
        )
    elif taken > size.size == 0.0:
        said = (
            f"Something is missing that no effect of the catalogue explains: {title(tried.effect)} takes away "
            f"{100 * taken:.1f} % of the drive's rms on the identification records, but validation does not bear it out"
        )
    if size.kind == "line":
        said = f"{said} of {size.frequency:.3g} Hz"
        if not local(place):
            return f"{said}."
    if size.kind == "joint":
        return f"{said}."
    if place is None:
        return f"{said}; it lives nowhere in particular: not in a place, not at a speed, not at moments."
    return (
        f"{said}. It lives {_lives(place, displacement)}: {100 * place.share:.0f} % of its power in "
        f"{in_per_cent(place.covered)} of the samples."
    )


def _with(refined: Fit | None) -> str:
    """Return what refinements leave."""
    return f"with its refinements {100 * refined.identification:.2f} %, " if refined is not None else ""


def verdict_sentence(
    verdict: str,
    causes: Sequence[Cause],
    before: Fit,
    after: Fit,
    evidence: Evidence,
    lives_in: Unexplained | None = None,
    lost: Mended | None = None,
    refined: Fit | None = None,
) -> str:
    """Return the verdict as a person reads it, with the errors before, after (the causes alone), and with the refinements as well."""
    size = evidence.before
    if verdict == CAUSE:
        return _caused(causes, before, after, evidence, refined)
    if verdict == UNKNOWN and lost is not None:
        return f"Something is missing that no effect of the catalogue explains. {lost.finding.sentence}"
    if verdict == UNKNOWN:
        return _unexplained(evidence, lives_in.place if lives_in else None, before.plant.displacement)
    return (
        f"Nothing is missing: the declared model leaves {100 * before.identification:.2f} % of the drive on identification, {_with(refined)}and "
        f"{_foretold(size)} of it could be predicted from outside the loop; {_humming(size)}the rest is noise and disturbance."
    )

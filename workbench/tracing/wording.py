"""What a trace comes to: verdict, causes and findings as sentences, and where an unexplained residual lives."""

from collections.abc import Sequence

from workbench.definition import find
from workbench.effects.families import family_of
from workbench.finding import BELOW_FLOOR, SOMETHING_ELSE, Finding, capital, title
from workbench.identification.result import Fit
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.residual.window import DIRECTIONS, Window, local
from workbench.tracing.criteria import Criteria
from workbench.tracing.decide import CAUSE, DRESSING, NOT_BORNE_OUT, UNKNOWN, Verdict
from workbench.tracing.evidence import ADDITION, CORRECTION, Evidence, Weighed
from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.mending import Mended
from workbench.tracing.result import CandidateScore, Cause, Refinement
from workbench.tracing.unexplained import Unexplained

SPANS = 6  # that are told in words
UNSEEN = 1e-4  # of the drive, a floor below which the records show no noise that could be told
# what each kind of what is explainable could be predicted from
FROM = {
    "exogenous": "what is outside the loop: the reference's place, speed and direction",
    "time": "bench time: a level, a friction, a damping or a mass that changes",
    "line": "a line of the spectrum",
    "burst": "moments far outside what is usual",
}


def cause(
    judgement: ScoredCandidate,
    weight: Weighed,
    before: Fit,
    here: Fit,
    last: Fit,
    declared: Plant,
    *,
    credited: bool = False,
) -> Cause:
    """Return the cause that a candidate became: its share from `before` to `here`, its parameters from the last fit.

    weight: what whole records say of it. declared: the plant as declared, whose fixed values a correction moved. credited: it
    was not certain alone, and the candidate is what it came to with the others in place.
    """
    candidate, name = judgement.candidate, judgement.suspect.name
    suspect = judgement.suspect
    was = _held(declared, candidate) if candidate.kind == CORRECTION else {}
    effect = find((candidate.effect if suspect.part else name).partition(" ")[0])  # without its label
    estimates = tuple(e for e in last.estimates if (e.effect, e.at) == (candidate.effect, candidate.at))
    identification, validation = (
        1.0 - (here.rms[r] / before.rms[r]) ** 2 if before.rms[r] > 0.0 else 0.0 for r in (IDENTIFICATION, VALIDATION)
    )
    verb = "is declared with a wrong value" if candidate.kind != ADDITION else "is missing"
    sentence = (
        f"{capital(title(name))} at the {candidate.at} {verb}: {effect.cause}. It explains "
        f"{100 * identification:.1f} % of the residual power on the identification records and {100 * validation:.1f} % "
        "on the validation record."
    )
    if suspect.part:
        whose = "With what is declared there it is" if effect.parts else "Its law is that of"
        sentence += f" {whose} {title(candidate.effect)}, {effect.formula}."
    if suspect.stands:
        family = family_of(last.plant[suspect.key])
        sentence += f" It is {family}, of no catalogued law: its curve is in the parameters, and the name is that of the nearest law."
    if weight.implausible:
        sentence += f" Doubt it: {weight.implausible}."
    if credited:
        sentence += (
            " Alone its gain was not certain, because another effect was missing too; with the others in place it takes away "
            f"{100 * candidate.gain:.1f} % of the held-out residual power (standard error {100 * candidate.scatter:.1f} %)."
        )
    return Cause(
        name, candidate.at, sentence, estimates, identification, validation,
        kind=candidate.kind,
        was=was, law=weight.law, size=weight.size(IDENTIFICATION),
        form=candidate.effect if name != candidate.effect else "",
    )  # fmt: skip


def refinement(c: Cause) -> Refinement:
    """Return what would be a cause, were it not too small for one: nothing says that it is missing."""
    sentence = f"{capital(title(c.effect))} at the {c.at} takes away {100 * c.size:.2g} % of the drive's rms on the identification records."
    return Refinement(c.effect, c.at, c.kind, sentence, c.parameters, c.size)


def findings_of(verdict: Verdict, evidence: Evidence, causes: Sequence[Cause], plant: Plant, criteria: Criteria):
    """Yield the findings that stand beside a verdict: alarms first."""
    if "below floor" in verdict.alarms:
        yield Finding(
            BELOW_FLOOR, "",
            "The error with what was added is less than noise and counts alone would leave: what was added explains noise, "
            "or the noise is not what it was read to be; do not rely on it before a second validation record.",
            {r: evidence.floor[r] for r in evidence.floor},
        )  # fmt: skip
    yield from not_carried(causes, criteria)
    refused = [(a, NOT_BORNE_OUT) for a in evidence.refused]
    for a, role in (*refused, *zip(evidence.added, verdict.roles, strict=True)):
        name = f"{capital(title(a.effect))} at the {a.at}"
        if role == NOT_BORNE_OUT:
            yield Finding(
                "not borne out", a.effect,
                f"{name} explains {100 * a.share(IDENTIFICATION):.0f} % of what the identification records leave, but it is not "
                f"borne out: on validation it explains {100 * max(a.share(VALIDATION), 0.0):.0f} %.",
                {"identification": a.share(IDENTIFICATION), "validation": a.share(VALIDATION)},
            )  # fmt: skip
        elif role == DRESSING:
            yield Finding(
                "dressing", a.effect,
                f"{name} was tried and explains {100 * max(a.share(VALIDATION), 0.0):.0f} % of what validation leaves: too little to be "
                "the cause of what the residual holds.",
                {"identification": a.share(IDENTIFICATION), "validation": a.share(VALIDATION)},
            )  # fmt: skip
    if verdict.something_else:
        yield Finding(
            SOMETHING_ELSE, evidence.after.kind,
            f"Beside this, something else is missing: {100 * evidence.after.size:.1f} % of the drive's rms stays predictable from "
            f"{FROM[evidence.after.kind]}.",
            {"before": evidence.before.size, "after": evidence.after.size},
            "look at where the residual lives",
        )  # fmt: skip


def _held(plant: Plant, candidate: CandidateScore) -> dict[str, float]:
    """Return outside parameter -> the value that a plant holds it at, of the effect that a candidate corrects."""
    return {n: p.value for n, p in plant[f"{candidate.effect}@{candidate.at}"].outside.items() if p.fixed}


def not_carried(causes: Sequence[Cause], criteria: Criteria):
    """Yield a finding for each cause that explains much less on validation than on identification."""
    for c in causes:
        if c.share_validation < criteria.doubted * c.share_identification:
            yield Finding(
                "not carried over", c.effect,
                f"{capital(title(c.effect))} explains {100 * c.share_identification:.0f} % on identification but only "
                f"{100 * c.share_validation:.0f} % on validation; do not rely on it before a second validation record.",
                {"identification": c.share_identification, "validation": c.share_validation},
            )  # fmt: skip


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


def what_of(causes: Sequence[Cause], plant: Plant) -> str:
    """Return "a and b are missing, and c is declared with a wrong value". plant: with all causes in it."""
    parts = []
    for kind, one, many in (
        (ADDITION, "is missing", "are missing"),
        (CORRECTION, "is declared with a wrong value", "are declared with wrong values"),
    ):
        names = _named([c for c in causes if c.kind == kind], plant)
        if names:
            parts.append(f"{_enumerated(names)} {one if len(names) == 1 else many}")
    return ", and ".join(parts)


def _enumerated(names: Sequence[str]) -> str:
    """Return "a, b and c"; a name that is there several times once, with its number."""
    counted = [f"{n} ({names.count(n)} of it)" if names.count(n) > 1 else n for n in dict.fromkeys(names)]
    return " and ".join(p for p in (", ".join(counted[:-1]), *counted[-1:]) if p)


def _named(causes: Sequence[Cause], plant: Plant) -> list[str]:
    """Return the names of causes; of a periodic one that is there with several orders, once for all of them."""
    orders = [(c.effect.partition(" ")[0], c.at) for c in causes]
    several = {of for of in orders if orders.count(of) > 1}
    names = [
        f"{title(of[0])} of {orders.count(of)} orders" if of in several else _name_of(c, plant)
        for c, of in zip(causes, orders, strict=True)
    ]
    return list(dict.fromkeys(names)) if several else names


def _name_of(c: Cause, plant: Plant) -> str:
    """Return the name of a cause, with its place where the plant has another effect of this name."""
    alike = [e for e in plant.effects if e.named == c.effect]
    return f"{title(c.effect)} at the {c.at}" if len(alike) > 1 else title(c.effect)


def _at_least(floor: float) -> str:
    """Return what noise leaves, in brackets; "" where the records show none."""
    return f" (noise alone would leave {100 * floor:.2g} % or more)" if floor > UNSEEN else ""


def verdict_sentence(
    verdict: str,
    causes: Sequence[Cause],
    before: Fit,
    after: Fit,
    evidence: Evidence,
    lives_in: Unexplained | None = None,
    lost: Mended | None = None,
) -> str:
    """Return the verdict as a person reads it, with the errors before and after."""
    size = evidence.before
    if verdict == CAUSE:
        falls = "falls" if after.validation < 0.99 * before.validation else "goes"
        what = what_of(causes, after.plant)
        one = what.count(" is ") == 1 and " are " not in what
        return (
            f"{capital(what)}. With {'it' if one else 'them'}, the validation error {falls} from "
            f"{100 * before.validation:.2f} % to {100 * after.validation:.2f} % and the identification error from "
            f"{100 * before.identification:.2f} % to {100 * after.identification:.2f} %{_at_least(evidence.floor[IDENTIFICATION])}."
        )
    if verdict == UNKNOWN and lost is not None:
        return f"Something is missing that no effect of the catalogue explains. {lost.finding.sentence}"
    if verdict == UNKNOWN:
        said = (
            f"Something is missing that no effect of the catalogue explains: {100 * size.size:.1f} % of the drive's rms could be "
            f"predicted from {FROM[size.kind]}"
        )
        tried = max((*evidence.added, *evidence.refused), key=lambda a: a.size(IDENTIFICATION), default=None)
        if tried is not None and tried.size(IDENTIFICATION) > size.size == 0.0:
            said = (
                f"Something is missing that no effect of the catalogue explains: {title(tried.effect)} takes away "
                f"{100 * tried.size(IDENTIFICATION):.1f} % of the drive's rms on the identification records, but validation does "
                "not bear it out"
            )
        place = lives_in.place if lives_in else None
        if size.kind == "line":
            said = f"{said} of {size.frequency:.3g} Hz"
            if not local(place):
                return f"{said}."
        if place is None:
            return f"{said}; it lives nowhere in particular: not in a place, not at a speed, not at moments."
        return (
            f"{said}. It lives {_lives(place, before.plant.displacement)}: {100 * place.share:.0f} % of its power in "
            f"{100 * place.covered:.0f} % of the samples."
        )
    return (
        f"Nothing is missing: the declared model leaves {100 * before.identification:.2f} % of the drive on identification, and "
        f"{'nothing' if size.size == 0.0 else f'no more than {100 * size.size:.2f} %'} of it could be predicted from "
        "outside the loop; the rest is noise and disturbance."
    )

"""What a trace comes to: verdict, causes and findings as sentences, and where an unexplained residual lives."""

from collections.abc import Sequence

from workbench.effect import find
from workbench.finding import Finding, capital, title
from workbench.identify.result import Fit
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.trace.candidates import ADDITION, CORRECTION
from workbench.trace.place import WAYS, Place
from workbench.trace.result import CAUSE, UNKNOWN, Candidate, Cause
from workbench.trace.unexplained import Unexplained

SPANS = 6  # that are told in words


def _share(before: float, after: float) -> float:
    return 1.0 - (after / before) ** 2 if before > 0 else 0.0


def cause(candidate: Candidate, before: Fit, here: Fit, last: Fit, *, credited: bool = False) -> Cause:
    """Return the cause that a candidate became: its share from `before` to `here`, its parameters from the last fit.

    credited: it was not certain alone, and the candidate is what it came to with the others in place.
    """
    effect = find(candidate.effect.partition(" ")[0])  # without its label
    estimates = tuple(e for e in last.estimates if (e.effect, e.at) == (candidate.effect, candidate.at))
    identification = _share(before.rms[IDENTIFICATION], here.rms[IDENTIFICATION])
    validation = _share(before.rms[VALIDATION], here.rms[VALIDATION])
    verb = "is declared with a wrong value" if candidate.kind != ADDITION else "is missing"
    sentence = (
        f"{capital(title(candidate.effect))} at the {candidate.at} {verb}: {effect.cause}. It explains "
        f"{100 * identification:.1f} % of the residual power on the identification records and {100 * validation:.1f} % "
        "on the validation record."
    )
    if credited:
        sentence += (
            " Alone its gain was not certain, because another effect was missing too; with the others in place it takes away "
            f"{100 * candidate.gain:.1f} % of the held-out residual power (standard error {100 * candidate.scatter:.1f} %)."
        )
    return Cause(
        candidate.effect, candidate.at, sentence, estimates, identification, validation, kind=candidate.kind,
        was=held(before.plant, candidate) if candidate.kind == CORRECTION else {},
    )  # fmt: skip


def held(plant: Plant, candidate: Candidate) -> dict[str, float]:
    """Return outside parameter -> the value that a plant holds it at, of the effect that a candidate corrects."""
    return {n: p.value for n, p in plant[f"{candidate.effect}@{candidate.at}"].outside.items() if p.fixed}


def not_carried(causes: Sequence[Cause]):
    """Yield a finding for each cause that explains much less on validation than on identification."""
    for c in causes:
        if c.share_validation < 0.5 * c.share_identification:
            yield Finding(
                "not carried over", c.effect,
                f"{capital(title(c.effect))} explains {100 * c.share_identification:.0f} % on identification but only "
                f"{100 * c.share_validation:.0f} % on validation; do not rely on it before a second validation record.",
                {"identification": c.share_identification, "validation": c.share_validation},
            )  # fmt: skip


def left_over(unexplained: Unexplained | None, displacement: str = ""):
    """Yield a finding where something stays beside the causes, in a place of its own. displacement: unit of position."""
    if unexplained is not None:
        yield Finding(
            "unexplained", unexplained.place.coordinate,
            f"Beside this, something lives {lives(unexplained.place, displacement)} that no effect of the catalogue explains: there the "
            f"residual is {unexplained.place.inside:.1f} times the noise floor, elsewhere {unexplained.place.outside:.1f} times.",
            {"inside": unexplained.place.inside, "outside": unexplained.place.outside},
            "look at the axis there",
        )  # fmt: skip


def lives(place: Place, displacement: str) -> str:
    """Return "at positions from 0.1 to 0.2 rad, moving forward": where something lives, in SI units. displacement: rad or m."""
    name, unit = {
        "position": ("at positions", displacement),
        "velocity": ("at speeds", displacement and f"{displacement}/s"),
        "time": ("at the times", "s"),
    }[place.coordinate]
    spans = ", ".join(f"{low:.4g} to {high:.4g}" for low, high in place.spans[:SPANS])
    more = f" and {len(place.spans) - SPANS} more" if len(place.spans) > SPANS else ""
    way = f", moving {WAYS[place.direction]}" if place.direction else ""
    return f"{name} from {spans}{unit and f' {unit}'}{more}{way}"


def what_of(causes: Sequence[Cause], plant: Plant) -> str:
    """Return "a and b are missing, and c is declared with a wrong value". plant: with all causes in it."""
    parts = []
    for kind, one, many in (
        (ADDITION, "is missing", "are missing"),
        (CORRECTION, "is declared with a wrong value", "are declared with wrong values"),
    ):
        names = [name_of(c, plant) for c in causes if c.kind == kind]
        if names:
            parts.append(f"{' and '.join(names)} {one if len(names) == 1 else many}")
    return ", and ".join(parts)


def name_of(c: Cause, plant: Plant) -> str:
    """Return the name of a cause, with its place where the plant has another effect of this name."""
    alike = [e for e in plant.effects if e.named == c.effect]
    return f"{title(c.effect)} at the {c.at}" if len(alike) > 1 else title(c.effect)


def verdict_sentence(
    verdict: str, causes: Sequence[Cause], before: Fit, after: Fit, floor, unexplained: Unexplained | None = None
) -> str:
    """Return the verdict as a person reads it, with the errors before and after."""
    if verdict == CAUSE:
        falls = "falls" if after.validation < 0.99 * before.validation else "goes"
        return (
            f"{capital(what_of(causes, after.plant))}. With {'it' if len(causes) == 1 else 'them'}, the validation error {falls} from "
            f"{100 * before.validation:.2f} % to {100 * after.validation:.2f} % and the identification error from "
            f"{100 * before.identification:.2f} % to {100 * after.identification:.2f} % "
            f"(noise floor {100 * floor[IDENTIFICATION]:.2g} %)."
        )
    if verdict == UNKNOWN:
        said = f"Something is missing that no effect of the catalogue explains: the residual is {unexplained.times:.1f} times the noise floor"
        place = unexplained.place
        if place is None:
            return f"{said}, and it lives nowhere in particular: not in a place, not at a speed, not at moments."
        return (
            f"{said}. It lives {lives(place, before.plant.displacement)}: {100 * place.share:.0f} % of its power in {100 * place.covered:.0f} % of the "
            f"samples. Outside, the declared model leaves {place.outside:.1f} times the floor."
        )
    return (
        f"Nothing is missing: the residual, {100 * before.identification:.2f} % on identification, is "
        f"{before.identification / floor[IDENTIFICATION]:.2f} times the noise floor, and no effect of the catalogue "
        "explains a share of it that holds on held-out blocks."
        if floor[IDENTIFICATION] > 0
        else "Nothing is missing: no effect of the catalogue explains a share of the residual that holds on held-out blocks."
    )

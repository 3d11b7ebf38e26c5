"""What a trace comes to, beneath its verdict: causes, refinements and findings as sentences."""

from collections.abc import Sequence
from math import isfinite

from workbench.definition import find
from workbench.finding import BELOW_FLOOR, HUM, SLOW_FORCE, SOMETHING_ELSE, Finding, capital, place, title
from workbench.identification.by_record import held
from workbench.identification.result import Fit
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.answering import much_stays
from workbench.tracing.calibration import Calibration
from workbench.tracing.criteria import Criteria
from workbench.tracing.decide import CAUSE, DRESSING, NOT_BORNE_OUT, Verdict
from workbench.tracing.evidence import ADDITION, CORRECTION, Evidence, Weighed
from workbench.tracing.headline import FROM
from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.result import CandidateScore, Cause, Refinement, physical_cause
from workbench.tracing.smallest import Smallest

CHOSEN = (
    " By the identification records alone it was not certain, since few stretches of them show it; it was fitted to these alone, and is named "
    "because of what it explains of the validation record, which is therefore no test of the choice: another record would be."
)


def cause(
    judgement: ScoredCandidate,
    weight: Weighed,
    before: Fit,
    here: Fit,
    last: Fit,
    declared: Plant,
    *,
    provisional: bool = False,
    chosen: bool = False,
    also: tuple[str, ...] = (),
) -> Cause:
    """Return the cause that a candidate became: its share from `before` to `here`, its parameters from the last fit.

    weight: what whole records say of it. declared: the plant as declared, whose fixed values a correction moved. provisional: it
    was not certain alone, and the candidate is what it came to with the others in place. chosen: it was not certain on the identification
    records, and validation decided. also: what else of a composite is missing.
    """
    score, name = judgement.score, judgement.candidate.name
    was = _held(declared, score) if score.kind == CORRECTION else {}
    estimates = tuple(e for e in last.estimates if (e.effect, e.at) == (score.effect, score.at))
    identification, validation = (
        1.0 - (here.rms[r] / before.rms[r]) ** 2 if before.rms[r] > 0.0 else 0.0
        for r in (IDENTIFICATION, VALIDATION)
    )  # fmt: skip
    sentence = _cause_sentence(judgement, weight, (identification, validation), provisional, also)
    sentence += CHOSEN if chosen else ""
    return Cause(
        name, score.at, sentence, estimates, identification, validation,
        kind=score.kind,
        was=was, law=weight.law, size=weight.size(IDENTIFICATION), behind=weight.behind,
        form=score.effect if name != score.effect else "",
        also=also,
    )  # fmt: skip


def _cause_sentence(
    judgement: ScoredCandidate, weight: Weighed, shares: tuple[float, float], provisional: bool, also: Sequence[str]
) -> str:
    """Return what a cause is and explains. shares: on identification and on validation; the others as of `cause`."""
    score, candidate = judgement.score, judgement.candidate
    law = find((score.effect if candidate.part else candidate.name).partition(" ")[0])  # without its label
    verb = "is declared with a wrong value" if score.kind != ADDITION else "is missing"
    sentence = (
        f"{capital(title(candidate.name))} at the {place(score.at)} {verb}: {physical_cause(law, candidate.name)}. It explains "
        f"{100 * shares[0]:.1f} % of the residual power on the identification records and {100 * shares[1]:.1f} % "
        "on the validation record."
    )
    if candidate.part:
        whose = "With what is declared there it is" if law.parts else "Its law is that of"
        sentence += f" {whose} {title(score.effect)}, {law.formula}."
    if also:
        sentence += f" And that friction gives way before it slips, which what is declared there does not: {title(also[0])} is missing with it."
    if candidate.stands:
        sentence += f" It is {candidate.family}, of no catalogued law: its curve is in the parameters, and the name is that of the nearest law."
    if weight.implausible:
        sentence += f" Doubt it: {weight.implausible}."
    if provisional:
        sentence += (
            " Alone its gain was not certain, because another effect was missing too; with the others in place it takes away "
            f"{100 * score.gain:.1f} % of the held-out residual power (standard error {100 * score.scatter:.1f} %)."
        )
    return sentence


def refinement(c: Cause) -> Refinement:
    """Return what would be a cause, were it not too small for one: nothing says that it is missing."""
    of = "the joint's torque in the load's balance" if c.behind else "the drive's rms"
    sentence = f"{capital(title(c.effect))} at the {place(c.at)} takes away {100 * c.size:.2g} % of {of} on the identification records."
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
    if evidence.before.hum >= criteria.explainable:
        yield Finding(
            HUM, "",
            f"Of the drive's rms {100 * evidence.before.hum:.1f} % is hum of the mains, at {evidence.before.mains:.3g} Hz, that no motion "
            "asks for: the supply's and no law of the axis, in the reported drive alone or as a force.",
            {"size": evidence.before.hum, "frequency": evidence.before.mains},
            "look at the earth and the shield of the current sensor and of the drive's set point",
        )  # fmt: skip
    left = evidence.after if verdict.verdict == CAUSE else evidence.before
    if left.level >= criteria.explainable and left.level > left.time:
        yield Finding(
            SLOW_FORCE, "",
            f"Of the drive's rms {100 * left.level:.1f} % is a force that wanders with bench time, whatever the axis does: low-frequency "
            "noise inside the loop, as of a floor or of other axes, or a drive's zero that drifts; no law of the axis.",
            {"size": left.level},
            "log a long record at rest under control: it has the same force",
        )  # fmt: skip
    yield from not_carried(causes, criteria)
    refused = [(a, NOT_BORNE_OUT) for a in evidence.refused]
    weighed = [*zip(evidence.added, verdict.roles, strict=True)]
    stands = {(a.effect, a.at) for a, role in weighed if role == CAUSE}
    for a, role in (*refused, *weighed):
        yield from _of_addition(a, role, evidence, criteria, again=(a.effect, a.at) in stands)
    if verdict.something_else:
        yield Finding(
            SOMETHING_ELSE, evidence.after.kind,
            f"Beside this, something else is missing: {100 * evidence.after.size:.1f} % of the drive's rms stays predictable from "
            f"{FROM[evidence.after.kind]}.",
            {"before": evidence.before.size, "after": evidence.after.size},
            "look at where the residual lives",
        )  # fmt: skip


def gave_way(w: Weighed) -> Finding:
    """Say of what took most why another effect stands in its place: its values, or where it leads on validation."""
    why = w.implausible or (
        f"with it the drive of the validation records is off by {100 * w.after[VALIDATION]:.0f} %, farther than none at all would be"
    )
    return Finding(
        "gave way", w.effect,
        f"{capital(title(w.effect))} at the {place(w.at)} takes no less of the identification records than what stands in its place, but {why}.",
        {r: x for r, x in w.after.items() if isfinite(x)},
    )  # fmt: skip


def _of_addition(a: Weighed, role: str, evidence: Evidence, criteria: Criteria, *, again: bool):
    """Yield a finding of an addition that stands as no cause. again: whether a cause bears its name, and it was one more of its class."""
    name = f"{capital(f'a second {title(a.effect)}' if again else title(a.effect))} at the {place(a.at)}"
    if role == NOT_BORNE_OUT:
        why = f"on validation it explains {100 * max(a.share(VALIDATION), 0.0):.0f} %"
        if a.power_up:
            why += " with the phase that it has there, which is none of identification's: calibrate it at each power-up"
        if a.came_back(criteria.held, criteria.alike, criteria.near):
            why = (
                f"what is outside the loop bears out {100 * min(max(a.outside, 0.0), 1.0):.0f} % of it; what disturbs the axis comes back "
                "through the loop as motion, and looks like that"
            )
        yield Finding(
            NOT_BORNE_OUT, a.effect,
            f"{name} explains {100 * a.share(IDENTIFICATION):.0f} % of what the identification records leave, but it is not borne out: {why}.",
            {"identification": a.share(IDENTIFICATION), "validation": a.share(VALIDATION)},
        )  # fmt: skip
    elif role == DRESSING:
        yield Finding(
            DRESSING, a.effect,
            f"{name} was tried and explains {100 * max(a.share(VALIDATION), 0.0):.0f} % of what validation leaves: {_why_not(a, evidence, criteria)}.",
            {"identification": a.share(IDENTIFICATION), "validation": a.share(VALIDATION)},
        )  # fmt: skip


def _why_not(a: Weighed, evidence: Evidence, criteria: Criteria) -> str:
    """Return why an addition that takes something is no cause, as a clause."""
    along, stays = max(evidence.before.joint, evidence.before.inertia), evidence.after
    if along > a.size(IDENTIFICATION):
        return (
            f"it takes {100 * a.size(IDENTIFICATION):.1f} % of the drive on identification where what changes along the stroke would take "
            f"{100 * along:.1f} %, so that it only dresses that"
        )
    if a.share(VALIDATION) < criteria.held:
        return "too little to be the cause of what the residual holds"
    if a.kind == CORRECTION and stays.gain >= criteria.beside:
        return (
            f"of what it leaves, a drive whose gain changes slowly in bench time would take {100 * stays.gain:.1f} % of the drive's rms, and the "
            "mean of such a gain is a value that was declared wrong"
        )
    if much_stays(evidence, criteria):
        return (
            f"{100 * stays.most:.1f} % of the drive's rms stays to be explained beside what was added, and causes that leave so much would have "
            f"taken {100 * criteria.near:.0f} % of the residual in both roles"
        )
    if a.implausible:
        return f"but {a.implausible}, as no machine's would"
    return "it leaves what lives in one place where it is, or pays for it elsewhere, so that it only dresses that"


def _held(plant: Plant, score: CandidateScore) -> dict[str, float]:
    """Return outside parameter -> the value that a plant holds it at, of the effect that a candidate corrects."""
    return {n: p.value for n, p in held(plant[f"{score.effect}@{score.at}"]).items()}


def not_carried(causes: Sequence[Cause], criteria: Criteria):
    """Yield a finding for each cause that explains much less on validation than on identification."""
    for c in causes:
        if 0.0 < c.share_identification and c.share_validation < criteria.doubted * c.share_identification:
            yield Finding(
                "not carried over", c.effect,
                f"{capital(title(c.effect))} explains {100 * c.share_identification:.0f} % on identification but only "
                f"{100 * max(c.share_validation, 0.0):.0f} % on validation; do not rely on it before a second validation record.",
                {"identification": c.share_identification, "validation": c.share_validation},
            )  # fmt: skip


def belongs_to_one_power_up(c: Calibration) -> Finding:
    """Return what is said of a wave whose phase does not carry over, with its phases."""
    evidence = {f"phase on {p.record}": p.phase.value for p in c.phases}
    evidence |= {"validation error as identified": c.identified, "validation error calibrated": c.calibrated}
    remedy = "give the axis an absolute encoder or an index pulse, and count from it" if c.differs else ""
    return Finding("calibration", f"{c.effect}@{c.at}", c.sentence, evidence, remedy)


def least_shown(found: Sequence[Smallest], most: int = 3) -> str:
    """Return a sentence that names some of the smallest effects that the records would have shown, or "" where there is none."""
    whole = [s for s in found if not s.change]
    if not whole:
        return ""
    told = [
        f"{title(s.effect)} ({s.parameter.replace('_', ' ')}) of {s.value:.2g}{'' if s.unit == '1' else ' ' + s.unit}"
        for s in whole
    ]
    step = max(1, len(told) // most)
    others = len(told) - most
    more = f", and {others} other{'s' * (others > 1)}" if others > 0 else ""
    return f" The least that these records would have shown: {', '.join(told[::step][:most])}{more}."

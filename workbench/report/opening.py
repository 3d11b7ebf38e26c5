"""The finding, and the records that it rests on."""

from workbench.finding import ASSUMED_SCALE, NOT_TUNED, capital, title
from workbench.record import IDENTIFICATION, ROLES, VALIDATION
from workbench.report import numbers
from workbench.report.advice import headline
from workbench.report.closed_loop import of_loop
from workbench.report.contents import (  # fmt: skip
    BAD,
    CODE,
    GOOD,
    PLAIN,
    STRONG,
    Callout,
    Chapter,
    Marked,
    Paragraph,
    Recorded,
    StudyResult,
    Table,
)
from workbench.report.explained import explained
from workbench.report.glance import glance
from workbench.report.required import judged
from workbench.report.wording import ALARMS, listed
from workbench.tracing.result import NOTHING, UNKNOWN

CAUTIONS = (ASSUMED_SCALE, NOT_TUNED)  # what the numbers rest on and nobody knows; why there are no gains
TONES = {NOTHING: GOOD, UNKNOWN: BAD}


def finding(result: StudyResult) -> Chapter:
    """Page 1: the verdict, how much is explained, which controller to take, the study's own answer, one figure."""
    trace = result.trace
    blocks = [Callout(trace.sentence, TONES.get(trace.verdict, PLAIN))]
    if trace.evidence:
        stands = trace.verdict != UNKNOWN
        blocks += explained(trace.evidence, trace.criteria.explainable, bool(result.advice), stands)
    blocks += _uncertain(result)
    blocks += [Callout(f.sentence, BAD) for f in trace.findings if f.kind in ALARMS]
    if result.advice:
        blocks.append(Callout(headline(result.advice), GOOD if result.advice.allowed else BAD))
    if answer := result.answer or of_loop(result):
        blocks.append(Paragraph(answer))
    blocks += [Callout(f.sentence, BAD) for f in result.findings if f.kind in CAUTIONS]
    blocks.append(glance(result))
    if result.checks:
        failed = not all(c.passed for c in result.checks)
        blocks.append(Callout(judged(result.checks), BAD) if failed else Paragraph(judged(result.checks)))
    return Chapter("The finding", tuple(blocks))


def _uncertain(result: StudyResult) -> list[Paragraph]:
    """Say which causes these records hardly tell from others; how to find out stands with the evidence."""
    told = (f"{c.title} from {listed([title(r) for r in c.rivals])}" for c in result.trace.causes if c.rivals)
    rivals = [*dict.fromkeys(told)]  # two orders of one wave are one cause
    return [Paragraph(f"These records hardly tell {listed(rivals)}.")] if rivals else []


def _errors(result: StudyResult) -> Table:
    """Errors on identification and validation of the declared and the extended model, beside the lower bound that noise sets."""
    trace = result.trace
    fits = (trace.before, trace.after) if trace.causes else (trace.before,)
    roles = [role for role in ROLES if any(r.role == role for r in result.records)]
    rows = []
    for role in roles:
        errors = [numbers.percent(getattr(f, role), 3) for f in fits]
        rows.append((capital(role), *_stressed(errors), numbers.percent(trace.floor.get(role, float("nan")), 3)))
    factor, unit = numbers.prefixed(max(trace.before.rms.values()), result.plant.effort)
    for role in roles:
        left = [numbers.number(f.rms[role] * factor) for f in fits]
        whole = trace.before.rms[role] / getattr(trace.before, role) if getattr(trace.before, role) else float("nan")
        least = numbers.number(trace.floor.get(role, float("nan")) * whole * factor)
        rows.append((f"{capital(role)}, rms residual ({unit})", *_stressed(left), least))
    models = ("declared model", "extended model")[: len(fits)]
    caption = (
        f"Error of the predicted {result.drive} in per cent of the measured {result.drive}, and what is left of it, both "
        f"behind the evaluation filter ({numbers.exact(result.bandwidth)} Hz). Parameters come from the identification "
        "records alone. The lower bound is what encoder steps and drive noise would leave of a perfect model; how much more no model "
        "could take away, the records do not tell."
    )
    return Table(("error", *models, "lower bound"), tuple(rows), caption, "p" + "r" * (len(models) + 1))


def _stressed(texts: list[str]) -> tuple[str | Marked, ...]:
    return (*texts[:-1], Marked(texts[-1], STRONG))


def records(result: StudyResult) -> Chapter:
    """What was measured, and how well each record is predicted."""
    trace = result.trace
    rows = tuple(_row(r, result) for r in result.records)
    heads = [
        "record",
        "role",
        "motion",
        "samples",
        "rate (Hz)",
        "length (s)",
        f"rms {result.drive} ({numbers.unit(result.plant.effort)})",
    ]
    heads += ["declared", "extended"] if trace.causes else ["error"]
    roles = [r.role for r in result.records]
    text = (
        f"The finding rests on {_some(roles.count(IDENTIFICATION))} for identification, from which all parameters come, and "
        f"{_some(roles.count(VALIDATION))} for validation, by which nothing is fitted and which has to bear out what was found; together they last "
        f"{numbers.exact(sum(r.duration for r in result.records), 3)} s."
    )
    caption = (
        "The records, and the error of each model on each of them"
        if trace.causes
        else "The records, and the error on each"
    )
    letters = "llprrrr" + "r" * (len(heads) - 7)
    if not any(r.motion for r in result.records):  # nobody said what they were
        heads, letters, rows = heads[:2] + heads[3:], letters[:2] + letters[3:], tuple(r[:2] + r[3:] for r in rows)
    return Chapter(
        "The records",
        (
            Paragraph(text),
            _errors(result),
            Table(tuple(heads), rows, caption + ".", letters),
        ),
    )


def _some(count: int) -> str:
    return f"{numbers.count(count)} record{'' if count == 1 else 's'}"


def _row(r: Recorded, result: StudyResult) -> tuple[str | Marked, ...]:
    fits = (result.trace.before, result.trace.after) if result.trace.causes else (result.trace.before,)
    errors = (numbers.percent(f.nrmse.get(r.name, float("nan"))) for f in fits)
    return (
        Marked(r.name, CODE), r.role, r.motion, numbers.count(r.samples), numbers.exact(r.rate),
        numbers.number(r.duration), numbers.number(r.drive_rms), *errors,
    )  # fmt: skip

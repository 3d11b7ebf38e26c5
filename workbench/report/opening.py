"""The finding, and the records that it rests on."""

from workbench.finding import capital, title
from workbench.record import IDENTIFICATION, ROLES, VALIDATION
from workbench.report import numbers
from workbench.report.contents import (  # fmt: skip
    BAD,
    CODE,
    GOOD,
    PLAIN,
    STRONG,
    Callout,
    Chapter,
    Check,
    Items,
    Marked,
    Paragraph,
    Recorded,
    StudyResult,
    Table,
)
from workbench.report.recommend import RECOMMENDED
from workbench.report.wording import bound, listed, said
from workbench.tracing.evidence import Evidence
from workbench.tracing.result import NOTHING, UNKNOWN, Cause

ALARMS = ("below the floor", "joint carries nothing")
TONES = {NOTHING: GOOD, UNKNOWN: BAD}


def finding(result: StudyResult) -> Chapter:
    """The verdict in a box, errors before and after, the requirements, and what else was found."""
    trace = result.trace
    advice = [f for f in result.findings if f.kind == RECOMMENDED]
    blocks = [Callout(trace.sentence, TONES.get(trace.verdict, PLAIN)), *(Callout(f.sentence, GOOD) for f in advice)]
    blocks += [Callout(f.sentence, BAD) for f in trace.findings if f.kind in ALARMS]
    blocks.append(errors(result))
    if trace.evidence:
        blocks.append(Paragraph(predictable(trace.evidence)))
    if trace.causes:
        blocks.append(Items(tuple(sized(c) for c in trace.causes)))
    if trace.refinements:
        blocks.append(Paragraph("Refinements, too small for a cause, leave the verdict as it is:"))
        blocks.append(Items(tuple(r.sentence for r in trace.refinements)))
    if result.checks:
        blocks += [
            Callout(judged(result.checks), GOOD if all(c.passed for c in result.checks) else BAD),
            required(result),
        ]
    elsewhere = (*advice, *trace.findings, *trace.before.findings, *trace.after.findings)  # told where they belong
    return Chapter("The finding", (*blocks, *said(f for f in result.findings if f not in elsewhere)))


def predictable(e: Evidence) -> str:
    """Say how much of what is left anything could predict: the scale on which the verdict was taken."""
    before, after = (numbers.percent(x.size) if x.size else "nothing" for x in (e.before, e.after))
    text = f"Of the drive's rms, {before} of what the declared model leaves could be predicted from outside the loop"
    if e.added:
        text += f", and {after} with what was tried in place"
    where = (
        ""
        if e.before.instrument == "reference"
        else "; no reference was logged, so the low-passed position stood for it"
    )
    return f"{text}{where}. The rest is noise and disturbance, which no effect may claim."


def sized(c: Cause) -> str:
    """Return how large a cause is, and how it would be told from its rivals."""
    values = (f"{e.meaning} {numbers.estimate(e.value, e.high - e.value, e.unit)}" for e in c.parameters)
    text = f"{capital(title(c.effect))} acts at the {c.at}: {listed(list(values))}."
    if c.form:
        text = (
            f"{capital(title(c.effect))} acts at the {c.at}, by no catalogued law: {len(c.parameters)} numbers of its curve stand "
            "with the cause."
        )
    if c.rivals:
        text += f" These records hardly tell it from {listed([title(r) for r in c.rivals])}."
    return text + (f" An experiment that decides: {c.experiment.rstrip('.')}." if c.experiment else "")


def errors(result: StudyResult) -> Table:
    """Errors on identification and validation of the declared and the extended model, beside the noise floor."""
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
        "records alone; the noise floor is what encoder steps and drive noise would leave of a perfect model."
    )
    return Table(("error", *models, "noise floor"), tuple(rows), caption, "p" + "r" * (len(models) + 1))


def _stressed(texts: list[str]) -> tuple[str | Marked, ...]:
    return (*texts[:-1], Marked(texts[-1], STRONG))


def judged(checks: tuple[Check, ...]) -> str:
    """Return one sentence on the requirements."""
    failed = [c.name for c in checks if not c.passed]
    if not failed:
        return (
            f"All {len(checks)} requirements of the study hold."
            if len(checks) > 1
            else "The study's requirement holds."
        )
    verb = "does" if len(failed) == 1 else "do"
    return f"{len(failed)} of {len(checks)} requirements {verb} not hold: {listed(failed)}."


def required(result: StudyResult) -> Table:
    """Every requirement with its value and bound."""
    rows = tuple(
        (
            c.name,
            c.value if isinstance(c.value, str) else numbers.number(c.value),
            bound(c.bound),
            numbers.unit(c.unit),
            Marked("passed", GOOD) if c.passed else Marked("failed", BAD),
        )
        for c in result.checks
    )
    return Table(("requirement", "value", "bound", "unit", "result"), rows, "Requirements of the study.", "prrll")


def records(result: StudyResult) -> Chapter:
    """What was measured, and how well each record is predicted."""
    trace = result.trace
    unit = numbers.unit(result.plant.effort)
    heads = ["record", "role", "motion", "samples", "rate (Hz)", "length (s)", f"rms {result.drive} ({unit})"]
    heads += ["declared", "extended"] if trace.causes else ["error"]
    rows = tuple(_row(r, result) for r in result.records)
    roles = [r.role for r in result.records]
    text = (
        f"The campaign has {_some(roles.count(IDENTIFICATION))} for identification, from which all parameters come, and "
        f"{_some(roles.count(VALIDATION))} for validation, read only after the model had been chosen; together they last "
        f"{numbers.exact(sum(r.duration for r in result.records), 3)} s."
    )
    caption = (
        "The records, and the error of each model on each of them"
        if trace.causes
        else "The records, and the error on each"
    )
    return Chapter(
        "The records", (Paragraph(text), Table(tuple(heads), rows, caption + ".", "llprrrr" + "r" * (len(heads) - 7)))
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

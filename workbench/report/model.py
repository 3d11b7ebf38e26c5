"""The declared model and the extended one: which effects they hold, and their parameters."""

from collections.abc import Collection, Mapping, Sequence

from workbench.finding import Finding, capital, located, title
from workbench.identification.result import Estimate, Fit
from workbench.identification.wording import DISAGREE
from workbench.plant import MASSES, Plant
from workbench.report import numbers
from workbench.report.contents import BAD, CODE, QUIET, Chapter, Heading, Marked, Paragraph, StudyResult, Table
from workbench.report.wording import finding_items, named
from workbench.tracing.result import Refinement

Spread = Mapping[str, tuple[float, float]]

HELD = "Values marked as fixed were declared as known and were not fitted."
BY_RECORD = (
    "By record: the lowest and the highest of what each identification record says by itself of a linear parameter, the "
    "shape being the common one."
)


def declared(result: StudyResult) -> Chapter:
    """What the engineer believes in, and what the records say about it."""
    fit = result.trace.before
    text = (
        f"The model is a plant of {MASSES[result.plant.kind]}: at every moment the effects below together need the {result.drive} "
        "that the drive gives. Their parameters were fitted to the identification records, all at once."
    )
    blocks = [
        Paragraph(text + _in_place(fit.plant, result.trace.refinements)),
        _effects(fit.plant, "The effects of the declared model."),
        parameters(fit.estimates, f"Parameters of the declared model with 95 % intervals. {_held(fit)}", fit=fit),
        *_on_parameters(fit.findings),
    ]
    return Chapter("The declared model", tuple(blocks))


def _in_place(plant: Plant, refinements: Sequence[Refinement]) -> str:
    """Return which effects stand in the place of declared ones whose law is only nearly right, as sentences; "" where none does."""
    held = {e.key: e for e in plant.effects}
    found = []
    for r in refinements:
        keys = {f"{e.effect}@{e.at}" for e in r.parameters} & held.keys()
        if f"{r.effect}@{r.at}" not in held and len(keys) == 1:
            stands = held[keys.pop()]
            found.append(
                f" {capital(located(stands.name, stands.at))} stands in the place of the declared {title(r.effect)}, whose law "
                "is only nearly right: all errors, before and after, are beside it."
            )
    return "".join(found)


def extended(result: StudyResult) -> Chapter | None:
    """The declared model with what it lacked: the one that all that follows is computed with. None where it lacked nothing."""
    trace = result.trace
    if not trace.causes:
        return None
    names = named(trace.causes)
    text = (
        f"Once {names} {'is' if len(trace.causes) == 1 else 'are'} in the model, the other parameters move by what they had stood "
        "in for; all were fitted again together."
    )
    caption = f"Parameters of the extended model with 95 % intervals, beside the declared model's values. {_held(trace.after)}"
    blocks = (Paragraph(text), parameters(trace.after.estimates, caption, trace.before.estimates, fit=trace.after))
    return Chapter("The extended model", (*blocks, *_on_parameters(trace.after.findings)))


def _held(fit: Fit) -> str:
    """Return what the caption of a table of parameters says of its cells."""
    return f"{HELD} {BY_RECORD}" if fit.spread else HELD


def _on_parameters(findings: Sequence[Finding]) -> tuple:
    """Return the findings on parameters under their headings; nothing where there are none."""
    differ = [f for f in findings if f.kind == DISAGREE]
    rest = [f for f in findings if f.kind != DISAGREE]
    blocks = (Heading("Where the records disagree"), *finding_items(differ)) if differ else ()
    return blocks + ((Heading("What these records do not determine"), *finding_items(rest)) if rest else ())


def _effects(plant: Plant, caption: str) -> Table:
    """Which effects a plant holds, where they act, and their laws."""
    rows = tuple((e.title, e.at, Marked(e.formula, CODE), e.cause) for e in plant.effects)
    return Table(("effect", "at", "law", "cause"), rows, caption, "llwp")


def _of_effects(estimates: Sequence[Estimate]) -> str:
    """Return whether the place must be told: only where an effect or a place differs."""
    return "at" if len({e.at for e in estimates}) > 1 else ""


def _interval(e: Estimate) -> tuple[str, str | Marked]:
    """Return (value, 95 % interval) of an estimate as cells."""
    value, wide = numbers.with_interval(e.value, e.low, e.high)
    if e.fixed:
        return value, Marked("fixed", QUIET)
    if not wide:
        return value, Marked("none: on its bound", BAD)
    undetermined = not e.low * e.high > 0
    return value, Marked(f"{wide}, not determined", BAD) if undetermined else wide


def _by_record(e: Estimate, spread: Spread, differ: Collection[str]) -> str | Marked:
    """Return what the records say of a parameter one at a time, as a cell; marked where they disagree."""
    name = f"{e.effect}@{e.at}.{e.parameter}"
    if name not in spread:
        return Marked("\u2013", QUIET)
    low, high = spread[name]
    text = numbers.with_interval((low + high) / 2, low, high)[1] or numbers.number(low)
    return Marked(text, BAD) if name in differ else text


def parameters(
    estimates: Sequence[Estimate], caption: str, before: Sequence[Estimate] = (), *, fit: Fit | None = None
) -> Table:
    """Return a table of parameters with their intervals.

    before: what the declared model found, beside. fit: whose records say something of a parameter one at a time, beside.
    """
    earlier = {(e.effect, e.at, e.parameter): _interval(e)[0] for e in before}
    spread = fit.spread if fit is not None else {}
    differ = {f.subject for f in fit.findings if f.kind == DISAGREE} if fit is not None else set()
    rows, last = [], None
    for e in estimates:
        here = (e.effect, e.at)
        name = f"{e.title} ({e.at})" if _of_effects(estimates) else e.title
        value, wide = _interval(e)
        was = (earlier.get((*here, e.parameter), Marked("\u2013", QUIET)),) if before else ()
        each = (_by_record(e, spread, differ),) if spread else ()
        first = name if here != last else ""
        rows.append(
            (
                first,
                Marked(e.parameter, CODE),
                *(() if before else (e.meaning,)),
                *was,
                value,
                wide,
                *each,
                numbers.unit(e.unit),
            )
        )
        last = here
    was, each = ("declared",) if before else (), ("by record",) if spread else ()
    now = "extended" if before else "value"
    meaning = () if before else ("meaning",)  # what was said of them already
    columns = ("effect", "parameter", *meaning, *was, now, "95 % interval", *each, "unit")
    return Table(
        columns, tuple(rows), caption, ("pl" if before else "llp") + "r" * len(was) + "rr" + "r" * len(each) + "l"
    )

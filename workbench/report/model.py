"""The declared model and the extended one: which effects they hold, and their parameters."""

from collections.abc import Sequence

from workbench.finding import Finding, title
from workbench.identification.findings import DISAGREE
from workbench.identification.result import Fit
from workbench.plant import MASSES, Plant
from workbench.report.contents import CODE, Chapter, Heading, Marked, Paragraph, StudyResult, Table
from workbench.report.wording import listed, parameters, said

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
        Paragraph(text),
        _effects(fit.plant, "The effects of the declared model."),
        parameters(fit.estimates, f"Parameters of the declared model with 95 % intervals. {_held(fit)}", fit=fit),
        *_on_parameters(fit.findings),
    ]
    return Chapter("The declared model", tuple(blocks))


def extended(result: StudyResult) -> Chapter:
    """The declared model with what it lacked: the one that all that follows is computed with."""
    trace = result.trace
    names = listed([title(c.effect) for c in trace.causes])
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
    blocks = (Heading("Where the records disagree"), *said(differ)) if differ else ()
    return blocks + ((Heading("What these records do not determine"), *said(rest)) if rest else ())


def _effects(plant: Plant, caption: str) -> Table:
    """Which effects a plant holds, where they act, and their laws."""
    rows = tuple((title(e.name), e.at, Marked(e.formula, CODE), e.cause) for e in plant.effects)
    return Table(("effect", "at", "law", "cause"), rows, caption, "llwp")

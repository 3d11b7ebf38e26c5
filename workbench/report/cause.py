"""The cause, and the evidence for it: every candidate that was tried, ranked on data that its fit did not see."""

from collections.abc import Sequence

from workbench.finding import capital
from workbench.plant import Plant
from workbench.report import figures, numbers
from workbench.report.contents import (
    GOOD,
    QUIET,
    Chapter,
    Figure,
    Heading,
    Items,
    Marked,
    Paragraph,
    StudyResult,
    Table,
)
from workbench.report.model import parameters
from workbench.report.wording import ALARMS, finding_items, named
from workbench.tracing.result import CAUSE, CandidateScore, Cause, physical_cause
from workbench.tracing.smallest import Smallest

BEST = 10


def cause(result: StudyResult) -> Chapter:
    """Candidates, the cause with its law and parameters, and what speaks against it."""
    trace = result.trace
    blocks = [Paragraph(_how(result)), _ranked(result), _table(result), *_later(result)]
    for c in trace.causes:
        blocks += _described(c, trace.after.plant)
    if trace.verdict != CAUSE and trace.smallest:
        blocks += [Heading("What these records could have shown"), _smallest(trace.smallest)]
    heading = "The cause and its evidence" if trace.verdict == CAUSE else "The candidates that were tried"
    if trace.refinements:
        blocks.append(
            Paragraph(
                "Refinements, too small for a cause or of a law that is declared and only nearly right, leave the verdict as it is:"
            )
        )
        blocks.append(Items(tuple(r.sentence for r in trace.refinements)))
    return Chapter(heading, (*blocks, *finding_items(f for f in trace.findings if f.kind not in ALARMS)))


def _how(result: StudyResult) -> str:
    """Say what a candidate must do."""
    criteria = result.trace.criteria
    names = named(result.trace.causes)
    count = numbers.count(len(result.trace.ranked))
    return (
        f"Of {count} candidates {names or 'none'} earned a place in the model. Each was fitted together with the declared model: "
        "the effects of the catalogue that can act on this axis and were not declared, and the values that were declared as fixed, "
        "set free. A candidate counts by what it takes away on blocks of the records that its fit did not see. It earns its "
        f"place if that is more than {numbers.percent(criteria.share)} of the residual's power and more than {criteria.certain:g} times its own "
        "scatter; of candidates that the data cannot tell apart, the one with the fewest parameters leads. Where none is certain "
        "alone, one with a plain gain is added on trial, and stays only if it and a later one then earn their places."
    )


def _ranked(result: StudyResult) -> Figure:
    """The bar chart of the first step."""
    best = result.trace.ranked[:BEST]
    added = [(c.effect, c.at) for c in result.trace.causes]
    heading = _leading(best, added)
    caption = (
        f"Reduction of the held-out squared residual by the best {len(best)} of {len(result.trace.ranked)} candidates, each "
        "alone beside the declared model. Error bars: one standard error over blocks."
    )
    alt = "A bar chart. " + " ".join(f"{capital(c.title)}: {_gain(c)}." for c in best)
    return Figure(
        "candidates", lambda: figures.ranking(heading, best, added, result.trace.criteria.share), caption, alt
    )


def _leading(best: Sequence[CandidateScore], added: Sequence[tuple[str, str]]) -> str:
    """Return what the chart shows in one sentence."""
    if not best:
        return "There was no candidate to try"
    first, *rest = best
    if not added:
        return f"No candidate earns its place: the best, {first.title}, takes away {_gain(first)}"
    then = max(rest, key=lambda c: c.gain, default=None)
    tail = f"; {then.title}, the next, {numbers.percent(max(then.gain, 0.0), 3)}" if then else ""
    return f"{capital(first.title)} takes away {numbers.percent(first.gain, 3)} of the held-out residual power{tail}"


def _gain(c: CandidateScore) -> str:
    return f"{_share(c)}\u00a0%"


def _share(c: CandidateScore) -> str:
    """Return gain and scatter in per cent, to hundredths at most: what is less does not matter."""
    places = 2 if 100 * c.scatter < 1 else 1
    return f"{numbers.placed(100 * c.gain, places)} \u00b1 {numbers.placed(100 * c.scatter, places)}"


def _table(result: StudyResult) -> Table:
    """The best ten in numbers."""
    added = [(c.effect, c.at) for c in result.trace.causes]
    rows = tuple(
        (
            str(i + 1),
            c.title,
            c.at,
            "value set free" if c.kind == "correction" else "new effect",
            _share(c),
            numbers.percent(c.held_out, 3),
            numbers.percent(c.nrmse, 3),
            _fate(c, added),
        )
        for i, c in enumerate(result.trace.ranked[:BEST])
    )
    columns = ("rank", "candidate", "at", "what", "gain (%)", "held-out error", "fitted error", "result")
    caption = "The candidates of the first step: held-out gain with one standard error, and the errors that they reach."
    return Table(columns, rows, caption, "rplprrrl")


def _fate(c: CandidateScore, added: Sequence[tuple[str, str]]) -> Marked | str:
    if (c.effect, c.at) in added:
        return Marked("added", GOOD)
    return "earns its place" if c.earns else Marked("does not count", QUIET)


def _later(result: StudyResult) -> tuple[Items, ...]:
    """What the following steps tried, each beside the model as the step before had left it."""
    texts, steps = [], result.trace.steps
    causes = {(c.effect, c.at) for c in result.trace.causes} - {(c.effect, c.at) for s in steps[:1] for c in s[:1]}
    for i, step in enumerate(steps[1:], start=2):
        if step:
            c = step[0]
            if (c.effect, c.at) in causes:
                end = "was added"
                causes.discard((c.effect, c.at))  # a law of the same name that a later step tries is another one
            elif i < len(steps):
                end = "was added, and taken out again later"
            else:
                end = "was not added, and the search ended"
            texts.append(f"Step {i}: the best of {len(step)} further candidates, {c.title} ({_gain(c)}), {end}.")
    return (Items(tuple(texts)),) if texts else ()


def _described(c: Cause, plant: Plant) -> list:
    """One cause: its sentence, law, source, shares and parameters, and how it would be told from its rivals."""
    effect = plant[c.key]
    facts = [
        ("Acts at", c.at),
        ("Physical cause", physical_cause(effect, c.effect)),
        ("Law", effect.formula),
        ("Source", effect.source),
        ("Explains, on identification", f"{numbers.percent(c.share_identification, 3)} of the residual's power"),
        ("Explains, on validation", f"{numbers.percent(c.share_validation, 3)} of the residual's power"),
    ]
    if c.experiment:
        facts.append(("Experiment that decides", c.experiment))
    name = capital(c.title)
    return [
        Heading(name),
        Paragraph(c.sentence),
        Table(
            ("fact", "what is known"), tuple((Marked(k, "strong"), v) for k, v in facts), f"{name}: what it is.", "lp"
        ),
        parameters(c.parameters, f"{name}: its parameters with 95 % intervals."),
    ]


def _smallest(found: Sequence[Smallest]) -> Table:
    """The smallest effect of each kind that would have counted."""
    rows = tuple(
        (
            s.title,
            s.at,
            "change" if s.change else "whole",
            s.parameter.replace("_", " "),
            numbers.number(s.value),
            numbers.unit(s.unit),
        )
        for s in found
    )
    caption = "The smallest effect of each kind that these records could have shown beside the declared model."
    columns, letters = ("effect", "at", "whole or change", "parameter", "value", "unit"), "lllprl"
    if any(s.change for s in found):
        return Table(columns, rows, caption, letters)
    return Table(columns[:2] + columns[3:], tuple(r[:2] + r[3:] for r in rows), caption, letters[:2] + letters[3:])

"""Tables of what a trace added step by step, and of what was tried beside it and not borne out."""

from collections.abc import Sequence

from workbench.finding import capital, title
from workbench.identification.result import Fit
from workbench.report.contents import Table
from workbench.tracing.hypotheses import Tried
from workbench.tracing.result import Trace
from workbench.tracing.steps import steps


def hundredths(ratio: float) -> str:
    """Return a ratio in hundredths of a per cent: "4.08 %", as errors on benchmarks are printed."""
    return f"{100 * ratio:.2f} %"


def steps_table(found: Trace) -> Table:
    """Return the evidence for each added effect as a table."""
    rows = [("as declared", "", hundredths(found.before.identification), hundredths(found.before.validation))]
    for s in steps(found):
        gain = f"{100 * s.gain:.1f} ± {100 * s.scatter:.1f} %"
        rows.append((f"and {title(s.effect)}", gain, hundredths(s.identification), hundredths(s.validation)))
    return Table(
        ("Model", "Held-out gain", "Identification error", "Validation error"),
        tuple(rows),
        "Effects in the order in which the trace added them. Held-out gain: share of the residual's power taken away on "
        "blocks of the identification record that the fit did not see, with one standard error. The choice was made by it "
        "alone; the validation error was only looked at.",
        "prrr",
    )


def tried_table(results: Sequence[Tried], beside: Fit) -> Table:
    """Return hypotheses as a table, each with whether it holds on held-out blocks and on the validation record."""
    rows = [("the traced model", "", hundredths(beside.identification), hundredths(beside.validation), "")]
    for r in results:
        lower = r.validation < beside.validation
        verdict = ("carries over" if lower else "does not carry over") if r.gain > 3.0 * r.scatter else "not borne out"
        gain = f"{100 * r.gain:.1f} ± {100 * r.scatter:.1f} %"
        rows.append((capital(r.hypothesis), gain, hundredths(r.identification), hundredths(r.validation), verdict))
    return Table(
        ("With", "Held-out gain", "Identification error", "Validation error", "What the data say"),
        tuple(rows),
        "Each hypothesis alone beside the traced model. Not borne out: its held-out gain is within three standard errors of "
        "nothing.",
        "prrrl",
    )

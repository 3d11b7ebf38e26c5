"""How much of what could be explained is explained, in words for the first page."""

from workbench.report import numbers
from workbench.report.contents import BAD, Block, Callout, Paragraph
from workbench.tracing.evidence import Evidence

MOST = 0.5  # of what could be explained: where more is left, a model is not to be built on


def explained(e: Evidence, least: float, gains: bool, stands: bool = True) -> tuple[Block, ...]:
    """Return what is explained of what could be, and a caution where most is not.

    least: share of the drive from which anything is missing. gains: whether the page recommends any. stands: whether what was added does, or only
    dresses what is missing and is in no model of the page.
    """
    before, after = e.before.size, e.after.size if stands else e.before.size
    if before < least:
        return ()  # the verdict says it
    share = max(0.0, 1.0 - after / before)
    rest = f"{numbers.percent(after)} still can" if after else "nothing more can"
    text = (
        f"Explained is {numbers.percent(share) if share else 'nothing'} of what could be explained: of the drive's rms, "
        f"{numbers.percent(before)} could be predicted from the motion asked for and from time, beyond what the declared model "
        f"says; {rest}."
    )
    if e.after.size < after:
        text += f" What was tried would take {numbers.percent(1.0 - e.after.size / before)} of that, but does not stand for what is missing."
    if e.before.instrument != "reference":
        text += " No reference was logged, so the low-passed position stood for it."
    if share >= MOST or after < least:
        return (Paragraph(text),)
    built = "the gains below are built on" if gains else "gains would be built on"
    caution = (
        f"So most of it is not explained: do not rely on this model, which {built}, before what is missing is known."
    )
    return (Callout(f"{text} {caution}", BAD),)

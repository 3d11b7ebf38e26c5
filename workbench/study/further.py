"""What tables of study.toml ask of tuned controllers besides: each is read, and answered, by the module of its name."""

from collections.abc import Callable
from functools import partial

from workbench.cancellation.contestant import margins
from workbench.firmware.naming import slug
from workbench.study.compensation import compensation
from workbench.study.drive import driven
from workbench.study.firmware import as_firmware, firmware_part
from workbench.study.limit_cycle import limit_cycles
from workbench.study.outcome import Part, with_part
from workbench.study.robustness import robustness
from workbench.study.tuned import Tuned

Say = Callable[[str], None]


def _robustness(t: Tuned, say: Say) -> Part:
    """Return what a series says, and of the recommended controller the share of draws beyond its limit."""
    part = robustness(t.study, t.task, t.factories, say)
    share = part.figures.get(f"share_beyond_final_error_{slug(t.worth.choice.name)}")
    return part if share is None else with_part(part, Part({"recommended_share_beyond": share}))


def _limit_cycle(t: Tuned, say: Say) -> Part:
    return limit_cycles(t.study, t.task, t.factories, say)


def _compensation(t: Tuned, say: Say) -> Part:
    return compensation(t.study, t.task, t.factories, say, margins=partial(margins, t.made, t.task))


def _firmware(t: Tuned, say: Say) -> Part:
    named = as_firmware(t.made.tuned, t.worth.choice.name)
    return firmware_part(named, t.task, t.trace.verdict, say, t.made.climbed)


def _drive(t: Tuned, say: Say) -> Part:
    return driven(t.study, t.task, t.made, t.records, t.bandwidth, t.control.rule, say)


# table of study.toml -> what it asks; what stands without one is asked of every study
FURTHER: tuple[tuple[str, Callable[[Tuned, Say], Part]], ...] = (
    ("robustness", _robustness),
    ("limit_cycle", _limit_cycle),
    ("compensation", _compensation),
    ("", _firmware),
    ("drive", _drive),
)


def further(t: Tuned, say: Say) -> Part:
    """Return what the tables that a study has ask of its tuned controllers."""
    part = Part()
    for table, asked in FURTHER:
        if not table or table in t.study.table:
            part = with_part(part, asked(t, say))
    return part

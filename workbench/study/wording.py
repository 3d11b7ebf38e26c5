"""What a study says of its own gains: what they rest on, which to take, what cannot be written of them, and why there are none."""

from collections.abc import Mapping

from workbench.design.design import Designed
from workbench.finding import CONSTRAINT_DROPPED, NOT_TUNED, Finding
from workbench.readers.declaration import Table
from workbench.report import numbers
from workbench.report.recommend import RECOMMENDED
from workbench.report.wording import listed
from workbench.study.control import Control
from workbench.verification.assumed import Shown
from workbench.verification.recommend import Recommended

SUBJECT = "gains"
ASSUMED, REFUSED, NONE = "assumed loop", "drive refuses", "no firmware"
STATED = (("loop", "sample_time"), ("loop", "resolution"), ("task", "step"))  # what a study else has to state


def rests_on(top: Table, control: Control, shown: Shown | None, made: Designed) -> tuple[Finding, ...]:
    """Return what gains rest on: what the records had to say in the study's place, and from which amplitude on the goal is kept."""
    left = [f"{table}.{key}" for table, key in STATED if key not in top.values.get(table, {})]
    said = [] if shown is None or not left else [_assumed(control, left, shown.record)]
    lowest = float(made.gains.amplitude[0])
    return (*said, *([] if lowest <= control.amplitudes[0] else [_raised(control, lowest, made.plant.displacement)]))


def _assumed(control: Control, left: list[str], record: str) -> Finding:
    """left: keys that the study does not state."""
    loop, task, x = control.loop, control.task, control.task.plant.displacement
    sentence = (
        f"The gains are for a loop of {1e3 * loop.sample_time:.4g} ms with {1e3 * loop.delay:.4g} ms of delay, an encoder of "
        f"{loop.resolution:.3g} {x}, and a step of {task.step:.3g} {x} at no more than {control.speed_limit:.3g} {x}/s; of "
        f"these, {listed(left)} are assumed from record '{record}'."
    )
    return Finding(ASSUMED, SUBJECT, sentence, {}, "State what is known of them in study.toml.")


def _raised(control: Control, lowest: float, x: str) -> Finding:
    """lowest: amplitude from which on any gains keep the goal, in x."""
    sentence = (
        f"Below {numbers.scaled(lowest, x)} no gains keep |S| below {control.goal.sensitivity:g} and the overshoot against the axis's own "
        f"stiffness in a loop of {1e3 * control.loop.sample_time:.4g} ms; those of {numbers.scaled(lowest, x)} are held there."
    )
    return Finding(CONSTRAINT_DROPPED, SUBJECT, sentence, {"lowest": lowest}, "Sample faster, or delay less.")


def recommended(choice: Recommended) -> Finding:
    """Return which controller to take."""
    return Finding(RECOMMENDED, SUBJECT, choice.sentence, {}, "")


def refused_formats(refused: Mapping[str, str]) -> tuple[Finding, ...]:
    """Return what a drive's formats cannot hold. refused: format -> the sentence by which it was refused."""
    return tuple(Finding(REFUSED, format, sentence, {}, "") for format, sentence in refused.items())


def no_firmware(name: str, arithmetic: str, why: Exception) -> Finding:
    """Return that a controller has no firmware in one arithmetic."""
    return Finding(NONE, arithmetic, f"There is no firmware of {name} in {arithmetic}: {why}", {}, "")


def no_gains(why: Exception) -> str:
    """Return, at the start of a run, why it will come to no gains."""
    return f"No gains will be tuned: {why}"


def not_tuned(why: Exception) -> Finding:
    """Return why a study has no gains."""
    return Finding(NOT_TUNED, SUBJECT, f"No gains are tuned: {why}")

"""What a study required, in words, with what came out."""

import re
from collections.abc import Sequence

from workbench.report import numbers
from workbench.report.contents import BAD, GOOD, Chapter, Check, Marked, Paragraph, StudyResult, Table
from workbench.report.wording import bound, listed

WORDS = {  # of figures that every study of a campaign has; a study's own words stand in its [words]
    "verdict": "the verdict",
    "first_cause": "the effect that was found first",
    "added": "the effects that were found",
    "identification_error_before": "error of the declared model on the identification records",
    "identification_error_after": "error of the last model on the identification records",
    "validation_error_before": "error of the declared model on the validation records",
    "validation_error_after": "error of the last model on the validation records",
    "sensitivity_peak": "largest peak of the sensitivity over all amplitudes",
    "drive_sensitivity_peak": "largest peak of the sensitivity under the gains of the closed drive",
    "compensation_sensitivity": "largest peak of the sensitivity with the compensation",
    "schedule_interpolation_error": "what interpolation between the knots of the gain table costs",
    "scheduled_time_over_bound": "time to 1 % under the gain table, over the shortest that the drive allows",
    "scheduled_final_error": "final error under the gain table",
    "scheduled_error_over_fixed": "final error under the gain table, over that under a fixed PD",
    "promised_time_deviation": "what promised and simulated times to 1 % differ by",
    "ladder_regret_error": "final error under the gain table over that of gains for one move alone, the worst of all moves",
    "ladder_regret_time": "time under the gain table over that of gains for one move alone, the worst of all moves",
    "ladder_overshoot": "largest overshoot under the gain table over all moves",
    "recommended_error_counts": "final error under the recommended controller, in encoder counts",
    "recommended_share_beyond": "share of all such axes that exceed the error limit under the recommended controller, at most",
    "compensation_following_ratio": "following error without over that with compensation",
    "reproduction_met": "printed numbers that were had again",
    "reproduction_unexplained": "printed numbers that were missed without a reason",
}
OF = {  # beginnings of such figures, of which there is one for each controller
    "limit_cycle_wrong_": "cases in which harmonic balance is wrong about a limit cycle under {}",
    "limit_cycle_frequency_error_": "frequency of limit cycles under {}, predicted off simulated",
    "share_beyond_final_error_": "share of all such axes that exceed the error limit under {}, at most",
    "share_beyond_time_1pct_": "share of all such axes that exceed the time limit under {}, at most",
    "share_beyond_overshoot_": "share of all such axes that exceed the overshoot limit under {}, at most",
}
PLAIN = {
    "nothing_missing": "nothing is missing",
    "cause": "an effect is missing",
    "unknown": "something unknown is missing",
}


def in_words(name: str, own: dict[str, str] | None = None) -> str:
    """Return what a figure is called; its name without underscores where nobody said."""
    name = name.replace(" ", "_")
    of_one = next((t.format(_controller(name.removeprefix(k))) for k, t in OF.items() if name.startswith(k)), None)
    return (own or {}).get(name) or WORDS.get(name) or of_one or name.replace("_", " ")


def _controller(slug: str) -> str:
    """Return the name of a controller, of which a figure's name has the letters and digits."""
    return re.sub(r"\b(pd|pi|pid)\b", lambda m: m[0].upper(), slug.replace("_", " "))


def judged(checks: Sequence[Check]) -> str:
    """Return one sentence on the requirements."""
    failed = [c.called for c in checks if not c.passed]
    if not failed:
        return (
            f"All {len(checks)} requirements of the study hold."
            if len(checks) > 1
            else "The study's requirement holds."
        )
    verb = "does" if len(failed) == 1 else "do"
    return f"{len(failed)} of {len(checks)} requirements {verb} not hold: {listed(failed)}."


def required(result: StudyResult) -> Chapter | None:
    """Every requirement with its value and bound; None where the study states none."""
    if not result.checks:
        return None
    failed = sum(not c.passed for c in result.checks)
    text = (
        f"What was required is reached in {'all' if not failed else len(result.checks) - failed} of {len(result.checks)} points; a "
        "point that fails ends the command with exit code 1."
    )
    rows = tuple(
        (
            c.called,
            _value(c.value),
            _value(c.bound) if isinstance(c.value, str) else bound(c.bound),
            numbers.unit(c.unit),
            Marked("passed", GOOD) if c.passed else Marked("failed", BAD),
        )
        for c in result.checks
    )
    table = Table(("requirement", "value", "bound", "unit", "result"), rows, "Requirements of the study.", "pwwll")
    return Chapter("Does it reach what was required?", (Paragraph(text), table))


def _value(value: float | str) -> str:
    if isinstance(value, str):
        return PLAIN.get(value, value.replace("_", " "))
    return numbers.count(int(value)) if float(value).is_integer() else numbers.number(value)

"""What is said of gains and what they are worth: who beats whom, which to take, and why a campaign's loop is not closed."""

from collections.abc import Sequence

import numpy as np

from workbench.finding import Finding
from workbench.verification import compare, contest
from workbench.verification.candidates import GRID_OVERSHOOT, Candidate
from workbench.verification.compare import Comparison, Row
from workbench.verification.contest import Contest

COMPARISON = "comparison"


def not_closed(why: str) -> str:
    """Return that the loop of a campaign is not closed. why: ends the sentence."""
    return f"The loop is not closed: {why}"


NO_RECORD = not_closed("the campaign has no record to take a motion from.")
NO_INERTIA = not_closed("the declared model has no inertia, so no gains can be tuned for it.")
NO_LIMIT = not_closed(
    "the campaign states no limit of the drive, and without one the fastest gains are infinite; state actuator_limit (and "
    "speed_limit) in campaign.toml."
)


def ms(seconds: float) -> str:
    return f"{1e3 * seconds:.1f} ms" if np.isfinite(seconds) else "never"


def _micro(value: float) -> str:
    value = 1e6 * value
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def _words(time: int, error: int) -> str:
    """How two comparisons are said: "faster but less accurate"."""
    fast = {1: "faster", 0: "as fast", -1: "slower"}[time]
    exact = {1: "more accurate", 0: "as accurate", -1: "less accurate"}[error]
    return f"{fast} {'but' if time * error < 0 or (time == 0 and error < 0) else 'and'} {exact}"


def verdicts(comparison: Comparison, ours: str, baselines: Sequence[str], unit: str) -> Comparison:
    """Return the comparison with a finding for each baseline and load: where `ours` is better, equal or worse.

    unit: of position, "rad" or "m".
    """
    loads = dict.fromkeys(r.load_inertia for r in comparison.rows)
    pairs = [(comparison.row(ours, load), comparison.row(name, load)) for load in loads for name in baselines]
    return Comparison(comparison.rows, tuple(_against(mine, other, unit) for mine, other in pairs))


def _against(mine: Row, other: Row, unit: str) -> Finding:
    """Say what a controller is beside another one under the same load."""
    where = "with the load" if mine.load_inertia else "without load"
    return Finding(
        COMPARISON, f"{mine.controller} against {other.controller}",
        f"Against {other.controller} {where}, {mine.controller} is {_words(*compare.sides(mine, other))}: 1 % time "
        f"{ms(mine.time_1pct)} against {ms(other.time_1pct)}, final error {_micro(mine.final_error)} against "
        f"{_micro(other.final_error)} µ{unit} ({mine.error_counts:.1f} against {other.error_counts:.1f} counts).",
        {
            "time": mine.time_1pct,
            "time_other": other.time_1pct,
            "error": mine.final_error,
            "error_other": other.final_error,
        },
    )  # fmt: skip


def verdict(found: Contest, ours: str, baseline: str, unit: str) -> Finding:
    """Return a sentence on where `ours` is better, equal or worse than a baseline, nominally and over the grid.

    unit: of position, "rad" or "m".
    """
    mine, other = found[ours], found[baseline]
    parts, evidence = [], {}
    for where, said in (("", "on the nominal plant"), ("_grid", "over the grid")):
        numbers = [s.median(f"{n}{where}") for n in ("time", "error") for s in (mine, other)]
        parts.append(
            f"{said} {_words(*contest.sides(mine, other, where))} (1 % time {ms(numbers[0])} against {ms(numbers[1])}, final error "
            f"{_micro(numbers[2])} against {_micro(numbers[3])} µ{unit})"
        )
        evidence |= dict(
            zip((f"time{where}", f"time{where}_other", f"error{where}", f"error{where}_other"), numbers, strict=True)
        )
    sentence = f"Against {baseline}, {ours} is {' and '.join(parts)}."
    return Finding(COMPARISON, f"{ours} against {baseline}", sentence, evidence)


def recommendation(rows: Sequence[Candidate], unit: str) -> str:
    """Say which to take and why, against the next."""

    def micro(value: float) -> str:
        return f"{1e6 * value:.3g} µ{unit}"

    one = rows[0]
    if not one.allowed:
        return (
            f"No controller keeps an overshoot of {GRID_OVERSHOOT:.1%} over half to one and a half times inertia and friction; "
            f"{one.name} comes nearest, with {one.overshoot_grid:.1%}."
        )
    text = (
        f"Take {one.name}: a 1 % time of {1e3 * one.time:.1f} ms and an error of {micro(one.error)} on the nominal plant, "
        f"{1e3 * one.time_grid:.1f} ms and {micro(one.error_grid)} in the worst case of half to one and a half times inertia and "
        f"friction, at Ms = {one.sensitivity:.2f}."
    )
    others = [r for r in rows[1:] if r.allowed]
    if others:
        r = others[0]
        text += (
            f" {r.name[0].upper()}{r.name[1:]} comes next, with {1e3 * r.time:.1f} ms and {micro(r.error)}, in the worst case "
            f"{1e3 * r.time_grid:.1f} ms and {micro(r.error_grid)}."
        )
    return text

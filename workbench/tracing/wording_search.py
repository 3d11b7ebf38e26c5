"""What is said on the way to a verdict: of each candidate, of rest that does not count, of counts put back, of waves and of laws nearly right.

What it comes to in the end is said in `wording`, the verdict itself in `headline`.
"""

from collections.abc import Sequence
from dataclasses import replace

from workbench.encoders.lost_counts import LostCounts
from workbench.encoders.wording import lost_finding
from workbench.finding import Finding, capital, in_per_cent, title

SLOW = "slow log"
STICKS = "sticks"

# --- candidates ------------------------------------------------------------------------------------------------------


def no_value(effect: str) -> str:
    """Return that a candidate has no value on the records."""
    return f"{capital(title(effect))} has no value on these records."


def too_short(counts: float, block: float, fewest: int) -> str:
    """What is said where records are too short to be judged on what was not fitted. counts: seconds of them that do, block: of one stretch."""
    return (
        f"the identification records are too short for a trace: {counts:.2g} s of them count, their ends left out; {fewest} stretches of "
        f"{block:.2g} s are needed, by which an effect is judged on what was not fitted. Record for longer, or state a higher "
        "evaluation_bandwidth where the drive holds one."
    )


def gained(effect: str, correction: bool, gain: float, scatter: float) -> str:
    """Return what a candidate takes away of the held-out residual power. scatter: one standard error of that share."""
    what = f"{'Correcting the declared' if correction else 'Adding'} {title(effect)}"
    if gain > 0:
        return f"{what} takes away {100 * gain:.1f} % of the held-out residual power (standard error {100 * scatter:.1f} %)."
    return f"{what} explains nothing on held-out blocks."


def nearly_right(effect: str, at: str, before: float, after: float) -> str:
    """Return what a free virgin curve in the place of a declared law is worth: errors on identification, nrmse."""
    return (
        f"The declared law of {effect.replace('_', ' ')} at the {at} is only nearly right: with a free virgin curve in its place "
        f"the identification error goes from {100 * before:.2f} % to {100 * after:.2f} %."
    )


# --- records ---------------------------------------------------------------------------------------------------------


def turns_between(rate: float, times: int, before: float, after: float) -> Finding:
    """Say that friction turns between the samples of a slow log. rate: Hz; before, after: shares of the drive's rms, filtered."""
    return Finding(
        SLOW, "",
        f"The log of {rate:.4g} Hz is slow for its band: friction turns between its samples. Read {times} times as often along the path "
        f"between them, the declared laws leave {100 * after:.2f} instead of {100 * before:.2f} % of the drive on identification.",
        {"rate": rate, "times": times, "before": before, "after": after},
        "Log at sixteen times the evaluation bandwidth or more, where the drive can.",
    )  # fmt: skip


def sticks(samples: float, power: float, beside: bool) -> Finding:
    """Say that rest does not count. samples, power: shares of the samples and of the residual. beside: as of `Sticking`."""
    return Finding(
        STICKS, "",
        f"While the axis sticks, its declared dry friction has no prediction: that is {100 * power:.0f} % of what the declared "
        f"model {'and what was found beside it leave' if beside else 'leaves'}, in {in_per_cent(samples)} of the samples. "
        "They count in no error here.",
        {"samples": samples, "power": power},
        "Declare presliding_hysteresis in the place of coulomb_friction where the encoder shows how the axis gives way.",
    )  # fmt: skip


def put_back(lost: LostCounts, role: str, before: float, after: float, size: float) -> Finding:
    """Say what an encoder lost, with the errors of the declared model without and with it, in % of the drive. size: over the drive's rms."""
    said = lost_finding(lost)
    back = (
        f"With them put back, the declared model leaves {after:.2f} % of the drive on {role} instead of {before:.2f} %."
    )
    return replace(said, sentence=f"{said.sentence} {back}", evidence={**said.evidence, "share": size})


# --- waves -----------------------------------------------------------------------------------------------------------


def phase_shown(record: str, phase: float, half: float) -> str:
    """Return a phase on one record with half of its interval, both in rad."""
    return f"{phase:.2f} ± {half:.2f} rad on {record}"


def phases_sentence(effect: str, shown: Sequence[str], differs: bool, identified: float, calibrated: float) -> str:
    """Return why a wave does not carry over. shown: its phase on each record. identified, calibrated: errors on validation, nrmse."""
    known = "; ".join(shown)
    if not differs:
        return f"{capital(title(effect))} does not carry over, and not for its phase: that is {known}. It is not to be used."
    return (
        f"The phase of {title(effect)} is {known}: it belongs to one power-up. With amplitude and phase found anew, "
        f"the validation error is {100 * calibrated:.2f} % instead of {100 * identified:.2f} %. Calibrate it at "
        "each power-up, by an index pulse or a slow motion over one period; until then it is better left out, as it is in the "
        "predictions of validation records that it would make worse."
    )

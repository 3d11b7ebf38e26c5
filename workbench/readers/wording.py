"""What is said of what was read: samples that were put elsewhere, units and clocks that do not agree, scales that are guesses."""

from collections.abc import Sequence

from workbench.finding import ASSUMED_SCALE, CUT, OTHER_UNIT, RESAMPLED, START_TIME, Finding

NAMED = 4  # columns that a sentence names one by one


def resampled(name: str, step: float, off: int, steps: int, gap: float, missing: int) -> Finding:
    """Say that a record was resampled. step: s, median. off: of so many steps, those that were not near it. gap: s, the longest. missing: gaps of
    a sample or more."""
    sentence = (
        f"Record '{name}' was resampled to {1 / step:.6g} Hz by straight lines, since {off} of {steps} time steps "
        f"were more than 1 % off the median; the longest was {gap:.6g} s."
    )
    if missing:
        sentence += (
            f" What the axis did in its {missing} {'gap' if missing == 1 else 'gaps'} is not known: no error counts about one that is long beside a "
            "period of the evaluation band's edge."
        )
    evidence = {"steps_off": float(off), "steps": float(steps), "longest_gap": gap, "step": step}
    return Finding(RESAMPLED, name, sentence, evidence, "Log at one rate, with the clock of the drive.")


def cut(name: str, parts: Sequence[str], left_out: int, gap: float, step: float) -> Finding:
    """Say that a record was cut at gaps in its samples. parts: names of what it became. left_out: samples in none of them. gap: s, the longest; step: s,
    the median."""
    sentence = (
        f"Record '{name}' has gaps of up to {gap:.6g} s in its samples, {gap / step:.0f} median steps, and was cut there: it is read as "
        + (f"'{parts[0]}' alone" if len(parts) == 1 else f"the records {', '.join(parts)}")
        + (f", and {left_out} samples between gaps are left out." if left_out else ".")
    )
    evidence = {"records": float(len(parts)), "left_out": float(left_out), "longest_gap": gap, "step": step}
    return Finding(CUT, name, sentence, evidence, "Log without gaps, or cut the record by 'from' and 'until'.")


def noted(name: str, note: str) -> Finding:
    """Say what a reader noted of a record's file on the way in."""
    return Finding(RESAMPLED, name, f"In record '{name}' {note}")


def put_on_one(others: Sequence[str], first: str, rate: float) -> str:
    """Return what was done to columns with instants of their own. first: the column at whose instants, at `rate` Hz, they are now."""
    named = ", ".join(f"'{n}'" for n in others[:NAMED]) + (", ..." if len(others) > NAMED else "")
    what = "was" if len(others) == 1 else "were"
    return f"{named} {what} not sampled at the instants of '{first}' ({rate:.6g} Hz), and {what} put there by straight lines."


def own_clock(name: str, start: float) -> Finding:
    """Say that a record whose own clock begins at zero was put where it is declared to start, s."""
    sentence = f"Record '{name}' counts its time from zero and is declared to start at {start:g} s: that much was added to its time."
    return Finding(
        START_TIME,
        name,
        sentence,
        {"declared": start, "measured": 0.0},
        "Log the clock of the bench, or mend start_time_s.",
    )


def other_clock(name: str, declared: float, measured: float) -> Finding:
    """Say that a record starts at another time, s, than is declared."""
    sentence = f"Record '{name}' is declared to start at {declared:g} s, and its time starts at {measured:g} s; the latter is used."
    evidence = {"declared": declared, "measured": measured}
    return Finding(START_TIME, name, sentence, evidence, "Log the clock of the bench, or mend start_time_s.")


def other_unit(record: str, column: str, unit: str, declared: str) -> Finding:
    """Say that a file states another unit than is declared for a column."""
    return Finding(
        OTHER_UNIT,
        record,
        f"Record '{record}' states column '{column}' in '{unit}', and it is declared in '{declared}'; the latter is used.",
        remedy="Mend the unit of this channel in campaign.toml, or export the record again.",
    )


def assumed_scale(name: str, column: str, unit: str, si: str, factor: float) -> Finding:
    """Say that a channel's scale is a guess: figures in torque or angle are only as right as this number."""
    return Finding(
        ASSUMED_SCALE, name,
        f"The scale of channel '{name}' (column '{column}', '{unit}' to '{si}') is assumed, not known.",
        {"factor": factor},
        f"Put the data sheet's number into channels.{name}.scale of campaign.toml, or the right unit beside it, and remove 'assumed'.",
    )  # fmt: skip


def without(name: str, channel: str, column: str) -> Finding:
    """Say that a record lacks a column that others of its campaign have, and goes without."""
    sentence = f"Record '{name}' has no column '{column}': it is read without the channel '{channel}'."
    return Finding("channel left out", name, sentence, remedy=f"Log '{column}' in every record, where there is one.")

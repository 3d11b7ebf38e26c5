"""What is said of what is wrong with records: one sentence for each kind of fault, and what would mend it."""

from dataclasses import replace
from functools import singledispatch
from math import inf

from workbench.checking import wording_scales
from workbench.checking.alignment import Apart, LateDrive
from workbench.checking.channels import Clipped, ClippedDrive, Frozen, Leaping
from workbench.checking.clocks import Skewed
from workbench.checking.excitation import NoValue
from workbench.checking.glitches import Glitch
from workbench.checking.modes import Undeclared
from workbench.checking.sampling import FINE, Coarse, Short, Slow
from workbench.checking.shift import LATE
from workbench.encoders.lost_counts import LostCounts
from workbench.encoders.wording import late_sentence, lost_finding
from workbench.finding import ENCODER_RESOLUTION, GLITCH, JITTER, MODE, SAMPLING_RATE, Finding
from workbench.frequency.wording import decibels
from workbench.identification.excitation import Unexcited
from workbench.identification.wording import unexcited

DROPPED, MISALIGNED, CLIPPED = "dropped samples", "misaligned", "clipped"
LACKS = 1.5  # median time steps, from which on a sample is missing: a microcontroller's stamps jitter by a few per cent of one
UNREADABLE = "Mend this first: nothing else could be checked."


@singledispatch
def said(fault) -> Finding:
    """Return what a person reads of a fault, of whatever kind; its subject begins with the record that it is of."""
    raise TypeError(f"nothing is worded of a {type(fault).__name__}.")


def resampled(found: Finding) -> Finding:
    """Return what reading said of samples that are missing by the time channel, or of stamps that jitter and lack none; what lies between is
    interpolated, so that the record may serve."""
    jitters = found.evidence.get("longest_gap", inf) < LACKS * found.evidence.get("step", 0.0)
    return replace(found, kind=JITTER if jitters else DROPPED)


# --- time axes -------------------------------------------------------------------------------------------------------


@said.register
def _(fault: LateDrive) -> Finding:
    return Finding(
        MISALIGNED, f"{fault.record}.{fault.channel}",
        f"In record '{fault.record}' the drive stands {1e3 * abs(fault.late):.1f} ms {_order(fault.late)} the motion that it causes; "
        f"a drive itself is late by less than {1e3 * LATE:g} ms.",
        {"late": fault.late},
        "Log all channels in one task, or shift the drive's column by this time.",
    )  # fmt: skip


@said.register
def _(fault: Apart) -> Finding:
    why = "no axis moves before it is told to" if fault.other == "reference" else "the joint carries motion at once"
    return Finding(
        MISALIGNED, f"{fault.record}.{fault.channel}",
        f"In record '{fault.record}' {fault.channel} stands {1e3 * abs(fault.late):.1f} ms {_order(fault.late)} {fault.other}, and {why}.",
        {"late": fault.late},
        "Log all channels in one task, or shift this column by this time.",
    )  # fmt: skip


def _order(late: float) -> str:
    return "after" if late > 0 else "before"


@said.register
def _(fault: Skewed) -> Finding:
    late, s, d = fault.late, fault.late.seconds, fault.late.measured
    return Finding(
        "clock skew", f"{fault.record}.{late.channel}".removeprefix("."), late_sentence(late),
        {"late": s.value, "low": s.low, "high": s.high, "share": d.share, "drift": d.gains, "by_motor": d.by_motor},
        f"Log both encoders in one task, or declare {late.law} at sensor.{late.channel} with offset = "
        f"{1e3 * late.values['offset']:.3g} ms; not undone, it makes hysteresis and damping of the joint too large.",
    )  # fmt: skip


@said.register
def _(fault: Slow) -> Finding:
    return Finding(
        SAMPLING_RATE, f"{fault.record}.time",
        f"Record '{fault.record}' is sampled at {fault.rate:.4g} Hz; an evaluation bandwidth of "
        f"{fault.bandwidth:g} Hz needs {fault.needed:g} Hz, since motion is filtered at twice the bandwidth.",
        {"rate": fault.rate, "needed": fault.needed},
        f"Log faster, or set evaluation_bandwidth to {fault.enough:.3g} Hz.",
    )  # fmt: skip


@said.register
def _(fault: Short) -> Finding:
    return Finding(
        SAMPLING_RATE, f"{fault.record}.time",
        f"Record '{fault.record}' lasts {fault.seconds:.3g} s at {fault.rate:.4g} Hz; {fault.needed:.3g} s are needed to see "
        f"{fault.bandwidth:g} Hz.",
        {"seconds": fault.seconds, "rate": fault.rate},
        "Check the unit of the time channel; else record for longer.",
    )  # fmt: skip


# --- samples of one channel ------------------------------------------------------------------------------------------


@said.register
def _(fault: Leaping) -> Finding:
    return Finding(
        DROPPED, f"{fault.record}.{fault.channel}",
        f"In record '{fault.record}' {fault.channel} leaps at {fault.leaps} samples by more than its speed before and after, "
        f"first at {fault.at:.3f} s: samples are missing, and the time channel does not show it.",
        {"leaps": float(fault.leaps)},
        "Log the time with each sample, and record again with a larger buffer.",
    )  # fmt: skip


@said.register
def _(fault: Frozen) -> Finding:
    whole = "from its first to its last sample"
    when = whole if fault.at is None else f"from {fault.at:.3f} s on, while the axis moves"
    return Finding(
        "frozen", f"{fault.record}.{fault.channel}",
        f"In record '{fault.record}' {fault.channel} does not change for {1e3 * fault.seconds:.0f} ms {when}.",
        {"seconds": fault.seconds},
        "Check the cable and the logger's buffer, and record again.",
    )  # fmt: skip


@said.register
def _(fault: Clipped) -> Finding:
    return Finding(
        CLIPPED, f"{fault.record}.{fault.channel}",
        f"In record '{fault.record}' {fault.channel} stands at an end of its range ({fault.lowest:.4g} to {fault.highest:.4g} "
        f"{fault.unit}) for {fault.samples} samples, and stops there more abruptly than the drive can stop it.",
        {"samples": float(fault.samples), "lowest": fault.lowest, "highest": fault.highest},
        "Widen the range of this channel in the logger, or move less far.",
    )  # fmt: skip


@said.register
def _(fault: ClippedDrive) -> Finding:
    return Finding(
        CLIPPED, f"{fault.record}.{fault.channel}",
        f"In record '{fault.record}' {fault.channel} has exactly its {fault.end} value, {fault.value:.4g} {fault.unit}, for "
        f"{fault.samples} samples in {fault.runs} runs: its range ends there.",
        {"value": fault.value, "samples": float(fault.samples), "runs": float(fault.runs)},
        "Widen the range of this channel in the logger; where this is the drive's own limit, declare actuator_limit.",
    )  # fmt: skip


@said.register
def _(fault: Glitch) -> Finding:
    name, channel, unit, (first, *others) = fault.record, fault.channel, fault.unit, fault.samples
    further = f" So are samples {', '.join(str(s + 1) for s in others)}." if others else ""
    why = "the axis did not feel it" if fault.drive else "no drive moves an axis there and back"
    return Finding(
        GLITCH, f"{name}.{channel}",
        f"In record '{name}' sample {first + 1} of {channel} (at {fault.time:.4f} s) is {fault.value:.6g} {unit}, between neighbours at "
        f"{fault.beside:.6g} {unit}: a glitch of one sample, for {why}.{further}",
        {"sample": float(first + 1), "time": fault.time, "value": fault.value, "beside": fault.beside},
        "Take the sample out of the record (the time step is then uneven: allow resample), and look for what disturbed it.",
    )  # fmt: skip


@said.register
def _(fault: LostCounts) -> Finding:
    return lost_finding(fault)


# --- signs and scales: `wording_scales` ------------------------------------------------------------------------------

for kind, sentence_of in wording_scales.SAID.items():
    said.register(kind, sentence_of)


# --- what a plant declares -------------------------------------------------------------------------------------------


@said.register
def _(fault: Coarse) -> Finding:
    e = fault.effect
    return Finding(
        ENCODER_RESOLUTION, e.key,
        f"{e.name} at {e.at} builds up over {fault.stroke:.3g} {fault.unit}, which is {fault.stroke / fault.resolution:.2g} counts "
        f"of {fault.channel}; {FINE} are needed to see it.",
        {"stroke": fault.stroke, "resolution": fault.resolution},
        "Use the finer encoder, interpolate it, or declare coulomb_friction in its place.",
    )  # fmt: skip


@said.register
def _(fault: NoValue) -> Finding:
    sentence = "An effect of the declared plant has no value on these records."
    return Finding("no value", "plant", sentence, {}, "Check the declared parameters and their units.")


@said.register
def _(fault: Unexcited) -> Finding:
    return unexcited(fault, "noise")


@said.register
def _(fault: Undeclared) -> Finding:
    m = fault.mode
    return Finding(
        MODE, f"{fault.record}.position",
        f"Record '{fault.record}' shows a mode at {m.frequency:.3g} Hz (damping ratio {m.damping:.2g}, "
        f"{decibels(m.rise):.0f} dB above the rest), which the declared single mass does not have.",
        {"frequency": m.frequency, "damping": m.damping, "rise": m.rise},
        f"Declare a flexible_mode or two masses, or set evaluation_bandwidth below {0.5 * m.frequency:.2g} Hz.",
    )  # fmt: skip

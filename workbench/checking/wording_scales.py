"""What is said of signs and scales that are wrong."""

from workbench.checking.misreading import DRIVE, ENCODER, TIME, Misread
from workbench.checking.scale import Farther, OtherStep, OwnScale
from workbench.checking.sign import Against, Slope
from workbench.finding import Finding

REMEDY = {
    DRIVE: "Check the torque constant, the gear ratio and the unit of the drive's channel.",
    ENCODER: "Check the unit of the encoder's channel, its counts a revolution and the gear ratio.",
    TIME: "Check the unit of the time channel and the rate at which was logged.",
}


def _encoder_sign(fault: Slope) -> Finding:
    return Finding(
        "encoder sign", f"{fault.record}.{fault.channel}",
        f"In record '{fault.record}' {fault.channel} moves against {fault.other}: slope {fault.slope:.3g}, correlation "
        f"{fault.correlation:.4f}.",
        {"slope": fault.slope, "correlation": fault.correlation},
        f"Turn the sign of {fault.channel}: {_minus(fault.channel)}.",
    )  # fmt: skip


def _drive_sign(fault: Against) -> Finding:
    return Finding(
        "drive sign", f"{fault.record}.{fault.channel}",
        f"In record '{fault.record}' inertia and friction explain {100 * max(fault.as_it_stands, 0):.0f} % of the drive as it "
        f"stands and {100 * fault.turned:.0f} % when its sign is turned: it counts against the position.",
        {"as_it_stands": fault.as_it_stands, "turned": fault.turned},
        f"Turn the sign of the drive, or of the encoder: {_minus(fault.channel)}.",
    )  # fmt: skip


def _minus(channel: str) -> str:
    """Say where a channel's sign is turned."""
    where = f"channels.{channel}.scale"
    return f'put a minus before the value of {where}, or, where there is none, write {where} = {{ value = -1, unit = "1" }}'


def _farther(fault: Farther) -> Finding:
    sentence = f"In record '{fault.record}' {fault.channel} moves {fault.factor:.4g} times as far as {fault.other}."
    return Finding(ENCODER, f"{fault.record}.{fault.channel}", sentence, {"factor": fault.factor}, REMEDY[ENCODER])


def _other_step(fault: OtherStep) -> Finding:
    return Finding(
        ENCODER, f"{fault.record}.{fault.channel}",
        f"In record '{fault.record}' {fault.channel} moves in steps of {fault.step:.3g} {fault.unit}, {fault.step / fault.declared:.3g} "
        f"times the declared resolution of {fault.declared:.3g} {fault.unit}.",
        {"step": fault.step, "declared": fault.declared},
        f"{REMEDY[ENCODER]} Or else mend its resolution.",
    )  # fmt: skip


def _own_scale(fault: OwnScale) -> Finding:
    return Finding(
        DRIVE, f"{fault.record}.{fault.channel}",
        f"In record '{fault.record}' the drive is {fault.factor:.3g} times what the other records ask for the same motion.",
        {"factor": fault.factor},
        REMEDY[DRIVE],
    )  # fmt: skip


def _misread(fault: Misread) -> Finding:
    fitted, declared, factor, unit = fault.fitted, fault.declared, fault.factor, fault.unit
    return Finding(
        fault.kind, fault.channel,
        f"The drive accelerates an inertia of {fitted:.3g} {unit}, and {declared:.3g} {unit} is declared; this is as if "
        f"the {fault.kind.split()[0]} were read {max(factor, 1 / factor):.3g} times too {'large' if factor > 1 else 'small'}.",
        {"fitted": fitted, "declared": declared, "factor": factor},
        f"{REMEDY[fault.kind]} Or else the declared inertia is wrong.",
    )  # fmt: skip


SAID = {
    Slope: _encoder_sign,
    Against: _drive_sign,
    Farther: _farther,
    OtherStep: _other_step,
    OwnScale: _own_scale,
    Misread: _misread,
}

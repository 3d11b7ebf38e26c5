"""Whether one of two encoders is plainly late, by the angle between them."""

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.definition import catalogue
from workbench.encoders.blocks import Interval
from workbench.encoders.deflection import Deflection, deflection_of
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant

# Of the squared angle that friction and hysteresis leave on held-out blocks, what lateness must take to be plain: more than
# all else that is left. Sound records give less than 0.02, late ones more than 0.9: 0.25 and 0.75 decide alike.
PLAIN = 0.5
# Of the drive's rms, the torque by which lateness would wind the joint: what is worth less is no cause but a refinement. Half
# or twice of it names lateness half or twice as large.
WORTH = 0.005
# Factor within which every record that can tell must say the same. At 1.4 records of a drifting temperature part, at 4 one
# record may be four times as late as another.
AGREE = 2.0
# Error of the drive's balance on the load's clock, over that on the motor's, from which down it is the motor's that is late.
# Where the drive cannot tell it is near one (0.98 to 1.06), where it can below 0.6 or above 1.5: 0.35 asks for a drive without
# noise, 1.4 would take the load's clock for the motor's wherever the drive cannot tell.
MOTORS = 0.7
CLOCKS = "clock_skew", "restarted_clock"  # that run on from record to record; and that are set anew where each begins


@dataclass(frozen=True)
class Late:
    """One of two encoders that is late: its channel, by how many s in the middle of the records, and by the angle."""

    channel: str
    seconds: Interval
    measured: Deflection

    @property
    def law(self) -> str:
        """Name of the effect that this clock is."""
        return CLOCKS[self.measured.restarted]

    @property
    def values(self) -> dict[str, float]:
        """Parameters of the clock: offset in s at t = 0, or where a record begins, skew in s a second, zero where no drift is plain."""
        sign = 1.0 if self.channel == "load_position" else -1.0
        return {"offset": sign * self.measured.start, "skew": sign * self.measured.gains}


def plain(d: Deflection, share: float = PLAIN, worth: float = WORTH) -> bool:
    """Whether lateness is plain: beyond what friction could pass for, most of what is left of the angle, worth a torque, and
    said by every record that can tell."""
    if not (d.late.sure or d.gains) or d.share < share or d.worth < worth:
        return False
    able = [r for r in d.records.values() if r.high - r.low < abs(r.value)]
    return not d.late.sure or all(1.0 / AGREE < r.value / d.late.value < AGREE for r in able)


def _with_weight(plant: Plant) -> Plant:
    """Return the plant with a force at the load that goes with its position: a weight, or along a straight line a spring.

    Nobody may have declared it. It goes with the acceleration of a swing, so without it the inertia that the angle tells is too small, and
    with that what viscous friction behind the joint may be: a gimbal out of balance had a clock of 0.12 ms that it did not have.
    """
    weight = catalogue()["gravity" if plant.rotary else "cable_spring"](at="load")
    return plant if weight.key in {e.key for e in plant.effects} else plant + weight


def _with_friction(plant: Plant) -> Plant:
    """Return the plant with dry friction at the motor. Without it the drive's balance gives the joint a torque that turns with the direction, which
    hides what is late: a robot's joint, 2.8 ms late, was 34 ms early where nobody had declared its friction."""
    dry = catalogue()["coulomb_friction"](at="motor")
    there = any(e.at == "motor" and {"dir"} & {*e.reads, *e.provides} for e in plant.effects)
    return plant if there else plant + dry


def late_clock(
    inverses: Sequence[InverseDynamics], plant: Plant, share: float = PLAIN, worth: float = WORTH
) -> Late | None:
    """Return which encoder is late, None where neither plainly is, or a clock is declared.

    It is the load's, unless the drive's balance says plainly that drive and load share a clock. share, worth: see PLAIN, WORTH.
    """
    if any(e.name in CLOCKS for e in plant.effects):
        return None
    d = deflection_of(inverses, plant)
    if d is None:
        return None
    if not plain(d, share, worth) and (rubbing := _with_friction(plant)) is not plant:
        plant, d = rubbing, deflection_of(inverses, rubbing)
    if d is None or not plain(d, share, worth):
        return None
    weighted = _with_weight(plant)
    if weighted is not plant and not plain(deflection_of(inverses, weighted) or d, share, worth):
        return None
    if d.by_motor < MOTORS:
        return Late("position", Interval(-d.late.value, -d.late.high, -d.late.low), d)
    return Late("load_position", d.late, d)

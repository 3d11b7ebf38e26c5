"""A clock that is late between two encoders, judged in their angle before anything in torque.

In torque a late encoder looks like hysteresis and damping of a joint, and a fit that cannot undo it lets the joint carry
nothing. In the angle it is plain: see `identify.deflection`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.effect import catalogue
from workbench.identify.deflection import Deflection, deflection_of
from workbench.identify.fit import fitted_on
from workbench.identify.passes import Passes
from workbench.plant import Plant
from workbench.trace.candidates import ADDITION, Suspect

# Of the squared angle that friction and hysteresis leave on held-out blocks, what lateness must take to be plain: more than
# all else that is left. Sound records give less than 0.02, late ones more than 0.9: a half or (towards 1) a double decide alike.
PLAIN = 0.5
# Of the drive's rms, the torque by which lateness would wind the joint: less is no cause but a refinement. Half or twice of
# it shifts by a factor of two how small a lateness is named.
WORTH = 0.005
AGREE = 2.0  # factor within which every record that can tell must say the same: 4 lets a record say a quarter, 1.4 few differ
MOTORS = 0.7  # error of the drive's balance on the load's clock over that on the motor's, below which it is the motor's that is late


@dataclass(frozen=True, eq=False)
class Skew:
    """A plain lateness: of which channel, what the angle says of it, and the suspect that brings it, with its value."""

    channel: str
    measured: Deflection
    suspect: Suspect

    @property
    def seconds(self) -> tuple[float, float, float]:
        """Value and 95 % interval in s."""
        late = self.measured.late
        return (
            (late.value, late.low, late.high)
            if self.channel == "load_position"
            else (-late.value, -late.high, -late.low)
        )

    @property
    def sentence(self) -> str:
        value, low, high = (1e3 * s for s in self.seconds)
        return (
            f"{self.channel} is read {abs(value):.3g} ms {'late' if value > 0 else 'early'} (95 % interval {low:.3g} to {high:.3g}): "
            f"of what the joint leaves of the angle between the two encoders on held-out blocks, that takes "
            f"{100 * self.measured.share:.0f} %."
        )


def plain(d: Deflection) -> bool:
    """Whether a lateness is plain: outside of what friction could pass for, most of what is left of the angle, worth a torque,
    and said by every record that can tell."""
    if not (d.late.sure or d.gains) or d.share < PLAIN or d.worth < WORTH:
        return False
    able = [r for r in d.records.values() if r.high - r.low < abs(r.value)]
    return all(1.0 / AGREE < r.value / d.late.value < AGREE for r in able) if d.late.sure else True


def skew_of(passes: Sequence[Passes], plant: Plant) -> Skew | None:
    """Return the lateness of one of two encoders by the identification records, None where none is plain.

    Also where a clock is declared. It is the load's clock, unless the drive's balance says plainly that drive and load share one.
    """
    if any(e.name == "clock_skew" for e in plant.effects):
        return None
    found = deflection_of(fitted_on(passes), plant)
    if found is None or not plain(found):
        return None
    channel, sign = ("position", -1.0) if found.by_motor < MOTORS else ("load_position", 1.0)
    return Skew(channel, found, suspected(plant, channel, sign * found.start, sign * found.gains))


def suspected(plant: Plant, channel: str, offset: float, skew: float) -> Suspect:
    """Return the suspect of a clock, its values set."""
    clock = catalogue()["clock_skew"](at=f"sensor.{channel}")
    inside = {
        n: min(max(v, clock.parameters[n].lower), clock.parameters[n].upper)
        for n, v in (("offset", offset), ("skew", skew))
    }
    return Suspect(clock.name, clock.at, ADDITION, plant + clock(**inside))

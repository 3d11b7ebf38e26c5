"""What the checks look at: a campaign, and what is dear to compute, once and when it is asked for."""

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property

from workbench.campaign import Campaign
from workbench.checking.balance import Balance, balance, freed
from workbench.checking.shift import delay, realigned
from workbench.finding import RESAMPLED
from workbench.intake.signals import quantum
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.record import Record

ENCODERS = ("position", "load_position")


@dataclass(frozen=True, eq=False)
class Seen:
    """balances: of each record, every linear parameter free. delays: s by which each drive is late in its log."""

    campaign: Campaign

    @cached_property
    def inverses(self) -> tuple[InverseDynamics, ...]:
        return inverse_dynamics(self.campaign.records, self.campaign.bandwidth)

    @cached_property
    def balances(self) -> tuple[Balance, ...]:
        plant = freed(self.campaign.plant)
        return tuple(balance(plant, p) for p in self.inverses)

    @cached_property
    def delays(self) -> tuple[float, ...]:
        return tuple(delay(b, self.inertia) for b in self.balances)

    @cached_property
    def aligned(self) -> tuple[Balance, ...]:
        """The balances with the drive on the time axis of the motion."""
        return tuple(realigned(b, late) for b, late in zip(self.balances, self.delays, strict=True))

    @cached_property
    def steps(self) -> dict[str, float]:
        """Step of each encoder: what its data show, or what is declared where that is larger. 0 where neither is there."""
        found: dict[str, float] = {}
        for r in self.campaign.records:
            for name in ENCODERS:
                if name in r.channels:
                    step = max(r.resolution.get(name, 0.0), quantum(r.channels[name]))
                    found[name] = max(found.get(name, 0.0), step)
        return found

    @property
    def measured(self) -> tuple[Record, ...]:
        """Records whose samples are those that were logged: none were made between them."""
        made = {f.subject for f in self.campaign.findings if f.kind == RESAMPLED}
        return tuple(r for r in self.campaign.records if r.name not in made)

    def only(self, names: Collection[str]) -> "Seen":
        """Return this with the records of these names; what was computed of them is kept."""
        keep = [k for k, r in enumerate(self.campaign.records) if r.name in names]
        if len(keep) == len(self.campaign.records):
            return self
        fewer = Seen(replace(self.campaign, records=tuple(self.campaign.records[k] for k in keep)))
        for name in ("inverses", "balances", "delays", "aligned"):
            if name in self.__dict__:
                fewer.__dict__[name] = tuple(getattr(self, name)[k] for k in keep)
        return fewer

    @property
    def inertia(self) -> str:
        """Name of the inertia that the drive feels first, or "" where none is declared."""
        at = "axis" if "inertia@axis" in self.campaign.plant else "motor"
        return f"inertia@{at}.inertia" if f"inertia@{at}" in self.campaign.plant else ""

    @property
    def drive(self) -> str:
        """Name of the drive's channel."""
        return "torque" if self.campaign.plant.rotary else "force"

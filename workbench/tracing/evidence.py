"""What a verdict rests on: numbers only, as they were measured on the records.

Sizes are rms over the rms of the filtered drive: identification records pooled, or validation records pooled.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from math import copysign, isfinite, sqrt

from workbench.record import IDENTIFICATION, VALIDATION

ADDITION, CORRECTION = "addition", "correction"
KINDS = ("exogenous", "time", "line", "burst", "joint")  # of what is explainable
# The floor bounds noise from below: counts of a coarse encoder at an undamped joint leave 2.3 times it, and by the floor itself that complete
# axis would be "unknown". Of 875 campaigns one is "nothing" with 3 and not with this, whose supply sags: it leaves 14 % of the drive, three floors. Halved,
# no other one changes; doubled, four more are "nothing" that lack what no catalogue has
BOUND = 2.5


@dataclass(frozen=True)
class Explainable:
    """How much of a residual anything could predict out of sample, each kind as a share of the drive's rms.

    exogenous: from what is outside the loop (the reference, its past, place, direction). time: from its neighbours in bench
    time, as a friction, a damping or a mass. line: one spectral line. burst: moments. joint: of two masses, a stiffness of the joint that changes
    along the stroke. frequency: of the line, Hz. instrument: "reference",
    or "low-passed position" where no reference was logged. hum: a line of the mains, at `mains` Hz; it is none of the five kinds, for the
    mains are no law of an axis. inertia: of one mass, an inertia, or a drive's constant, that changes along the stroke, beyond one that is everywhere alike; it is none
    of them either, for other laws of place look like it. gain: a share of the model's own drive that neighbours in bench time predict, of a drive
    whose gain changes slowly; nor is it one, for a damping that changes with speed looks like it. level: a force alone that its neighbours in bench time predict; none of them either, for
    low-frequency noise inside the loop is one.
    """

    exogenous: float = 0.0
    time: float = 0.0
    line: float = 0.0
    burst: float = 0.0
    frequency: float = 0.0
    instrument: str = "reference"
    hum: float = 0.0
    mains: float = 0.0
    joint: float = 0.0
    inertia: float = 0.0
    level: float = 0.0
    gain: float = 0.0

    @property
    def sizes(self) -> tuple[float, ...]:
        """The five kinds, as KINDS names them."""
        return tuple(getattr(self, n) for n in KINDS)

    @property
    def size(self) -> float:
        """The largest of them."""
        return max(self.sizes)

    @property
    def most(self) -> float:
        """The largest of these and of what changes though no effect does: an inertia along the stroke, a drive's gain in bench time."""
        return max(self.size, self.inertia, self.gain)

    @property
    def kind(self) -> str:
        """Which of them is the largest."""
        return max(KINDS, key=lambda n: getattr(self, n))


FORMULA, FREE = "catalogue", "free form"  # laws of an addition: one of the catalogue's formulas, or a curve
MOTOR_ALONE = ("motor", "command", "sensor.torque", "sensor.force")  # places that the load's balance does not hold


@dataclass(frozen=True)
class Weighed:
    """One effect that the search added, or one fixed value that it set free, as whole records have it.

    before, after: nrmse without and with it, the effects before it in place, by role. changed: largest relative change of a
    fixed value, tolerance: what that value may be off by. law: "catalogue", or "free form". implausible: why its values are
    no machine's, "" where they may be. load_before, load_after: of two masses, error of the load's balance over the joint's torque;
    what acts behind the joint shows there, and need not show in the drive. outside, outside_error: its multiplier by what is outside
    the loop, and that one's standard error (`outside.multiplier`). power_up: whether its phase on validation is one of its
    own, with which `after` is then. of_declared: whether it is a memory of the dry
    friction that is declared at its place, or that friction turning over a speed. foretold: what is explainable of what the larger ones leave, asked where it takes less than `held`
    of that (`further.foretold`); infinite where it was not asked. beside_others: what a correction takes beside all others, where any came after it
    (`weighing`); infinite where it was not asked. chosen: whether no blocks of identification make it certain, and validation chose it (`by_validation`).
    """

    effect: str
    at: str
    kind: str
    before: Mapping[str, float]
    after: Mapping[str, float]
    changed: float = 0.0
    tolerance: float = 0.0
    law: str = FORMULA
    implausible: str = ""
    load_before: Mapping[str, float] = field(default_factory=dict)
    load_after: Mapping[str, float] = field(default_factory=dict)
    power_up: bool = False
    of_declared: bool = False
    outside: float = float("nan")
    outside_error: float = float("inf")
    foretold: float = float("inf")
    beside_others: float = float("inf")
    chosen: bool = False

    @property
    def behind(self) -> bool:
        """Whether it shows in the load's balance rather than in the drive. A force at the motor, or what maps its command, enters no
        balance of the load: there it shows by what else is fitted anew."""
        if self.at in MOTOR_ALONE:
            return False
        known = {"identification", "validation"} <= {*self.load_before} & {*self.load_after}
        return known and self._share(self.load_before, self.load_after) > max(0.0, self._share(self.before, self.after))

    def _share(self, before: Mapping[str, float], after: Mapping[str, float], role: str = "identification") -> float:
        return 1.0 - (after[role] / before[role]) ** 2 if before[role] != 0.0 else 0.0

    def errors(self, role: str) -> tuple[float, float]:
        """Return the error before and after in the balance in which it shows most."""
        return self._errors(role, self.behind)

    def size(self, role: str) -> float:
        """Return what it takes away, over the rms of the drive or of the joint's torque, in the balance in which it shows most;
        negative where the error grows, NaN without such a record."""
        return _taken(*self.errors(role))

    def size_where(self, other: "Weighed", role: str) -> float:
        """Return what it takes away in the balance in which another effect shows most, of the drive where it is known of that alone."""
        return _taken(*self._errors(role, other.behind and bool(self.load_before)))

    def order(self, practical: float) -> tuple[float, float]:
        """Return by what causes are ordered: what it takes of the drive on identification where that is at least `practical`, then what it takes
        where it shows most. A load's balance may be small, and most of it a friction that is only nearly right there."""
        drive = self.in_drive(IDENTIFICATION)
        return drive if drive >= practical else 0.0, self.size(IDENTIFICATION)

    def _errors(self, role: str, behind: bool) -> tuple[float, float]:
        before, after = (self.load_before, self.load_after) if behind else (self.before, self.after)
        return before[role], after[role]

    def in_drive(self, role: str) -> float:
        """Return what it takes away over the rms of the drive, wherever it shows most; 0 where the error grows."""
        return sqrt(max(self.before[role] ** 2 - self.after[role] ** 2, 0.0))

    def came_back(self, held: float, errors: float, near: float) -> bool:
        """Whether what is outside the loop bears out less than `held` of what it takes, by so many standard errors: noise that came back through
        the loop looks like a lag or a late clock. Of the drive alone: what shows behind the joint is in the load's balance. Where no reference was
        asked NaN says nothing. What takes `near` of the residual in both roles is no noise: the reference tells little of when an axis sticks."""
        whole = all(self._share(self.before, self.after, r) >= near for r in (IDENTIFICATION, VALIDATION))
        return not (self.behind or whole) and self.outside + errors * self.outside_error < held

    def share(self, role: str, later: Sequence["Weighed"] = ()) -> float:
        """Return the share of the residual's power that it takes away there; later: of what those that came after it leave, as far as that is
        more than what it takes."""
        before, after = self.errors(role)
        taken = before**2 - after**2
        others = sum(max(b.size_where(self, role), 0.0) ** 2 for b in later) if taken > 0.0 else 0.0
        left = before**2 - min(others, after**2)
        return taken / left if left != 0.0 else 0.0


def _taken(before: float, after: float) -> float:
    """Return what is taken away from one error to another one, rms; negative where it grows."""
    less = before**2 - after**2
    return copysign(sqrt(abs(less)), less)


@dataclass(frozen=True)
class Evidence:
    """declared: nrmse of the declared model by role; floor: what noise and counts alone would leave. before, after: what is
    explainable of the declared and of the extended model's residual. added: in the order in which they were found. place_instead:
    whether one place says more of the residual than they do. clock, idle: whether one of two encoders is late, and whether the joint
    then carries nothing. refused: what was tried and not borne out. lost: what an encoder's lost counts take of the drive, which were put back.
    traded: whether what they take of a window of the stroke is paid for with residual elsewhere."""

    declared: Mapping[str, float]
    floor: Mapping[str, float]
    before: Explainable
    after: Explainable
    added: tuple[Weighed, ...] = ()
    place_instead: bool = False
    clock: bool = False
    idle: bool = False
    refused: tuple[Weighed, ...] = ()
    lost: float = 0.0
    traded: bool = False

    @property
    def unaccounted(self) -> float:
        """What the declared model leaves beyond BOUND times the floor, over the drive's rms, in the role in which that is least."""
        return self._beyond(self.declared)

    def left_by(self, a: Weighed) -> float:
        """The same of the model with an addition and those before it."""
        return self._beyond(a.after)

    def _beyond(self, errors: Mapping[str, float]) -> float:
        known = [r for r, e in errors.items() if isfinite(e)]
        return min((sqrt(max(errors[r] ** 2 - (BOUND * self.floor[r]) ** 2, 0.0)) for r in known), default=0.0)

    @property
    def astray(self) -> bool:
        """Whether the declared model's drive is farther from that of validation than none at all would be."""
        return self.declared[VALIDATION] >= 1.0  # NaN, without such a record, is not

    def as_dict(self) -> dict[str, object]:
        """Return plain data, from which `evidence_of` makes it again."""
        return asdict(self)


def evidence_of(data: Mapping[str, object]) -> Evidence:
    """Return the evidence that `as_dict` wrote, or trace.json holds (null is what is not finite), so that a decision can be taken again
    without the records."""
    return Evidence(
        _told(data["declared"]), _told(data["floor"]), Explainable(**data["before"]), Explainable(**data["after"]),
        tuple(map(_weighed, data["added"])), data["place_instead"], data["clock"], data["idle"],
        tuple(map(_weighed, data["refused"])), data.get("lost", 0.0), data.get("traded", False),
    )  # fmt: skip


def _weighed(data: Mapping[str, object]) -> Weighed:
    """Return one effect as it was weighed, without what Weighed no longer has: trace.json may be of an earlier version."""
    names = {f.name for f in fields(Weighed)}
    known = {k: _told(v) if isinstance(v, Mapping) else v for k, v in data.items() if v is not None and k in names}
    return Weighed(**known)


def _told(errors: Mapping[str, float | None]) -> dict[str, float]:
    return {role: float("nan") if x is None else x for role, x in errors.items()}

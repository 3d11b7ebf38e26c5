"""Gains as objects of a CANopen or EtherCAT drive (CiA 402): which object takes which number is the drive's own affair.

CiA 402 names 0x60FB (position) and 0x60F9 (velocity control parameter set) and leaves their contents to the maker; so the
study states the objects, from the drive's manual.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.control.drive import MOST
from workbench.drives.fields import TYPES, packed, unpacked
from workbench.drives.gains import Cascade
from workbench.errors import WorkbenchError, nearest
from workbench.frequency.notch import Notch

PARTS = ("centre", "width", "depth")  # of a notch: Hz, Hz, 1
NOTCHES = tuple(f"notch{i}_{part}" for i in range(1, MOST + 1) for part in PARTS)
QUANTITIES = ("kv", "kvp", "ki", "speed_limit", "limit", "mass", "viscous", "forward", *NOTCHES)
IDLE = Notch(
    100.0, 10.0, 1.0
)  # what is written for a notch that is not used: of depth 1, it passes everything, wherever it is


@dataclass(frozen=True)
class Object:
    """quantity: of Cascade. index, subindex: of the object. type: CiA 301's name. per_si: drive units per SI unit."""

    quantity: str
    index: int
    subindex: int
    type: str
    per_si: float = 1.0

    def __post_init__(self):
        if self.quantity not in QUANTITIES:
            raise WorkbenchError(f"an object takes no '{self.quantity}'; {nearest(self.quantity, QUANTITIES)}")
        if self.type not in TYPES:
            raise WorkbenchError(f"object 0x{self.index:04X}: unknown type '{self.type}'; {nearest(self.type, TYPES)}")
        if not (0x1000 <= self.index <= 0xFFFF and 0 <= self.subindex <= 0xFF):
            raise WorkbenchError(
                f"object 0x{self.index:04X}:{self.subindex:02X} does not exist: 0x1000 to 0xFFFF, 0 to 0xFF."
            )

    @property
    def where(self) -> str:
        return f"object 0x{self.index:04X}:{self.subindex:02X} ({self.quantity})"


def _quantity_of(gains: Cascade, name: str) -> float:
    """The number of a cascade that an object takes, SI and Hz."""
    if name not in NOTCHES:
        return getattr(gains, name)
    i, part = int(name[5]) - 1, name.split("_")[1]
    return getattr(gains.notches[i] if i < len(gains.notches) else IDLE, part)


def entries(gains: Cascade, objects: Sequence[Object]) -> list[tuple[Object, bytes]]:
    """Return each object with its bytes; WorkbenchError where one cannot hold its number, is named twice, or a gain in use
    has no object."""
    places = [(o.index, o.subindex) for o in objects]
    if twice := [p for p in places if places.count(p) > 1]:
        raise WorkbenchError(f"object 0x{twice[0][0]:04X}:{twice[0][1]:02X} is stated twice.")
    for name in ("kv", "kvp", "ki", "mass", "viscous", "forward"):
        if getattr(gains, name) != 0.0 and name not in {o.quantity for o in objects}:
            raise WorkbenchError(
                f"the drive has no object for {name}, which is {getattr(gains, name):.6g}; state one, or leave it out."
            )
    missing = {f"notch{i}_{part}" for i in range(1, len(gains.notches) + 1) for part in PARTS} - {
        o.quantity for o in objects
    }
    if missing:
        raise WorkbenchError(
            f"the drive has no object for {sorted(missing)[0]}, and the gains were tuned with that notch."
        )
    return [(o, packed(_quantity_of(gains, o.quantity) * o.per_si, o.type, o.where)) for o in objects]


def value_of(one: Object, data: bytes) -> float:
    """The SI number of an object's bytes."""
    return unpacked(data, one.type, one.where) / one.per_si

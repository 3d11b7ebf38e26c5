"""An SDO list for CANopen or EtherCAT: one line an object, `index,subindex,type,value,bytes`, comments behind #."""

from collections.abc import Sequence

from workbench.drives.fields import LICENCE, number, text, unpacked
from workbench.drives.gains import Cascade
from workbench.drives.objects import Object, entries
from workbench.errors import WorkbenchError

HEAD = "index,subindex,type,value,bytes"


def write(gains: Cascade, objects: Sequence[Object]) -> str:
    """Return the list; refusals as workbench.drives.objects.entries."""
    lines = [f"# SDO downloads of a position-velocity cascade. {LICENCE}", HEAD]
    for o, data in entries(gains, objects):
        value = unpacked(data, o.type, o.where)
        lines.append(f"0x{o.index:04X},0x{o.subindex:02X},{o.type},{text(value)},{data.hex().upper()} # {o.quantity}")
    return "\n".join(lines) + "\n"


def read(content: str) -> dict[tuple[int, int], float]:
    """Return (index, subindex) -> value of a list; WorkbenchError, naming the line, for anything else."""
    rows = [(n, line.split("#")[0].strip()) for n, line in enumerate(content.splitlines(), 1)]
    rows = [(n, line) for n, line in rows if line]
    if not rows or rows[0][1] != HEAD:
        raise WorkbenchError(f"an SDO list begins with '{HEAD}'.")
    found = {}
    for n, line in rows[1:]:
        where, cells = f"SDO list, line {n}", line.split(",")
        if len(cells) != 5:
            raise WorkbenchError(f"{where}: five cells are needed, here are {len(cells)}.")
        try:
            place, data = (int(cells[0], 16), int(cells[1], 16)), bytes.fromhex(cells[4])
        except ValueError as error:
            raise WorkbenchError(f"{where}: {error}.") from error
        value = unpacked(data, cells[2], where)
        if value != number(cells[3], where) and abs(value / number(cells[3], where) - 1.0) > 1e-6:
            raise WorkbenchError(f"{where}: the bytes say {value:g}, and the value {cells[3]}.")
        if place in found:
            raise WorkbenchError(f"{where}: object 0x{place[0]:04X}:{place[1]:02X} is there twice.")
        found[place] = value
    return found

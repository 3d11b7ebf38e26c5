"""A start-up list for an EtherCAT master (TwinCAT): CoE init commands as ETG.2100 has them, sent from Pre-Op to Safe-Op."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from workbench.drives.fields import LICENCE
from workbench.drives.gains import Cascade
from workbench.drives.objects import Object, entries
from workbench.errors import WorkbenchError

DOWNLOAD = "1"  # command specifier of an SDO download
KNOWN = {"Transition", "Comment", "Timeout", "Ccs", "Index", "SubIndex", "Data"}


def write(gains: Cascade, objects: Sequence[Object]) -> str:
    """Return the start-up list; refusals as workbench.drives.objects.entries."""
    root = ET.Element("EtherCATMailbox")
    root.append(ET.Comment(f" {LICENCE} "))
    commands = ET.SubElement(ET.SubElement(root, "CoE"), "InitCmds")
    for o, data in entries(gains, objects):
        one = ET.SubElement(commands, "InitCmd")
        fields = {"Transition": "PS", "Comment": o.quantity, "Timeout": "0", "Ccs": DOWNLOAD, "Index": str(o.index),
                  "SubIndex": str(o.subindex), "Data": data.hex().upper()}  # fmt: skip
        for name, value in fields.items():
            ET.SubElement(one, name).text = value
    ET.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def read(content: str) -> dict[tuple[int, int], bytes]:
    """Return (index, subindex) -> bytes of a start-up list; WorkbenchError for anything else."""
    try:
        root = ET.fromstring(content.encode())
    except ET.ParseError as error:
        raise WorkbenchError(f"the start-up list is no XML ({error}).") from error
    if root.tag != "EtherCATMailbox" or [c.tag for c in root] != ["CoE"] or [c.tag for c in root[0]] != ["InitCmds"]:
        raise WorkbenchError("a start-up list is EtherCATMailbox/CoE/InitCmds.")
    found = {}
    for n, one in enumerate(root[0][0], 1):
        fields = {c.tag: c.text or "" for c in one}
        if one.tag != "InitCmd" or set(fields) != KNOWN or len(fields) != len(one):
            raise WorkbenchError(
                f"start-up list, command {n}: {sorted(KNOWN ^ set(fields)) or one.tag} is not as it should be."
            )
        if fields["Ccs"] != DOWNLOAD or fields["Transition"] != "PS":
            raise WorkbenchError(f"start-up list, command {n}: it is no download from Pre-Op to Safe-Op.")
        try:
            found[int(fields["Index"]), int(fields["SubIndex"])] = bytes.fromhex(fields["Data"])
        except ValueError as error:
            raise WorkbenchError(f"start-up list, command {n}: {error}.") from error
    return found

"""Gains for drives that take no code: each format is one file here, which writes it, reads it back and says what it refuses."""

from workbench.drives import elmo, linuxcnc, moteus, odrive, ros2, sdo, twincat
from workbench.drives.gains import Cascade, Units, cascade_of

FORMATS = {
    "sdo": sdo,
    "twincat": twincat,
    "elmo": elmo,
    "odrive": odrive,
    "moteus": moteus,
    "ros2": ros2,
    "linuxcnc": linuxcnc,
}

__all__ = ["FORMATS", "Cascade", "Units", "cascade_of"]

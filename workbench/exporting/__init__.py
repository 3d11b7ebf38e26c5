"""Gain tables that leave the workbench: a C header, a JSON document with its schema, and a binary for flash.

    Schedule ─► tables (float32 rows) ─► document (JSON) ─► header (C), binary (packed, CRC-32) ─► written together

All three carry the same float32 tables under the same CRC-32, and name the plant that the gains were tuned on. The bytes
depend on the schedule, the plant and the scale alone; there is no date in them.
"""

from workbench.exporting.binary import load_binary
from workbench.exporting.changes import changed
from workbench.exporting.document import load
from workbench.exporting.exporting import export
from workbench.exporting.lookup import lookup32

__all__ = ["changed", "export", "load", "load_binary", "lookup32"]

"""A control law as firmware: C of the same instructions that are simulated, its table, and the proof that they agree."""

from workbench.firmware.make import Firmware, firmware

__all__ = ["Firmware", "firmware"]

"""The firmware of one compensation: its C, its table and its reference, and the files of both arithmetics."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.compensation import READ, Compensator
from workbench.errors import WorkbenchError, nearest
from workbench.firmware.compensation import Compensation, compensation
from workbench.firmware.compensation_reference import FixedReference, FloatReference
from workbench.firmware.compensation_scales import Scales, real_words
from workbench.firmware.compensation_source import FixedCompensation, FloatCompensation
from workbench.firmware.image import ARITHMETICS, Image
from workbench.plant import Plant
from workbench.simulation import Loop


@dataclass(frozen=True, eq=False)
class CompensationFirmware:
    """reference: runs it in Python. source: writes its C. image: its table."""

    made: Compensation
    reference: FloatReference
    source: FloatCompensation | FixedCompensation
    image: Image

    @property
    def reads(self) -> bool:
        """Whether it is handed the position that is measured, and not the reference."""
        return self.made.compensator.source == READ

    @cached_property
    def files(self) -> dict[str, str]:
        """File name -> text of the C, without the table."""
        return self.source.files()

    def exported(self) -> dict[str, bytes]:
        """File name -> content of everything that is exported."""
        return {n: t.encode() for n, t in self.files.items()} | {f"{self.source.name}.bin": self.image.bytes()}


def compensation_firmware(
    compensator: Compensator, loop: Loop, plant: Plant, arithmetic: str = "float32", *, name: str = "compensation",
    travel: tuple[float, float] | None = None,
) -> CompensationFirmware:  # fmt: skip
    """Return the firmware of one compensation on a loop, for an axis. What it returns is the law's `added`.

    arithmetic: "float32" or "fixed". travel: rad or m from the zero of the identification, for forces over the place.
    Raises WorkbenchError for what has no firmware, and says why.
    """
    if arithmetic not in ARITHMETICS:
        raise WorkbenchError(f"there is no arithmetic '{arithmetic}' of a firmware; {nearest(arithmetic, ARITHMETICS)}")
    made = compensation(compensator, loop, plant, travel)
    scales = Scales(made)
    fixed = arithmetic == "fixed"
    source = FixedCompensation(made, scales, name) if fixed else FloatCompensation(made, name)
    reference = FixedReference(made, scales) if fixed else FloatReference(made, scales)
    image = Image(
        arithmetic=ARITHMETICS[arithmetic], law=source.code(), per_octave=1, sample_time=loop.sample_time, count=loop.count,
        limit=made.limit, bits=32, jump=scales.jump, verdict=0, motion=0 if plant.rotary else 1, plant=plant.digest,
        constants=scales.words() if fixed else real_words(made), knots=np.zeros(0, np.float32),
        rows=np.zeros((0, 0), np.int32 if fixed else np.float32),
    )  # fmt: skip
    return CompensationFirmware(made, reference, source, image)

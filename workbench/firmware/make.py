"""One controller's firmware: its C, its table and its reference, from one set of numbers."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.compensation import Compensated
from workbench.control.law import Controller
from workbench.errors import WorkbenchError, nearest
from workbench.firmware.compensation_make import CompensationFirmware, compensation_firmware
from workbench.firmware.fixed_reference import FixedReference
from workbench.firmware.fixed_source import FixedSource
from workbench.firmware.image import ARITHMETICS, Image
from workbench.firmware.numbers import Numbers, numbers
from workbench.firmware.reference import Reference
from workbench.firmware.write import Source
from workbench.plant import Plant
from workbench.schedule.tables import grid
from workbench.simulation.scenario import Loop

FINEST = 2048  # knots an octave, 2^WB_FINEST: 12 bits of a float's 23 are left for the way between two


@dataclass(frozen=True, eq=False)
class Firmware:
    """reference: runs it in Python. source: writes its C. image: its table.

    compensation: of a compensated controller the firmware beside it, whose force the law's adds; None of any other.
    """

    numbers: Numbers
    reference: Reference
    source: Source
    image: Image
    compensation: CompensationFirmware | None = None

    @cached_property
    def files(self) -> dict[str, str]:
        """File name -> text of the C, without the table."""
        return self.source.files() | (self.compensation.files if self.compensation else {})


def firmware(
    controller: Controller,
    loop: Loop,
    plant: Plant,
    arithmetic: str = "float32",
    *,
    name: str = "axis",
    verdict: int = 0,
    bits: int = 32,
    travel: float | None = None,
    places: tuple[float, float] | None = None,
) -> Firmware:
    """Return the firmware of one controller on a loop, for an axis; of a compensated one, with its compensation's beside it.

    arithmetic: "float32" or "fixed". verdict: see image.verdict_of. bits, travel: see `numbers`. places: rad or m, between
    which a compensation acts whose force hangs on the place.
    Raises WorkbenchError where the controller, the loop or the arithmetic does not hold together.
    """
    if arithmetic not in ARITHMETICS:
        raise WorkbenchError(f"there is no arithmetic '{arithmetic}' of a firmware; {nearest(arithmetic, ARITHMETICS)}")
    beside = None
    if isinstance(controller, Compensated):
        beside = _beside(controller, loop, plant, arithmetic, places)
        controller = controller.base
    made = numbers(controller, loop, plant, bits=bits, travel=travel)
    _insist_on_grid(made, f"controller '{controller.name}'")
    if arithmetic == "fixed":
        reference = FixedReference(made)
        source = FixedSource(made, reference.scales, name, plant.effort)
    else:
        reference, source = Reference(made), Source(made.stages, name, made.knots.size, plant.effort)
    image = _image_of(made, reference, source.code(), ARITHMETICS[arithmetic], plant, verdict)
    return Firmware(made, reference, source, image, beside)


def _insist_on_grid(made: Numbers, where: str) -> None:
    """Raise WorkbenchError where a table's knots are not those that a firmware looks up. where: for the sentence."""
    if not made.knots.size:
        return
    grid(made.knots, made.per_octave, where)
    if made.per_octave > FINEST:
        raise WorkbenchError(f"{where}: {made.per_octave} knots an octave are more than the {FINEST} of a firmware.")


def _image_of(made: Numbers, reference, law: int, arithmetic: int, plant: Plant, verdict: int) -> Image:
    """Return the image of a controller's numbers as `reference` holds them. law: code of the compiled one."""
    rows = np.array(reference.rows) if reference.rows else np.zeros((0, made.knots.size), reference.constants.dtype)
    return Image(
        arithmetic=arithmetic,
        law=law,
        per_octave=made.per_octave,
        sample_time=made.sample_time,
        count=made.count,
        limit=made.limit,
        bits=made.bits,
        jump=made.jump,
        verdict=verdict,
        motion=0 if plant.rotary else 1,
        plant=plant.digest,
        constants=reference.constants,
        knots=made.knots.astype(np.float32),
        rows=rows,
    )


def _beside(
    controller: Compensated, loop: Loop, plant: Plant, arithmetic: str, places: tuple[float, float] | None
) -> CompensationFirmware:
    """Return the firmware of a controller's compensation; WorkbenchError where it reads another encoder than its law."""
    found = compensation_firmware(controller.compensator, loop, plant, arithmetic, travel=places)
    closed = {"position": ("axis", "motor"), "load_position": ("load",)}[loop.feedback]
    sides = {e.at for e in controller.compensator.forces}
    if found.reads and not sides <= set(closed):
        raise WorkbenchError(
            f"controller '{controller.name}': its compensation reads the encoder of the {min(sides)}, and its law closes the loop on "
            f"'{loop.feedback}'; compensate from the reference, or on the side that closes the loop."
        )
    return found

"""Gains that were tuned for a closed drive, as its files are told them."""

from collections.abc import Mapping, Sequence

from workbench.drive_tuning.gains import DriveGains
from workbench.drives.files import FormatOptions, files
from workbench.drives.gains import Cascade
from workbench.plant import Plant


def cascades(gains: DriveGains, plant: Plant) -> tuple[Cascade, ...]:
    """Return the sets as a closed drive is told them."""
    limits = plant.limits
    return tuple(
        Cascade(
            *map(float, point), limits.speed, limits.drive, gains.mass, 0.0, gains.forward, plant.rotary, gains.notches
        )
        for point in gains.points
    )


def files_of(
    gains: DriveGains, plant: Plant, formats: Sequence[str], options: FormatOptions
) -> tuple[Mapping[str, str], Mapping[str, str]]:
    """Return tuned gains in every format that was asked for, as `files`."""
    return files(formats, cascades(gains, plant), plant, options)

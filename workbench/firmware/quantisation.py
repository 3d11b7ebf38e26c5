"""What the firmware's arithmetic does to each number, and the least unit of each signal."""

from dataclasses import asdict, dataclass

import numpy as np

from workbench.firmware.make import Firmware
from workbench.firmware.stages import COMMAND
from workbench.firmware.units import power_of, unit


@dataclass(frozen=True)
class Quantised:
    """A number of the table. wanted: float64; held: what the firmware multiplies by; error: their relative difference."""

    name: str
    unit: str
    wanted: float
    held: float
    error: float


@dataclass(frozen=True)
class Grain:
    """A signal in fixed point: its least unit, and the largest size it can have."""

    name: str
    unit: str
    least: float
    largest: float


def numbers(made: Firmware) -> tuple[Quantised, ...]:
    """Return every constant, and of every column the knot at which the error is largest."""
    scales, effort, found = getattr(made.reference, "scales", None), made.source.effort, []
    for i, c in enumerate(made.numbers.stages.constants):
        held = float(made.reference.constants[i]) * (1.0 if scales is None else 2.0 ** -scales.constants[i].bits)
        found.append(_quantised(c.identifier, unit(c.power, effort), float(made.numbers.values[i]), held))
    stride = 2 if scales is None else 1  # in float32 a slope follows each gain
    for j, (name, column) in enumerate(made.numbers.columns.items()):
        factor = 1.0 if scales is None else 2.0 ** -scales.column(name).bits
        held = made.reference.rows[stride * j].astype(float) * factor
        with np.errstate(divide="ignore", invalid="ignore"):
            worst = int(np.nanargmax(np.abs(held / column - 1.0)))
        said = f"{name} at knot {worst} ({made.numbers.knots[worst]:.3g})"
        found.append(_quantised(said, unit(power_of(f"gain.{name}"), effort), float(column[worst]), float(held[worst])))
    return tuple(found)


def _quantised(name: str, said: str, wanted: float, held: float) -> Quantised:
    return Quantised(name, said, wanted, held, abs(held / wanted - 1.0) if wanted else abs(held))


def grains(made: Firmware) -> tuple[Grain, ...]:
    """Return the states and the command of a fixed-point firmware; none in float32."""
    scales = getattr(made.reference, "scales", None)
    if scales is None:
        return ()
    formats = {n: scales.row(n) for n in made.numbers.stages.states} | {COMMAND: scales.result(COMMAND)}
    return tuple(
        Grain(n, unit(power_of(n), made.source.effort), 2.0**-f.bits, max(abs(f.low), abs(f.high)))
        for n, f in formats.items()
    )


def table(made: Firmware) -> dict:
    """Return both as plain data."""
    return {"numbers": [asdict(q) for q in numbers(made)], "signals": [asdict(g) for g in grains(made)]}

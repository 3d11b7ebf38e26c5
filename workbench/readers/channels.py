"""The channels of a campaign as they are declared: a column, its unit, and the scale that makes it torque, force, angle or length."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.readers import wording
from workbench.readers.declaration import Table
from workbench.readers.own_unit import NONE, OWN
from workbench.units import effect_unit, scaled, to_si
from workbench.units.registry import tidy

# Templates as effects state them: F is N*m or N, x is rad or m.
CHANNELS = {
    "time": "s",
    "torque": "N*m",
    "force": "N",
    "position": "x",
    "load_position": "x",
    "reference": "x",
    "injected": "F",
    "velocity": "x/s",
    "temperature": "K",
    "normal": "N",
}
LOGGED = (*(name for row in OWN for name in row), NONE)  # what drives log that is no torque


@dataclass(frozen=True)
class Channel:
    """column: its name in the files. unit: as measured. si: inside. resolution: encoder step in SI, or 0.

    scaled: the unit that the column times `factor` has, from which it is converted; `unit` and 1 where no scale is
    declared. assumed: the scale is a guess that waits for its engineer. rate: Hz, of a time that counts samples and has no
    column.
    """

    column: str
    unit: str
    si: str
    resolution: float
    scaled: str
    factor: float = 1.0
    assumed: bool = False
    rate: float = 0.0

    def to_si(self, values, where: str, *, step: bool = False):
        """Return values of the column in SI. step: a difference, such as the encoder's."""
        with np.errstate(over="ignore"):
            product = self.factor * values
        if not np.all(np.isfinite(product)):
            raise WorkbenchError(
                f"{where} is too large when it is multiplied by its scale; check the samples and the scale."
            )
        return to_si(product, self.scaled, self.si, where, step=step)


def channels(top: Table, two_mass: bool, notes: dict[str, str]) -> dict[str, Channel]:
    """Return the declared channels by name: time, position, load_position on two masses, and one of torque and force.

    Which of the two it is says whether the axis turns. `notes` takes each channel's meaning.
    """
    table = top.table("channels", optional=tuple(CHANNELS))
    drive = [name for name in ("torque", "force") if name in table]
    if len(drive) != 1:
        fault = (
            "both 'torque' and 'force' are declared; keep" if drive else "neither 'torque' nor 'force' is declared; add"
        )
        raise WorkbenchError(f"{table.where}: {fault} the one that the drive reports.")
    for name in ("time", "position", *(["load_position"] if two_mass else [])):
        if name not in table:
            raise WorkbenchError(f"{table.where}: channel '{name}' is missing; the plant needs it, so add it.")
    channels = {}
    for name in table.values:
        if name == "time" and isinstance(table.values[name], dict) and "rate" in table.values[name]:
            one = table.table(name, ("rate",), ("meaning",))
            channels[name] = Channel("", "s", "s", 0.0, "s", rate=one.quantity("rate", "Hz", above=0.0))
            notes["channels.time.meaning"] = one.text("meaning")
            continue
        one = table.table(name, ("column", "unit"), ("meaning", "resolution", "scale"))
        channel = _channel(one, effect_unit(CHANNELS[name], "torque" in table))
        for other, seen in channels.items():
            if seen.column == channel.column:
                raise WorkbenchError(
                    f"{one.path('column')}: column '{channel.column}' is channel '{other}' already; name another column."
                )
        channels[name] = channel
        notes[f"channels.{name}.meaning"] = one.text("meaning")
    return channels


def _channel(one: Table, si: str) -> Channel:
    """Return one declared channel; its scale is a quantity in either direction ("N*m/A", "count/rev")."""
    column, unit = one.text("column"), one.text("unit")
    factor, text, assumed = 1.0, unit, False
    if "scale" in one:
        scale = _scale(one, unit, si)
        text, multiplied = scaled(unit, scale.text("unit"), si, scale.path("unit"))
        value, assumed = scale.number("value"), scale.flag("assumed")
        if value == 0.0:
            raise WorkbenchError(f"{scale.path('value')} is 0; a scale turns counts or amperes into '{si}'.")
        factor = value if multiplied else 1.0 / value
    if "scale" not in one and si in ("N*m", "N") and tidy(unit) in LOGGED:
        said = f"{one.path('unit')}: '{unit}' is no {'torque' if si == 'N*m' else 'force'}; give the constant that makes it one, "
        of = "" if tidy(unit) == NONE else unit
        mend = f'scale = {{ value = ..., unit = "{si}{of and f"/{of}"}" }}'
        whole = f", or write all parameters in it, an inertia in '{of and f'{of}*'}s^2/{'rad' if si == 'N*m' else 'm'}'"
        raise WorkbenchError(f"{said}{mend}{whole}.")
    to_si(0.0, text, si, one.path("unit"))
    step = one.number("resolution", 0.0, above=0.0) if "resolution" in one else 0.0
    channel = Channel(column, unit, si, 0.0, text, factor, assumed)
    return replace(channel, resolution=abs(channel.to_si(step, one.path("resolution"), step=True)))


def _scale(one: Table, unit: str, si: str) -> Table:
    """Return a channel's scale as a table; a number alone multiplies a column that is stated in its own unit."""
    number = one.values["scale"]
    if isinstance(number, dict) or isinstance(number, bool) or not isinstance(number, (int, float)):
        return one.table("scale", ("value", "unit"), ("assumed",))
    try:
        to_si(0.0, unit, si, one.path("unit"))
    except WorkbenchError:
        table = f'{{ value = {number!r}, unit = "{si}/{unit}" }}'
        raise WorkbenchError(
            f"{one.path('scale')} is a number, and '{unit}' is no unit of '{si}'; say what it makes of a column in '{unit}', as scale = {table}."
        ) from None
    return Table(
        {"value": number, "unit": "1"},
        one.file,
        one.path("scale").removeprefix(f"{one.file}: "),
        ("value", "unit"),
        ("assumed",),
    )


def assumptions(channels: Mapping[str, Channel]) -> tuple[Finding, ...]:
    """Say which scales are guesses."""
    return tuple(wording.assumed_scale(n, c.column, c.unit, c.si, c.factor) for n, c in channels.items() if c.assumed)

"""From guessed channels to a proposed campaign: scales, encoder steps, roles, bandwidth, each with its reason."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.intake import signals
from workbench.intake.clocks import seconds
from workbench.intake.columns import Columns, Guess, Scale
from workbench.intake.entries import Entry, entries, stretches
from workbench.intake.names import is_length, kind_of
from workbench.readers.sampling import TOLERANCE, unrounded

SURE = 0.3  # share of the drive that motion must explain before its sign is believed


@dataclass(frozen=True)
class Channel:
    """One channel of the proposed campaign. resolution: in the column's unit, 0 where none was found."""

    guess: Guess
    scale: Scale | None
    resolution: float = 0.0
    resolution_why: str = ""


@dataclass(frozen=True)
class Proposal:
    """two_mass: with an encoder on the load. rotary: torque over rad, else force over m. bandwidth, rate: Hz. uneven: time steps off, or 0. short: samples between gaps too near for a record. peak: largest drive,
    as logged. travel: of the position, as logged.
    """

    two_mass: bool
    rotary: bool
    channels: tuple[Channel, ...]
    entries: tuple[Entry, ...]
    bandwidth: float
    rate: float
    uneven: int
    short: int
    peak: float
    travel: float


def proposal(columns: Columns, guesses: Sequence[Guess]) -> Proposal:
    """Return the campaign that these columns make."""
    time, drive, position = guesses[:3]
    linear = drive.channel == "force" or is_length(position.unit)
    sizes = [s.columns[drive.column].size for s in columns.surveys]
    clocks = [seconds(time, s.columns.get(time.column), n) for s, n in zip(columns.surveys, sizes, strict=True)]
    parts = [part for k, t in enumerate(clocks) for part in stretches(k, t)]
    rates = [1.0 / float(np.median(np.diff(part.time))) for part in parts]
    places, drives = ([columns.of(g.column)[p.survey][p.samples] for p in parts] for g in (position, drive))
    bands = [signals.motion_band(p, r) for p, r in zip(places, rates, strict=True)]
    related = [signals.relation(*x) for x in zip(places, drives, rates, bands, strict=True)]
    best = max(related, key=lambda r: r.explained)
    reversed_ = best.explained > SURE and best.reversed
    scales = [time.scale, _drive_scale(drive, linear, reversed_), *(_position_scale(g, linear) for g in guesses[2:])]
    channels = []
    for guess, scale in zip(guesses, scales, strict=True):
        step, why = _resolution(columns.of(guess.column)) if "position" in guess.channel else (0.0, "")
        channels.append(Channel(guess, scale, step, why))
    load = next((g.column for g in guesses if g.channel == "load_position"), None)
    made = entries(columns, parts, places, rates, bands)
    if load:
        still = [not np.ptp(x) > 0 for x in columns.of(load)]
        made = tuple(replace(e, locked=still[e.survey]) for e in made)
    return Proposal(
        two_mass=load is not None,
        rotary=not linear,
        channels=tuple(channels),
        entries=made,
        bandwidth=_rounded(min(max(bands), signals.HIGHEST * min(rates))),
        rate=min(rates),
        uneven=sum(_uneven(part.time) for part in parts),
        short=sum(t.size for t in clocks) - sum(part.time.size for part in parts),
        peak=max(float(np.max(np.abs(d))) for d in drives),
        travel=max(float(np.ptp(p)) for p in places),
    )


def _uneven(time: np.ndarray) -> int:
    steps = np.diff(even if (even := unrounded(time)) is not None else time)
    step = float(np.median(steps))
    return int(np.count_nonzero(np.abs(steps - step) > TOLERANCE * step))


def _rounded(value: float) -> float:
    """Two digits, rounded down."""
    digits = 10.0 ** (np.floor(np.log10(value)) - 1)
    return float(np.round(np.floor(value / digits + 1e-9) * digits, 9))


def _drive_scale(guess: Guess, linear: bool, reversed_: bool) -> Scale | None:
    effort, sign = ("N" if linear else "N*m"), (-1.0 if reversed_ else 1.0)
    kind = kind_of(guess.unit)
    turned = "; minus, since this drive counts against the position" if reversed_ else ""
    if kind == ("force" if linear else "torque") and not guess.stated:
        return Scale(sign, "1", True, f"no unit is stated, so that '{guess.unit}' is a guess" + turned)
    if kind == ("force" if linear else "torque"):
        return Scale(sign, "1", False, "the sign" + turned) if reversed_ else None
    if kind in ("torque", "force"):
        return Scale(sign, f"({effort})/({guess.unit})", True, "what the transmission makes of the drive" + turned)
    if kind == "":
        return Scale(sign, effort, True, f"the rated {'force' if linear else 'torque'}, which is 100 percent" + turned)
    what = "force constant" if linear else "torque constant"
    per = guess.unit if kind == "voltage" else "A"
    return Scale(sign, f"{effort}/{per}", True, f"the {what}, times the gear ratio where there is a gear" + turned)


def _position_scale(guess: Guess, linear: bool) -> Scale | None:
    if guess.channel not in ("position", "load_position", "reference"):
        return None
    if guess.unit == "count":
        value, unit = (1000.0, "count/mm") if linear else (4096.0, "count/rev")
        return Scale(value, unit, True, f"encoder counts a {'mm' if linear else 'revolution'} of the output")
    if linear and not is_length(guess.unit):
        return Scale(10.0, "mm/rev", True, "travel a revolution")
    if not guess.stated:
        return Scale(1.0, "1", True, f"no unit is stated, so that '{guess.unit}' is a guess")
    return None


def _resolution(columns: Sequence[np.ndarray]) -> tuple[float, str]:
    """Return the encoder's step in the column's unit, and the reason."""
    if all(np.all(x == np.round(x)) for x in columns):
        return 1.0, "whole numbers"
    steps = [q for q in map(signals.quantum, columns) if q > 0]
    if steps:
        return min(steps), "all increments are multiples of it"
    noise = min(float(np.median(np.abs(np.diff(x, 2)))) for x in columns)
    return noise, "no step is to be seen in the data; this is the size of its noise"

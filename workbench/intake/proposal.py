"""From guessed channels to a proposed campaign: scales, encoder steps, roles, bandwidth, each with its reason."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.intake import signals
from workbench.intake.clocks import seconds
from workbench.intake.columns import Columns, Guess, Scale
from workbench.intake.names import is_length, kind_of, words_of
from workbench.readers import stem
from workbench.readers.sampling import TOLERANCE
from workbench.record import IDENTIFICATION, VALIDATION

SURE = 0.3  # share of the drive that motion must explain before its sign is believed
CALM = (0.55, 0.75)  # of a single record: where it is parted, at the calmest moment
WORDS = {"val", "valid", "validation", "validate", "test", "check", "verify", "verification"}
DWELL = 0.02  # of the largest speed: an axis slower than this rests
APART = 0.1  # records whose shares of rest differ by less are taken for motions of one kind


@dataclass(frozen=True)
class Channel:
    """One channel of the proposed campaign. resolution: in the column's unit, 0 where none was found."""

    guess: Guess
    scale: Scale | None
    resolution: float = 0.0
    resolution_why: str = ""


@dataclass(frozen=True)
class Entry:
    """One [[records]] of the proposed campaign. survey: which file. until, counts_from: s, where a file is parted.

    locked: the load's encoder stands while the motor's moves.
    """

    survey: int
    role: str
    why: str
    name: str = ""
    until: float | None = None
    counts_from: float | None = None
    locked: bool = False


@dataclass(frozen=True)
class Proposal:
    """two_mass: with an encoder on the load. rotary: torque over rad, else force over m. bandwidth, rate: Hz. uneven: time steps off, or 0. peak: largest drive,
    as logged. travel: of the position, as logged.
    """

    two_mass: bool
    rotary: bool
    channels: tuple[Channel, ...]
    entries: tuple[Entry, ...]
    bandwidth: float
    rate: float
    uneven: int
    peak: float
    travel: float


def proposal(columns: Columns, guesses: Sequence[Guess]) -> Proposal:
    """Return the campaign that these columns make."""
    time, drive, position = guesses[:3]
    linear = drive.channel == "force" or is_length(position.unit)
    sizes = [s.columns[drive.column].size for s in columns.surveys]
    clocks = [seconds(time, s.columns.get(time.column), n) for s, n in zip(columns.surveys, sizes, strict=True)]
    rates = [1.0 / float(np.median(np.diff(t))) for t in clocks]
    places, drives = columns.of(position.column), columns.of(drive.column)
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
    entries = _entries(columns, clocks, places, rates, bands)
    if load:
        still = [not np.ptp(x) > 0 for x in columns.of(load)]
        entries = tuple(replace(e, locked=still[e.survey]) for e in entries)
    return Proposal(
        two_mass=load is not None,
        rotary=not linear,
        channels=tuple(channels),
        entries=entries,
        bandwidth=_rounded(min(max(bands), signals.HIGHEST * min(rates))),
        rate=min(rates),
        uneven=sum(_uneven(t) for t in clocks),
        peak=max(float(np.max(np.abs(d))) for d in drives),
        travel=max(float(np.ptp(p)) for p in places),
    )


def _uneven(time: np.ndarray) -> int:
    steps = np.diff(time)
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


def _entries(columns: Columns, clocks, places, rates, bands) -> tuple[Entry, ...]:
    """Say what each record is for: by its name, else the one that rests most validates; a single one is parted."""
    if len(clocks) == 1:
        return _parted(columns, clocks[0], signals.resting(places[0], rates[0], bands[0]))
    named = [k for k, s in enumerate(columns.surveys) if WORDS & set(words_of(stem(s.path))[0])]
    if named and len(named) < len(clocks):
        reasons = dict.fromkeys(named, "its name says so")
    else:
        rest = [float(np.mean(signals.resting(*x) < DWELL)) for x in zip(places, rates, bands, strict=True)]
        top = [k for k, share in enumerate(rest) if share >= max(rest) - APART]
        k = top[-1]
        reasons = {k: f"it rests for {100 * rest[k]:.0f} % of its time, as an axis does that positions"}
        if len(top) > 1:
            reasons = {k: "records of one kind are fitted but for the last"}
    return tuple(
        Entry(k, VALIDATION, reasons[k]) if k in reasons else Entry(k, IDENTIFICATION, "the others are fitted")
        for k in range(len(clocks))
    )


def _parted(columns: Columns, time: np.ndarray, speed: np.ndarray) -> tuple[Entry, ...]:
    """Part the only record in time: fitted up to the calmest moment between 55 and 75 % of it, and validated after it."""
    first, last = (int(share * time.size) for share in CALM)
    at = float(time[first + int(np.argmin(speed[first:last]))])
    name = stem(columns.path).replace(" ", "_")
    name = "".join(c for c in name if c.isalnum() or c in "_-") or "record"
    why = "the only record is parted at its calmest moment between 55 and 75 %"
    return (
        Entry(0, IDENTIFICATION, why, f"{name}_first", until=at),
        Entry(
            0, VALIDATION, f"{why}; what lies before only brings friction into its state", f"{name}_second", None, at
        ),
    )

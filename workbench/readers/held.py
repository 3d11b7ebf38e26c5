"""Formats that are opened whole: each column with its values, its unit and, where it has its own, its instants.

Where columns were sampled at different instants (a bag of topics, a scope with a time column per channel), those that are
asked for are put on one raster: the slowest of them, so that the others are interpolated between dense samples. What is
SLOW times slower than the fastest, a temperature, is interpolated instead, and decides no raster.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.readers.sheet import Sheet, sheet, vector
from workbench.readers.wording import put_on_one

CLOCK = "time"  # the column that stands for the raster's instants
SLOW = 20.0  # halved, a torque logged at a tenth of the position's rate would be drawn out by straight lines


@dataclass(frozen=True, eq=False)
class Held:
    """values: as the library gives them. unit: as the file writes it. clock: (n,) s, where the column has its own."""

    values: object
    unit: str = ""
    clock: np.ndarray | None = None


class Whole:
    """A reader whose `held` opens the file at once; see workbench.readers.Reader for the rest."""

    def held(self, content: bytes, path: Path) -> Mapping[str, Held]:
        """Return every column by name; WorkbenchError where the file cannot be read."""
        raise NotImplementedError

    def columns(self, content: bytes, path: Path) -> tuple[str, ...]:
        return _names(self.held(content, path))

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Sheet:
        return chosen(self.held(content, path), path, columns)

    def each(
        self, content: bytes, path: Path, names: Sequence[str] = ()
    ) -> Iterator[tuple[str, Sheet | WorkbenchError]]:
        """Yield every column alone, or why it cannot be read, from one opening. names: those that are meant, if not all."""
        held = self.held(content, path)
        clocks = {n: h for n, h in held.items() if h.clock is not None}
        held = {n: h for n, h in held.items() if not names or n in names} or clocks
        good = {}
        for name in held:
            try:
                good[name] = vector(held[name].values, name, path)
                sheet({name: good[name]}, {name: name}, path)
            except WorkbenchError as e:
                good.pop(name, None)
                yield name, e
        sound = {n: replace(held[n], values=v) for n, v in good.items()}
        longest = max((v.size for n, v in good.items() if held[n].clock is None), default=0)
        sound = {n: h for n, h in sound.items() if h.clock is not None or h.values.size == longest}
        if sound:
            one = chosen(sound, path, {n: n for n in _names(sound)})
            yield from ((n, replace(one, channels={n: one.channels[n]})) for n in one.channels)


def _names(held: Mapping[str, Held]) -> tuple[str, ...]:
    clocked = any(h.clock is not None for h in held.values())
    return (*([CLOCK] if clocked and CLOCK not in held else []), *held)


def chosen(held: Mapping[str, Held], path: Path, columns: Mapping[str, str]) -> Sheet:
    """Return the named columns on one raster; WorkbenchError naming the nearest where one is not there."""
    names = _names(held)
    for column in columns.values():
        if column not in names:
            raise WorkbenchError(f"{path}: there is no column '{column}'; {nearest(column, names)}")
    found = {c: held[n] for c, n in columns.items() if n in held}
    vectors = {c: vector(h.values, columns[c], path) for c, h in found.items()}
    units = {c: h.unit for c, h in found.items()}
    own = {c: h.clock for c, h in found.items() if h.clock is not None}
    alone = [c for c, n in columns.items() if n not in held]
    if not own and not alone:
        return sheet({c: vectors[c] for c in columns}, columns, path, units)
    own = own or {name: h.clock for name, h in held.items() if h.clock is not None}
    time, vectors, note = _on_one(own, vectors, {**columns, **{n: n for n in held}}, path)
    vectors |= dict.fromkeys(alone, time)
    units |= dict.fromkeys(alone, "s")
    made = sheet({c: np.array(vectors[c]) for c in columns}, columns, path, units)
    return replace(made, notes=(note,) if note else ())


def _on_one(own, vectors, columns, path):
    """Return (time, vectors, note): all on the slowest clock of those that are not slow."""
    for channel, clock in own.items():
        if clock.size < 2 or not np.all(np.diff(clock) > 0):
            raise WorkbenchError(
                f"{path}: the instants of '{columns[channel]}' do not increase; export the record again."
            )
    most = max(c.size for c in own.values())
    lead = {n: c for n, c in own.items() if c.size * SLOW >= most}
    first = min(lead, key=lambda n: lead[n].size)
    time = own[first]
    others = [n for n in vectors if n in own and not np.array_equal(own[n], time)]
    if not others:
        return time, vectors, ""
    low, high = (pick(c[k] for c in lead.values()) for pick, k in ((max, 0), (min, -1)))
    kept = time[(time >= low) & (time <= high)]
    if kept.size < 2:
        raise WorkbenchError(f"{path}: its columns were not sampled in the same stretch of time; export them together.")
    put = {n: np.interp(kept, own.get(n, time), v) if n in own else v for n, v in vectors.items()}
    rate = (time.size - 1) / (time[-1] - time[0])
    return kept, put, put_on_one([columns[n] for n in others], columns[first], rate)

"""The text of one loop kernel: samples outside, lanes inside, every value at a constant place of one flat array.

Row r of the chunk lies at x[r L] .. x[r L + L - 1]. A loop over lanes loads rows, does the arithmetic of a program and
stores rows, WIDTH lanes at a time; offsets and L are written out as numbers.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from math import gcd

from workbench.kernel.cache import JIT
from workbench.kernel.text import written
from workbench.simulation import noise
from workbench.simulation.design import Design, Piece
from workbench.simulation.sampled import AMPLITUDE

# What a loop may read or write. A kernel is given those alone that its layout needs: each array costs 5 ms of compiling it.
ARRAYS = "x", "constants", "table", "base", "seeds", "strength", "delays", "ring", "shared", "own", "kept", "out"
NUMBERS = "samples", "window_from", "every", "shift", "offset", "delay", "sample_time", "h"
HEAD = '''"""Generated: one sampled loop. Strict arithmetic in the order of the symbolic steps, so the bits are the same."""

import numba

from workbench.kernel.straight import abreast, looped, straight
'''
RUN = """

@looped
def whole({given}):
{lines}


GIVEN = "{given}".split(", ")


{jit}
def run({given}):
    whole({given})
"""
STAGES = "sense", "control", "step"
# Lanes side by side in one instruction: 512 bits, or two or four instructions of a narrower processor. Sixteen and thirty-two make the loop of
# the main study a seventh slower: more values are in flight than there are registers.
WIDTH = 8


@dataclass(frozen=True)
class Layout:
    """How a kernel is laid out.

    varying: for each piece, whether each of its constants has a value a lane. record: rows that a single lane writes out (of many, which are is an argument: one
    kernel serves all). shared, own: signals given over time.
    delay: "none", "uniform" or "varying"; slots: samples that the ring holds. substeps, lanes: written into the text.
    """

    varying: tuple[tuple[bool, ...], ...]
    substeps: int
    lanes: int
    delay: str
    slots: int
    record: tuple[str, ...] = ()
    shared: tuple[str, ...] = ()
    own: tuple[str, ...] = ()

    def constants(self, at: int) -> list[tuple[str, int]]:
        """(kind, number) of each constant of piece `at`: "row" counted after the design's rows, or "scalar"."""
        flat = [v for piece in self.varying for v in piece]
        first = sum(len(piece) for piece in self.varying[:at])
        return [
            ("row", sum(flat[: first + m])) if v else ("scalar", first + m - sum(flat[: first + m]))
            for m, v in enumerate(self.varying[at])
        ]

    @property
    def extra_rows(self) -> int:
        return sum(v for piece in self.varying for v in piece)


def places(design: Design, layout: Layout) -> dict[str, int]:
    """Row of every name. Without a delay the command acts at once: "u" is the row of "u_c"."""
    at = {n: i for i, n in enumerate(n for n in design.rows if layout.delay != "none" or n != "u")}
    return at if "u" in at else at | {"u": at["u_c"]}


def _cell(row: int, lanes: int) -> str:
    """Where a row is in one lane. A single lane has its rows in variables: a store and a load would cost it latency."""
    return f"r_{row}" if lanes == 1 else f"x[{row * lanes} + lane]"


def _each(
    name: str, given: Iterable[str], lines: list[str], lanes: int, abreast: int = WIDTH
) -> tuple[list[str], list[str]]:
    """Return the lines of a function that does this in each of many lanes, and those that call it. One lane does it where it stands."""
    if lanes == 1:
        return [], lines
    width, call = gcd(lanes, abreast), f"{name}({', '.join(given)})"
    return _function(call, lines, width), [f"for lane in range(0, {lanes}, {width}):", f"    {call}"]


def _function(call: str, lines: list[str], width: int = 1) -> list[str]:
    kind = "straight" if width == 1 else f"abreast({width})"
    return ["", "", f"@{kind}", f"def {call}:", *(f"    {line}" for line in lines)]


def _stage(
    name: str, piece: Piece, at: dict[str, int], constants, rows: int, lanes: int
) -> tuple[list[str], list[str]]:
    """Return the lines of a function that does a piece's arithmetic, and those that call it for all lanes.

    Many lanes load and store their rows, and each row where it is first needed; one has them in variables, which it gives and gets back."""
    given = {"c": None} if any(kind == "scalar" for kind, _ in constants) else {}
    given |= {} if lanes == 1 else {"x": None, "lane": None}

    def cell(row: int) -> str:
        text = _cell(row, lanes)
        return text if lanes > 1 else given.setdefault(text, None) or text

    read = {}
    for j, row in enumerate(piece.rows):
        if row not in at:
            given[f"clock_{row}"] = None
        read[f"i0_{j}"] = cell(at[row]) if row in at else f"clock_{row}"
    for m, (kind, number) in enumerate(constants):
        read[f"i1_{m}"] = cell(rows + number) if kind == "row" else f"c[{number}]"
    inside = written(piece.after, read, lanes)
    cells = [_cell(at[n], lanes) for n in piece.outputs]
    values = piece.after.outputs[0]
    if lanes > 1:
        return _each(name, given, inside + [f"{to} = {value}" for to, value in zip(cells, values, strict=True)], lanes)
    call = f"{name}({', '.join(given)})"
    back = [f"return {', '.join(values)},"] if cells else []
    return _function(call, inside + back), [f"{', '.join(cells)}, = {call}" if cells else call]


def _look_up(design: Design, at: dict[str, int], lanes: int) -> tuple[list[str], list[str]]:
    """Lines that read the law's table: see workbench.control.table."""
    columns = design.law.columns if design.law is not None else ()
    if not columns:
        return [], []
    lines = [
        f"amplitude = {_cell(at[AMPLITUDE], lanes)}",
        f"row = {2 * len(columns)} * (base[lane] + ((bits(amplitude) >> shift) - offset))",
    ]
    for j, name in enumerate(columns):
        lines.append(
            f"{_cell(at[f'gain.{name}'], lanes)} = table[row + {2 * j}] + table[row + {2 * j + 1}] * amplitude"
        )
    # Lanes read the table where each likes. One by one they take 2 % less of a whole loop's time than put side by side.
    return _each("look_up", ("x", "table", "base", "shift", "offset", "lane"), lines, lanes, abreast=1)


def _delayed(at: dict[str, int], layout: Layout) -> tuple[list[str], list[str], list[str]]:
    """Lines of functions, lines that put a sample's command into the ring, and lines that take out what acts in substep j."""
    lanes, slots, steps = layout.lanes, layout.slots, layout.substeps
    if layout.delay == "none":
        return [], [], []
    u = _cell(at["u"], lanes)
    text, put = _each("put", ("x", "ring", "slot", "lane"), [f"ring[slot + lane] = {_cell(at['u_c'], lanes)}"], lanes)
    put = [f"slot = (k % {slots}) * {lanes}", *put]
    if layout.delay == "uniform":
        more, take = _each("take", ("x", "ring", "then", "lane"), [f"{u} = ring[then + lane]"], lanes)
        take = [f"then = ((past // {steps}) % {slots}) * {lanes}", *take]
        take = [f"past = k * {steps} + j - delay", "if past >= 0:", *(f"    {line}" for line in take)]
    elif lanes == 1:
        more, then = [], f"((past // {steps}) % {slots})"
        take = [f"past = k * {steps} + j - delays[lane]", "if past >= 0:", f"    {u} = ring[{then} + lane]"]
    else:  # a lane whose first command has not come through yet keeps what it has
        lines = [
            f"past = k * {steps} + j - delays[lane]",
            f"then = ((select(past >= 0, past, 0) // {steps}) % {slots}) * {lanes}",
            f"{u} = select(past >= 0, ring[then + lane], {u})",
        ]
        more, take = _each("take", ("x", "ring", "delays", "k", "j", "lane"), lines, lanes)
    return text + more, put, take


def _given(at: dict[str, int], layout: Layout) -> tuple[list[str], list[str]]:
    """Lines that take a sample of the signals given over time."""
    lanes, n, m = layout.lanes, len(layout.shared), len(layout.own)
    clocks = [f"clock_{name} = shared[k * {n} + {i}]" for i, name in enumerate(layout.shared)]
    rows = [(i, name) for i, name in enumerate(layout.own) if name in at]
    lines = [f"{_cell(at[name], lanes)} = own[k * {m * lanes} + {i * lanes} + lane]" for i, name in rows]
    text, call = _each("given", ("x", "own", "k", "lane"), lines, lanes) if rows else ([], [])
    return text, clocks + call


def _recorded(at: dict[str, int], layout: Layout) -> tuple[list[str], list[str]]:
    """Lines that write the rows asked for, every so many samples: those of the layout from one lane, those numbered in `kept` from many."""
    lanes, n = layout.lanes, len(layout.record)
    if lanes == 1:
        lines = [f"out[(k // every) * {n} + {i}] = {_cell(at[name], lanes)}" for i, name in enumerate(layout.record)]
        return [], ["if k % every == 0:", *(f"    {line}" for line in lines)] if n else []
    text, call = _each("keep", ("x", "out", "place", "row", "lane"), ["out[place + lane] = x[row + lane]"], lanes)
    lines = [f"place = ((k // every) * kept.size + m) * {lanes}", f"row = kept[m] * {lanes}", *call]
    return text, ["if k % every == 0:", "    for m in range(kept.size):", *(f"        {line}" for line in lines)]


def _noisy(design: Design, at: dict[str, int], lanes: int) -> tuple[list[str], list[str]]:
    if not design.noisy:
        return [], []
    lines = noise.source(_cell(at["noise"], lanes), "strength[lane]")
    return _each("draw", ("x", "seeds", "strength", "k", "lane"), lines, lanes)


def source(design: Design, layout: Layout) -> str:
    """Return the text of a module with `run(...)`, which moves one chunk of lanes through all samples, and GIVEN, the names of its arguments."""
    at, lanes = places(design, layout), layout.lanes
    rows = len(set(at.values()))
    made = [_stage(STAGES[i], p, at, layout.constants(i), rows, lanes) for i, p in enumerate(design.pieces)]
    sense, control, step = (call for _, call in made)
    more, put, take = _delayed(at, layout)
    others = [_given(at, layout), _look_up(design, at, lanes), _recorded(at, layout), _noisy(design, at, lanes)]
    given, look_up, recorded, noisy = (call for _, call in others)
    clocks = [
        "clock_k = float(k)",
        "clock_t = clock_k * sample_time",
        "clock_window = select(k >= window_from, 1.0, 0.0)",
    ]
    sample = [*clocks, *given, *sense, *look_up, *control, *recorded, *noisy, *put]
    inner = [*take, "clock_t = clock_k * sample_time + float(j) * h", *step]
    scalars = sum(len(v) for v in layout.varying) - layout.extra_rows
    own = range(rows + layout.extra_rows) if lanes == 1 else ()
    text = ["lane = 0"] if lanes == 1 else []
    held = "".join(f"constants[{i}], " for i in range(scalars)) if lanes == 1 else ""
    text += [f"c = {held.rstrip() or 'constants'}"]  # one lane holds them, many read them where they need them
    text += [f"r_{i} = x[{i}]" for i in own]
    text += ["for k in range(samples):", *(f"    {line}" for line in sample)]
    text += [f"    for j in range({layout.substeps}):", *(f"        {line}" for line in inner)]
    text += [f"x[{i}] = r_{i}" for i in own]
    functions = [line for lines, *_ in [*made, *others, (more,)] for line in lines]
    named = set(re.findall(r"\w+", "\n".join(text)))
    arguments = ", ".join(n for n in (*ARRAYS, *NUMBERS) if n in named)
    lines = "\n".join(f"    {line}" for line in text)
    return HEAD + "\n".join(functions) + "\n" + RUN.format(given=arguments, lines=lines, jit=JIT)

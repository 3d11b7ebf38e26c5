"""The text of one loop kernel: samples outside, lanes inside, every value at a constant place of one flat array.

Row r of the chunk lies at x[r L] .. x[r L + L - 1]. A loop over lanes loads rows, does the arithmetic of a program and
stores rows, WIDTH lanes at a time; offsets and L are written out as numbers.
"""

from dataclasses import dataclass
from math import gcd

from workbench.kernel.cache import JIT
from workbench.kernel.text import written
from workbench.simulation import noise
from workbench.simulation.design import Design, Piece
from workbench.simulation.sampled import AMPLITUDE

ARGUMENTS = (
    "x, constants, table, base, seeds, strength, delays, ring, shared, own, kept, out, "
    "samples, window_from, every, shift, offset, delay, sample_time, h"
)
HEAD = '''"""Generated: one sampled loop. Strict arithmetic in the order of the symbolic steps, so the bits are the same."""

import numba
import numpy as np

from workbench.kernel.intrinsics import bits
from workbench.kernel.straight import abreast, straight

'''
RUN = """

{jit}
def run({arguments}):
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
    call = f"{name}({', '.join(given)})"
    if lanes > 1:
        inside += [f"{to} = {value}" for to, value in zip(cells, values, strict=True)]
    elif cells:
        inside.append(f"return {', '.join(values)},")
        call = f"{', '.join(cells)}, = {call}"
    width = gcd(lanes, WIDTH)
    kind = "@straight" if width == 1 else f"@abreast({width})"
    text = ["", "", kind, f"def {name}({', '.join(given)}):", *(f"    {line}" for line in inside)]
    return text, [f"for lane in range(0, {lanes}, {width}):", f"    {call}"] if lanes > 1 else [call]


def _look_up(design: Design, at: dict[str, int], lanes: int) -> list[str]:
    """Lines that read the law's table: see workbench.control.table."""
    columns = design.law.columns if design.law is not None else ()
    if not columns:
        return []
    text = [
        f"for lane in range({lanes}):",
        f"    amplitude = {_cell(at[AMPLITUDE], lanes)}",
        f"    row = {2 * len(columns)} * (base[lane] + ((bits(amplitude) >> shift) - offset))",
    ]
    for j, name in enumerate(columns):
        place = _cell(at[f"gain.{name}"], lanes)
        text.append(f"    {place} = table[row + {2 * j}] + table[row + {2 * j + 1}] * amplitude")
    return text


def _delayed(at: dict[str, int], layout: Layout) -> tuple[list[str], list[str]]:
    """Lines that put a sample's command into the ring, and lines that take out what acts in substep j."""
    lanes, slots, steps = layout.lanes, layout.slots, layout.substeps
    if layout.delay == "none":
        return [], []
    put = [
        f"slot = (k % {slots}) * {lanes}",
        f"for lane in range({lanes}):",
        f"    ring[slot + lane] = {_cell(at['u_c'], lanes)}",
    ]
    if layout.delay == "uniform":
        take = [
            f"past = k * {steps} + j - delay",
            "if past >= 0:",
            f"    slot = ((past // {steps}) % {slots}) * {lanes}",
            f"    for lane in range({lanes}):",
            f"        {_cell(at['u'], lanes)} = ring[slot + lane]",
        ]
    else:
        take = [
            f"for lane in range({lanes}):",
            f"    past = k * {steps} + j - delays[lane]",
            "    if past >= 0:",
            f"        {_cell(at['u'], lanes)} = ring[((past // {steps}) % {slots}) * {lanes} + lane]",
        ]
    return put, take


def _given(at: dict[str, int], layout: Layout) -> list[str]:
    """Lines that take a sample of the signals given over time."""
    lanes, n, m = layout.lanes, len(layout.shared), len(layout.own)
    text = [f"clock_{name} = shared[k * {n} + {i}]" for i, name in enumerate(layout.shared)]
    rows = [(i, name) for i, name in enumerate(layout.own) if name in at]
    text += [f"for lane in range({lanes}):"] if rows else []
    return text + [f"    {_cell(at[name], lanes)} = own[k * {m * lanes} + {i * lanes} + lane]" for i, name in rows]


def _recorded(at: dict[str, int], layout: Layout) -> list[str]:
    """Lines that write the rows asked for, every so many samples: those of the layout from one lane, those numbered in `kept` from many."""
    lanes, n = layout.lanes, len(layout.record)
    if lanes == 1:
        text = [f"out[(k // every) * {n} + {i}] = {_cell(at[name], lanes)}" for i, name in enumerate(layout.record)]
        return ["if k % every == 0:", *(f"    {line}" for line in text)] if n else []
    return [
        "if k % every == 0:",
        "    for m in range(kept.size):",
        f"        place, row = ((k // every) * kept.size + m) * {lanes}, kept[m] * {lanes}",
        f"        for lane in range({lanes}):",
        "            out[place + lane] = x[row + lane]",
    ]


def _scalars(count: int) -> list[str]:
    """Return the function that unpacks the constants, for one lane: many read them where they need them."""
    return ["", "", "@straight", "def scalars(c):", f"    return {', '.join(f'c[{i}]' for i in range(count))},"]


def source(design: Design, layout: Layout) -> str:
    """Return the text of a module with `run(...)`, which moves one chunk of lanes through all samples."""
    at, lanes = places(design, layout), layout.lanes
    rows = len(set(at.values()))
    made = [_stage(STAGES[i], p, at, layout.constants(i), rows, lanes) for i, p in enumerate(design.pieces)]
    sense, control, step = (call for _, call in made)
    scalars = sum(len(v) for v in layout.varying) - layout.extra_rows
    put, take = _delayed(at, layout)
    noisy = noise.source(_cell(at["noise"], lanes), "strength[lane]", lanes) if design.noisy else []
    clocks = [
        "clock_k = float(k)",
        "clock_t = clock_k * sample_time",
        "clock_window = 1.0 if k >= window_from else 0.0",
    ]
    sample = [
        *clocks,
        *_given(at, layout),
        *sense,
        *_look_up(design, at, lanes),
        *control,
        *_recorded(at, layout),
        *noisy,
        *put,
    ]
    inner = [*take, "clock_t = clock_k * sample_time + j * h", *step]
    unpacked = scalars if lanes == 1 else 0
    before = [line for text, _ in made for line in text] + (_scalars(scalars) if unpacked else [])
    text = [f"    c = {'scalars(constants)' if unpacked else 'constants'}"]
    own = range(rows + layout.extra_rows) if lanes == 1 else ()
    text += [f"    r_{i} = x[{i}]" for i in own]
    text += ["    for k in range(samples):"]
    text += [f"        {line}" for line in sample]
    text += [f"        for j in range({layout.substeps}):"]
    text += [f"            {line}" for line in inner]
    text += [f"    x[{i}] = r_{i}" for i in own]
    head = HEAD.rstrip("\n") + "\n".join(["", *before, ""])
    return head + RUN.format(jit=JIT, arguments=ARGUMENTS) + "\n".join(text) + "\n"

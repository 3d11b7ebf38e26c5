"""Variables of a MATLAB 5 file (versions 5 to 7): numbers and structures of numbers.

SciPy's reader trusts the types and sizes that it finds and ends the process where they cannot be; here each is looked at.
The format: MathWorks, "MAT-File Format", 2019. A file is a run of elements, each a type, a size and data; a matrix is an
element that holds flags, dimensions, a name and its data as elements again.
"""

import struct
import zlib
from collections.abc import Iterator
from math import prod
from pathlib import Path

import numpy as np

from workbench.readers.limits import LARGEST, within

START = 128  # byte of the first element
INT32, UINT32, MATRIX, PACKED = 5, 6, 14, 15
NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
STRUCT, CHAR, NUMERIC = 2, 4, range(6, 16)  # classes of a matrix
COMPLEX = 0x0800  # flag of a matrix
NO_NUMBERS = np.empty(0, object)  # stands for cells, objects, sparse matrices


class Broken(ValueError):
    """What is written cannot be; the message says what and where, within the file or within what it is packed in."""


MOST = 256  # structures of one array that are read: one a channel, as ControlDesk writes them


def variables(content: bytes, path: Path) -> dict[str, object]:
    """Return name -> array, or dict of fields for a structure, or a list of dicts for many; Broken where that fails.

    Text is a str array, and what is neither numbers nor a structure an array of objects.
    """
    order = {b"IM": "<", b"MI": ">"}.get(content[126:128])
    if order is None:
        raise Broken("it does not say its order of bytes")
    found = {}
    for kind, data, at in _elements(content[START:], order):
        if kind == PACKED:
            try:
                packed = zlib.decompressobj()
                data = packed.decompress(data, LARGEST + 1)
                within(len(data), path)
                if not packed.eof:
                    raise zlib.error("it ends too early")
            except zlib.error as e:
                raise Broken(f"element {at}: {e}") from e
            kind, data, at = next(_elements(data, order), (0, b"", at))
        if kind != MATRIX:
            raise Broken(f"element {at} is of type {kind} and no variable")
        name, value = _matrix(data, order)
        found[name] = value
    return found


def _elements(data: bytes, order: str) -> Iterator[tuple[int, bytes, int]]:
    """Yield (type, data, where it begins) of a run of elements."""
    at = 0
    while at + 8 <= len(data):
        kind, size = struct.unpack_from(f"{order}II", data, at)
        start, step = at + 8, size if kind == PACKED else -(-size // 8) * 8
        if kind >> 16:  # type, size and up to four bytes of data in eight
            kind, size, start, step = kind & 0xFFFF, kind >> 16, at + 4, 4
        if start + size > len(data) or (start == at + 4 and size > 4):
            raise Broken(f"element {at} is not whole")
        yield kind, data[start : start + size], at
        at = start + step


def _matrix(data: bytes, order: str) -> tuple[str, object]:
    """Return (name, value) of the data of one matrix element."""
    parts = _elements(data, order)
    flags, shape = _integers(parts, UINT32, order), None
    if len(flags) != 2:
        raise Broken("a variable has no flags")
    kind = flags[0] & 0xFF
    if kind not in (1, STRUCT, 3, CHAR, 5, *NUMERIC):  # functions and new objects are laid out in another way
        return "", NO_NUMBERS
    shape = tuple(_integers(parts, INT32, order))
    name = _text(parts)
    if kind == STRUCT:
        return name, structure(parts, prod(shape), order)
    if kind == CHAR:
        return name, np.array("text")
    if kind not in NUMERIC:
        return name, NO_NUMBERS
    values = _numbers(parts, order)
    if min(shape, default=-1) < 0 or prod(shape) != values.size:
        raise Broken(f"'{name}' has {values.size} numbers for its dimensions {shape}")
    values = values.reshape(shape, order="F")
    return name, values.astype(complex) if flags[0] & COMPLEX else values


def structure(parts: Iterator, count: int, order: str) -> object:
    """Return dict of fields, or a list of them where there are more or fewer than one."""
    length = _integers(parts, INT32, order)
    joined = _part(parts, 1)
    if len(length) != 1 or length[0] <= 0 or count < 0 or len(joined) % length[0]:
        raise Broken("a structure's field names cannot be parted")
    names = [joined[k : k + length[0]].split(b"\0")[0].decode("latin-1") for k in range(0, len(joined), length[0])]
    if count > MOST:
        return [{}] * 2
    made = [
        {n: _matrix(d, order)[1] if (d := _part(parts, MATRIX)) else np.zeros(0) for n in names} for _ in range(count)
    ]
    return made[0] if count == 1 else made


def _part(parts: Iterator, wanted: int) -> bytes:
    kind, data, at = next(parts, (0, b"", 0))
    if kind != wanted:
        raise Broken(f"element {at} is of type {kind}, where {wanted} belongs")
    return data


def _integers(parts: Iterator, wanted: int, order: str) -> list[int]:
    data = _part(parts, wanted)
    if len(data) % 4:
        raise Broken("an integer is not whole")
    return np.frombuffer(data, np.dtype(NUMBERS[wanted]).newbyteorder(order)).tolist()


def _text(parts: Iterator) -> str:
    return _part(parts, 1).decode("latin-1")


def _numbers(parts: Iterator, order: str) -> np.ndarray:
    kind, data, at = next(parts, (0, b"", 0))
    dtype = np.dtype(NUMBERS.get(kind, "V1")).newbyteorder(order)
    if kind not in NUMBERS or len(data) % dtype.itemsize:
        raise Broken(f"element {at} is of type {kind} and holds no whole numbers")
    return np.frombuffer(data, dtype)

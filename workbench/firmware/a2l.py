"""ASAP2 (A2L 1.6) of a table: where each number lies, its unit and scale, for calibration tools.

A tool that changes a number has to write the table's CRC-32 again, else the firmware refuses it; the file says so.
"""

from workbench.firmware.document import formats
from workbench.firmware.image import FLOAT32, HEAD
from workbench.firmware.make import Firmware
from workbench.firmware.units import power_of, unit

HEADER = """ASAP2_VERSION 1 60
/* No licence is claimed on this file. After a change of any value the CRC-32 at the table's end has to be written again. */
/begin PROJECT {name} "Table of a law's firmware"
  /begin MODULE {name} "{law}"
    /begin MOD_COMMON ""
      BYTE_ORDER MSB_LAST
      ALIGNMENT_LONG 4
      ALIGNMENT_FLOAT32_IEEE 4
    /end MOD_COMMON
"""
FOOTER = """  /end MODULE
/end PROJECT
"""
METHOD = """    /begin COMPU_METHOD {name} "{said}" RAT_FUNC "%.9g" "{unit}"
      COEFFS 0 {factor} 0 0 0 1
    /end COMPU_METHOD
"""
LAYOUT = """    /begin RECORD_LAYOUT {name}
      {what} 1 {type} {order} DIRECT
    /end RECORD_LAYOUT
"""
VALUE = """    /begin CHARACTERISTIC {name} "{said}" VALUE 0x{address:08X} {layout} 0 {method} {low} {high}
    /end CHARACTERISTIC
"""
CURVE = """    /begin CHARACTERISTIC {name} "{said}" CURVE 0x{address:08X} {layout} 0 {method} {low} {high}
      /begin AXIS_DESCR COM_AXIS NO_INPUT_QUANTITY of_knots {count} {first} {last}
        AXIS_PTS_REF {axis}
      /end AXIS_DESCR
    /end CHARACTERISTIC
"""
AXIS = """    /begin AXIS_PTS {name} "knots at 2^e (1 + j/m)" 0x{address:08X} NO_INPUT_QUANTITY knots_float32 0 of_knots {count} {first} {last}
    /end AXIS_PTS
"""
KIND = {FLOAT32: ("FLOAT32_IEEE", -3.4e38, 3.4e38)}
INTEGER = ("SLONG", -(2**31), 2**31 - 1)


def a2l(made: Firmware, address: int = 0) -> str:
    """Return the A2L of a firmware's table that lies at `address`."""
    image, name = made.image, made.source.name
    kind, low, high = KIND.get(image.arithmetic, INTEGER)
    bits_of, columns = formats(made)
    text = [HEADER.format(name=name, law=f"{made.numbers.stages.law.name}, law code 0x{image.law:08X}")]
    text.append(LAYOUT.format(name="number", what="FNC_VALUES", type=kind, order="COLUMN_DIR"))
    text.append(LAYOUT.format(name="knots_float32", what="AXIS_PTS_X", type="FLOAT32_IEEE", order="INDEX_INCR"))
    x = "m" if image.motion else "rad"
    text.append(METHOD.format(name="of_knots", said="as it is", unit=x, factor=1))
    for i, (c, bits) in enumerate(zip(made.numbers.stages.constants, bits_of, strict=True)):
        ends = [v * 2.0 ** -(bits or 0) for v in (low, high)]
        text.append(_method(f"of_{c.identifier}", unit(c.power, made.source.effort), bits))
        text.append(
            VALUE.format(
                name=c.identifier, said=c.formula, address=address + HEAD.size + 4 * i, layout="number",
                method=f"of_{c.identifier}", low=ends[0], high=ends[1],
            )
        )  # fmt: skip
    knots_at = address + HEAD.size + 4 * image.constants.size
    if image.knots.size:
        text += _curves(made, knots_at, columns, (low, high))
    return "".join([*text, FOOTER])


def _method(name: str, said: str, bits: int | None) -> str:
    """A conversion: the integer is the value times 2^bits."""
    scale = "as it is" if bits is None else f"integer times 2^{-bits}"
    return METHOD.format(name=name, said=scale, unit=said, factor=repr(2.0 ** (bits or 0)))


def _curves(made: Firmware, knots_at: int, columns: list, ends: tuple) -> list[str]:
    """The knots, and each row over them."""
    image = made.image
    m = image.knots.size
    shape = {"count": m, "first": float(image.knots[0]), "last": float(image.knots[-1])}
    text = [AXIS.format(name="knots", address=knots_at, **shape)]
    rows = [
        (n, b, s)
        for n, b in zip(made.numbers.columns, columns, strict=True)
        for s in (("", "_slope") if b is None else ("",))
    ]
    for j, (name, bits, slope) in enumerate(rows):
        own = unit(power_of(f"gain.{name}"), made.source.effort)
        text.append(_method(f"of_{name}{slope}", f"({own})/{'m' if image.motion else 'rad'}" if slope else own, bits))
        low, high = (v * 2.0 ** -(bits or 0) for v in ends)
        text.append(
            CURVE.format(
                name=f"{name}{slope}", said="gain over amplitude" if not slope else "slope to the next knot",
                address=knots_at + 4 * m * (1 + j), layout="number", method=f"of_{name}{slope}", low=low, high=high,
                axis="knots", **shape,
            )
        )  # fmt: skip
    return text

"""Intel HEX of a table: records of 16 bytes, an extended linear address wherever the upper half changes."""

ROW = 16


def _record(kind: int, address: int, data: bytes) -> str:
    """One record: count, address, kind, data, and the two's complement of their sum."""
    body = bytes((len(data),)) + address.to_bytes(2, "big") + bytes((kind,)) + data
    return f":{(body + bytes((-sum(body) & 0xFF,))).hex().upper()}\n"


def intel_hex(data: bytes, address: int = 0) -> str:
    """Return the bytes as Intel HEX, from `address` on."""
    lines, upper, at = [], 0, 0
    while at < len(data):
        place = address + at
        if place >> 16 != upper:
            upper = place >> 16
            lines.append(_record(4, 0, upper.to_bytes(2, "big")))
        size = min(ROW - place % ROW, len(data) - at)
        lines.append(_record(0, place & 0xFFFF, data[at : at + size]))
        at += size
    return "".join([*lines, _record(1, 0, b"")])

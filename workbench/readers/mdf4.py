"""Whether the blocks of an MDF 4 file are whole, before asammdf follows them without looking.

It trusts what is written: a link in a circle holds it for ever, and a channel beyond its record ends the process.
"""

import struct

START = 64  # byte of the first block
# How many of a block's first links lead on: to the next of its kind, to what it holds, to its data.
LEADING = {b"HD": 2, b"FH": 1, b"DG": 3, b"CG": 2, b"CN": 2, b"CA": 1, b"HL": 1, b"DL": 1, b"LD": 1}
LEAST = {b"HD": 32, b"CG": 32, b"CN": 48}  # bytes after the links
VIRTUAL = (3, 6)  # kinds of channel that are computed, and stand nowhere in the record


def fault(content: bytes) -> str:
    """Return what is wrong with the tree of blocks, or "".

    Every link leads to a whole block; those that lead on, to each block once; a channel lies within its group's record.
    """
    seen, ahead = set(), [(START, 0)]
    while ahead:
        at, record = ahead.pop()
        if at in seen:
            return f"its links lead to byte {at} twice"
        seen.add(at)
        if wrong := _not_whole(content, at):
            return wrong
        kind, count = content[at + 2 : at + 4], struct.unpack_from("<Q", content, at + 16)[0]
        links = struct.unpack_from(f"<{count}Q", content, at + 24) if kind in LEADING else ()
        start = at + 24 + 8 * count
        if kind == b"CG":
            record = struct.unpack_from("<I", content, start + 24)[0]
        if kind == b"CN" and content[start] not in VIRTUAL:
            bit, byte, bits = struct.unpack_from("<3xBII", content, start)
            if 8 * byte + bit + bits > 8 * record:
                return f"the channel at byte {at} lies beyond its record"
        for link in filter(None, links):
            if wrong := _not_whole(content, link):
                return wrong
        ahead += [(link, record) for link in links[: LEADING.get(kind, 0)] if link]
    return ""


def _not_whole(content: bytes, at: int) -> str:
    """Return what is wrong with one block, or ""."""
    head = content[at : at + 24]
    if len(head) < 24 or not head.startswith(b"##"):
        return f"there is no block at byte {at}"
    size, count = struct.unpack("<QQ", head[8:])
    if size < 24 + 8 * count + LEAST.get(head[2:4], 0) or at + size > len(content):
        return f"the block at byte {at} is not whole"
    return ""

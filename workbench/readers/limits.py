"""How large a file may be when it is unpacked: a few packed megabytes may say a thousand times as much.

Half a gibibyte of text is three hours of five columns at 1 kHz, and takes some six times as much memory to read. Half of it
would refuse records of an afternoon; twice as much asks for more memory than an engineer's laptop has.
"""

import zipfile
import zlib
from io import BytesIO
from pathlib import Path

from workbench.errors import WorkbenchError

LARGEST = 2**29  # bytes


def within(size: float, path: Path) -> None:
    """Refuse what is larger than LARGEST bytes when it is unpacked."""
    if size > LARGEST:
        raise WorkbenchError(
            f"{path}: is more than {LARGEST >> 20} MiB when it is unpacked, the largest that is read; cut the record into "
            "shorter ones, or log fewer columns."
        )


def gunzipped(content: bytes, path: Path) -> bytes:
    """Return a gzip file of one or more members unpacked; WorkbenchError where it is broken or too large."""
    whole, rest = b"", content
    try:
        while rest:
            one = zlib.decompressobj(wbits=31)
            whole += one.decompress(rest, LARGEST + 1 - len(whole))
            within(len(whole), path)
            if not one.eof:
                raise zlib.error("it ends too early")
            rest = one.unused_data.lstrip(b"\0")  # what pads a member is none
    except zlib.error as e:
        raise WorkbenchError(f"{path}: is no whole gzip file ({e}); copy or pack it again.") from e
    return whole


def unzippable(content: bytes, path: Path) -> None:
    """Refuse a ZIP file (Excel, NPZ) whose members say that they are too large; zipfile.BadZipFile where it is none."""
    with zipfile.ZipFile(BytesIO(content)) as file:
        within(sum(member.file_size for member in file.infolist()), path)

"""Parquet and Feather files, by pyarrow. A column is a column, "struct.field" a field of one that holds structures."""

import io
from collections.abc import Mapping
from pathlib import Path

from workbench.errors import WorkbenchError
from workbench.readers.held import Held, Whole
from workbench.readers.limits import within
from workbench.readers.sheet import library

CELL = 8  # bytes of a number
UNITS = (b"unit", b"units")  # keys of a field's metadata


class Parquet(Whole):
    """See workbench.readers.Reader."""

    name = "parquet"
    suffixes = (".parquet", ".pq", ".feather")

    def held(self, content: bytes, path: Path) -> Mapping[str, Held]:
        library("pyarrow", "parquet", path)
        try:
            table = _parquet(content, path) if content.startswith(b"PAR1") else _feather(content, path)
            while any(str(f.type).startswith("struct<") for f in table.schema):
                table = table.flatten()
            return {
                f.name: Held(table.column(k).to_numpy(), next((_unit(f, key) for key in UNITS if _unit(f, key)), ""))
                for k, f in enumerate(table.schema)
            }
        except WorkbenchError:
            raise
        except Exception as e:  # pyarrow raises whatever broken bytes lead to
            reason = " ".join(str(e).split())[:120] or type(e).__name__
            raise WorkbenchError(
                f"{path}: is no whole Parquet or Feather file ({reason}); write or copy it again."
            ) from e


def _parquet(content: bytes, path: Path):
    import pyarrow.parquet

    file = pyarrow.parquet.ParquetFile(io.BytesIO(content))
    within(CELL * file.metadata.num_rows * file.metadata.num_columns, path)
    return file.read()


def _feather(content: bytes, path: Path):
    import pyarrow.feather

    within(4 * len(content), path)  # its batches are packed by LZ4, which makes about a quarter of numbers
    return pyarrow.feather.read_table(io.BytesIO(content))


def _unit(field, key: bytes) -> str:
    return (field.metadata or {}).get(key, b"").decode("utf-8", "replace")

"""JSON files: lists of numbers by name, records, and one record a line.

Read are {"t": [...], "i": [...]}, nested or not; {"name": "i", "unit": "A", "values": [...]} anywhere; {"columns": [...],
"data": [[...]]} and {"t": {"0": ...}} as pandas writes them; [{"t": ..., "i": ...}, ...] and the same a line each.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from workbench.errors import WorkbenchError
from workbench.readers.flat import flattened
from workbench.readers.held import Held, Whole

VALUES, UNITS, TITLES = ("values", "data", "samples"), ("unit", "units"), ("name", "label", "id")
MISSING = float("nan")  # of a record that lacks a key, so that the column is refused there with its sample


class Json(Whole):
    """See workbench.readers.Reader."""

    name = "json"
    suffixes = (".json", ".jsonl", ".ndjson")

    def held(self, content: bytes, path: Path) -> Mapping[str, Held]:
        try:
            text = content.decode("utf-8-sig")
            top = _top(text)
        except (ValueError, RecursionError) as e:
            reason = " ".join(str(e).split())[:120]
            raise WorkbenchError(f"{path}: is no whole JSON file ({reason}); export the record again.") from e
        found = dict(_found(top, ""))
        if not found:
            raise WorkbenchError(f"{path}: holds neither lists of numbers nor records; export it as one of them.")
        return found


def _top(text: str) -> object:
    try:
        return json.loads(text)
    except ValueError as e:
        if "Extra data" not in str(e):
            raise
        return [json.loads(line) for line in text.splitlines() if line.strip()]


def _found(value: object, at: str):
    """Yield (name, Held) of every column in a value."""
    if isinstance(value, Mapping):
        yield from _of_mapping(value, at)
    elif _many(value) and isinstance(value[0], Mapping) and _key(value[0], VALUES) is None:
        yield from _records(value, at)
    elif _many(value) and isinstance(value[0], Mapping):
        for one in value:
            yield from _found(one, at)
    elif _many(value) and _many(value[0]):
        for k, column in enumerate(zip(*value, strict=False), 1):
            yield (f"{at}(:,{k})" if at else f"column {k}"), Held(list(column))
    elif _many(value) and len(value) > 1:
        yield at or "column 1", Held([MISSING if v is None else v for v in value])


def _of_mapping(value: Mapping, at: str):
    rows, columns = value.get("data"), value.get("columns")
    if _many(rows) and _many(columns) and _many(rows[0]) and len(rows[0]) == len(columns):
        yield from _records([dict(zip(columns, row, strict=False)) for row in rows], at)
        return
    key = _key(value, VALUES)
    title = next((str(value[k]) for k in TITLES if isinstance(value.get(k), str)), "")
    if key and title and _many(value[key]):
        unit = next((str(value[k]) for k in UNITS if isinstance(value.get(k), str)), "")
        yield (f"{at}.{title}" if at else title), Held(value[key], unit)
        return
    if value and all(str(k).isdigit() for k in value):  # pandas: row -> value
        yield at, Held([value[k] for k in sorted(value, key=int)])
        return
    for name, inner in value.items():
        deeper = at if name in ("channels", "signals", "columns", "data", "records", "samples") else _joined(at, name)
        yield from _found(inner, deeper)


def _records(rows: Sequence[object], at: str = ""):
    """Yield (name, Held) of the columns of records, one a sample."""
    flat = [flattened(row) for row in rows]
    for name in dict.fromkeys(n for row in flat for n in row):
        values = [row.get(name, MISSING) for row in flat]
        yield _joined(at, name), Held([MISSING if v is None else v for v in values])


def _joined(at: str, name: str) -> str:
    return f"{at}.{name}" if at else name


def _many(value: object) -> bool:
    return isinstance(value, list) and len(value) > 0


def _key(value: Mapping, keys: Sequence[str]) -> str | None:
    return next((k for k in keys if k in value), None)

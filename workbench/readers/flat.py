"""Nested records (JSON, messages of ROS) as columns: "position.q7", "header.stamp"."""

from collections.abc import Mapping, Sequence
from numbers import Number

NAMES = ("name", "names", "joint_names")  # lists beside the values, that say whose each is
STAMP = {"sec", "nanosec"}


def flattened(record: object, at: str = "") -> dict[str, object]:
    """Return path -> number or text of one record; lists are counted from 0 ("axis[0]") or called by the names beside them."""
    if isinstance(record, Mapping):
        return _mapping(record, at)
    slots = getattr(type(record), "__slots__", None)
    if slots and not isinstance(record, (str, bytes, Number)):
        return _mapping({n: getattr(record, n) for n in slots if not n.startswith("_")}, at)
    if hasattr(record, "tolist"):
        record = record.tolist()
    if isinstance(record, Sequence) and not isinstance(record, (str, bytes)):
        found = {}
        for k, value in enumerate(record):
            found |= flattened(value, f"{at}[{k}]")
        return found
    return {at: record}


def _mapping(record: Mapping, at: str) -> dict[str, object]:
    if set(record) == STAMP:
        return {at: record["sec"] + 1e-9 * record["nanosec"]}
    names = next((list(record[n]) for n in NAMES if n in record and _texts(record[n])), [])
    found: dict[str, object] = {}
    for key, value in record.items():
        inner = f"{at}.{key}" if at else str(key)
        many = isinstance(value, Sequence) and not isinstance(value, (str, bytes))
        if many and names and len(value) == len(names):
            if list(value) != names:
                for name, one in zip(names, value, strict=True):
                    found |= flattened(one, f"{inner}.{name}")
        else:
            found |= flattened(value, inner)
    return found


def _texts(value: object) -> bool:
    many = isinstance(value, Sequence) and not isinstance(value, (str, bytes)) and len(value) > 0
    return many and all(isinstance(v, str) for v in value)

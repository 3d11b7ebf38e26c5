"""What an engineer declares in TOML, with every access checked: the sentence names the file and the key."""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from math import inf, isfinite
from pathlib import Path

from workbench.errors import WorkbenchError, nearest
from workbench.readers.files import regular
from workbench.units import to_si

KINDS = {bool: "true or false", int: "a number", float: "a number", str: "a text", dict: "a table", list: "a list"}


class Table:
    """One table of a declaration.

    file and keys: where it stands ("effect 2 'inertia', parameters"), as sentences name it. Keys that are neither in
    `required` nor in `optional` are refused with the nearest names, and so is a required key that is absent.
    """

    def __init__(
        self, values: object, file: str, keys: str = "", required: Sequence[str] = (), optional: Sequence[str] = ()
    ):
        self.file, self.keys = file, keys
        self.where = f"{file}: {keys.removesuffix(',')}" if keys else file
        self.values: Mapping[str, object] = self._typed(values, dict, self.where, "a table")
        for key in self.values:
            if key not in (*required, *optional):
                raise WorkbenchError(f"{self.where}: unknown key '{key}'; {nearest(key, (*required, *optional))}")
        for key in required:
            if key not in self.values:
                raise WorkbenchError(f"{self.where}: key '{key}' is missing; add it.")

    def __contains__(self, key: str) -> bool:
        return key in self.values

    def path(self, key: str) -> str:
        """Return file and key path of one of this table's keys."""
        return f"{self.file}: {self._inner(key)}"

    def _inner(self, key):
        # An item of a list ends with a comma: "effect 2 'inertia', at".
        joint = " " if self.keys.endswith(",") else "."
        return f"{self.keys}{joint}{key}" if self.keys else key

    def _typed(self, value, kind, where, need):
        # A boolean is an integer to Python, and is none to an engineer.
        if isinstance(value, kind) and not (isinstance(value, bool) and kind is not bool):
            return value
        given = f"the text '{value[:40]}'" if isinstance(value, str) else KINDS.get(type(value), "a date or time")
        hint = " without quotes" if isinstance(value, str) and kind == (int, float) else ""
        raise WorkbenchError(f"{where} is {given}; {need} is needed{hint}.")

    def text(self, key: str, default: str = "") -> str:
        """Return a text, or `default` where the key is absent."""
        found = self._typed(self.values.get(key, default), str, self.path(key), "a text in quotes")
        if "\0" in found:
            raise WorkbenchError(f"{self.path(key)} holds a null character; take it out.")
        return found

    def flag(self, key: str, default: bool = False) -> bool:
        """Return true or false, or `default` where the key is absent."""
        return self._typed(self.values.get(key, default), bool, self.path(key), "true or false")

    def number(self, key: str, default: float | None = None, *, above: float = -inf) -> float:
        """Return a finite number larger than `above`, or `default` where the key is absent."""
        value = self._typed(self.values.get(key, default), (int, float), self.path(key), "a number")
        try:
            value = float(value)
        except OverflowError:
            value = inf
        if not isfinite(value):
            raise WorkbenchError(f"{self.path(key)} is {value}; a finite number is needed.")
        if not value > above:
            raise WorkbenchError(f"{self.path(key)} is {value:g}; a number larger than {above:g} is needed.")
        return value

    def quantity(self, key: str, expected: str, *, above: float = -inf, optional: Sequence[str] = ()) -> float:
        """Return { value = ..., unit = "..." } in the SI unit `expected`."""
        hint = f'{{ value = ..., unit = "{expected}" }}'
        if not isinstance(self.values[key], dict):
            raise WorkbenchError(f"{self.path(key)} has no unit; write {hint}.")
        pair = self.table(key, ("value", "unit"), optional)
        value = to_si(pair.number("value"), pair.text("unit"), expected, pair.path("unit"))
        if not value > above:
            raise WorkbenchError(f"{pair.path('value')} is {value:g} {expected}; more than {above:g} is needed.")
        return value

    def numbers(self, key: str, default: tuple[float, ...], unit: str | None = None) -> tuple[float, ...]:
        """Return a list of numbers, or { values = [...], unit = "..." } in SI where the numbers have one; `default` where it is absent."""
        if key not in self:
            return default
        if unit is not None:
            inner = self.table(key, ("values", "unit"))
            return tuple(to_si(v, inner.text("unit"), unit, inner.path("unit")) for v in inner.numbers("values", ()))
        found = self.values[key]
        if not (isinstance(found, list) and found) or any(
            isinstance(v, bool) or not isinstance(v, (int, float)) for v in found
        ):
            raise WorkbenchError(f"{self.path(key)} must be a list of numbers, such as [1.0, 1.5].")
        return tuple(float(v) for v in found)

    def names(self, key: str) -> tuple[str, ...]:
        """Return a list of names in quotes, empty where the key is absent."""
        found = self.values.get(key, [])
        if not isinstance(found, list) or not all(isinstance(n, str) for n in found):
            raise WorkbenchError(f"{self.path(key)} must be a list of names in quotes.")
        return tuple(found)

    def choice(self, key: str, names: Sequence[str], what: str) -> str:
        """Return one of `names`; the nearest are in the sentence otherwise."""
        name = self.text(key)
        if name not in names:
            raise WorkbenchError(f"{self.path(key)}: unknown {what} '{name}'; {nearest(name, names)}")
        return name

    def table(self, key: str, required: Sequence[str] = (), optional: Sequence[str] = ()) -> "Table":
        """Return the table of a key, empty where it is absent."""
        return Table(self.values.get(key, {}), self.file, self._inner(key), required, optional)

    def named(self, key: str) -> "Table":
        """Return the table of a key whose own keys are names of its writer's choice, empty where it is absent."""
        values = self.values.get(key, {})
        return self.table(key, optional=tuple(values) if isinstance(values, dict) else ())

    def tables(
        self, key: str, named: str, required: Sequence[str] = (), optional: Sequence[str] = ()
    ) -> Iterator["Table"]:
        """Yield the tables of [[key]]; sentences name each by its number from 1 and by the text of its key `named`."""
        items = self._typed(self.values.get(key, []), list, self.path(key), f"a list of tables, [[{key}]],")
        for k, item in enumerate(items, 1):
            name = item.get(named, "") if isinstance(item, dict) else ""
            keys = f"{key.removesuffix('s')} {k}" + (f" '{name}'" if name and isinstance(name, str) else "")
            yield Table(item, self.file, f"{keys},", required, optional)


def read(path: Path, required: Sequence[str], optional: Sequence[str]) -> Table:
    """Return the top table of a TOML file; WorkbenchError with file and line where it is missing or is no TOML."""
    try:
        content = regular(path).read_bytes()
    except (OSError, ValueError) as e:
        reason = getattr(e, "strerror", None) or e
        raise WorkbenchError(f"{path}: cannot be read ({reason}); the folder needs a readable {path.name}.") from e
    try:
        return Table(tomllib.loads(content.decode("utf-8-sig")), str(path), "", required, optional)
    except UnicodeDecodeError as e:
        line = content[: e.start].count(b"\n") + 1
        raise WorkbenchError(f"{path}, line {line}: is not UTF-8 text; save the file as UTF-8.") from e
    except (ValueError, RecursionError) as e:  # ValueError: TOMLDecodeError, and an integer of too many digits
        raise WorkbenchError(f"{path}: is no valid TOML: {e}; mend it there.") from e

"""docs/types.md, from the code: every value that passes from one package to another, with its fields.

    python tools/type_table.py > docs/types.md

Nothing is imported: the files are read. Listed is a public dataclass that a file outside of its own package asks for.
"""

import ast
import re
from collections.abc import Iterator

from layers import PACKAGE, layers, room

HEAD = """# Types

Written by `python tools/type_table.py > docs/types.md` from the code, as the catalogue is: each value that passes from one
package to another, with its fields and what it is. Nearly all are frozen: a change is a new value (`dataclasses.replace`).
"""


def asked() -> dict[str, set[str]]:
    """Return name -> the packages that import it from another one."""
    found: dict[str, set[str]] = {}
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("workbench."):
                source = node.module.split(".")[1]
                if source != room(path):
                    for alias in node.names:
                        found.setdefault(f"{source}.{alias.name}", set()).add(room(path))
    return found


def is_data(node: ast.stmt) -> bool:
    """Whether a statement defines a public dataclass."""
    if not isinstance(node, ast.ClassDef) or node.name.startswith("_"):
        return False
    names = (d.func if isinstance(d, ast.Call) else d for d in node.decorator_list)
    return any(getattr(n, "id", "") == "dataclass" for n in names)


def fields(node: ast.ClassDef) -> list[str]:
    return [s.target.id for s in node.body if isinstance(s, ast.AnnAssign) and not s.target.id.startswith("_")]


def first(node: ast.ClassDef) -> str:
    """Return what its docstring says first: a sentence, or a line of "field: meaning"."""
    text = " ".join((ast.get_docstring(node) or "").partition("\n\n")[0].split())
    return re.split(r"(?<=[.;]) (?=[A-Za-z_, ]+:|[A-Z])", text)[0].removeprefix("See the module.").strip()


def types() -> Iterator[tuple[int, str, str]]:
    """Yield (layer, package, line) of every type that is listed."""
    order, wanted = layers(), asked()
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if is_data(node) and f"{room(path)}.{node.name}" in wanted and fields(node):
                yield (
                    order[room(path)],
                    room(path),
                    f"- **{node.name}**({', '.join(fields(node))}) {first(node)}".rstrip(),
                )


def page() -> str:
    """Return the whole page, packages by layer."""
    lines, last = [HEAD], None
    for layer, package, line in sorted(types(), key=lambda t: t[:2]):
        if package != last:
            lines.append(f"{'' if last is None else chr(10)}## {package} (layer {layer})\n")
            last = package
        lines.append(line)
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(page(), end="")

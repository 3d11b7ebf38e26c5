"""The layers of the package, as the table of docs/architecture.md states them: the one place that does."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "workbench"


def layers() -> dict[str, int]:
    """Return the layer of each module and package."""
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d+) \| (.+?) \|", text, flags=re.MULTILINE)
    return {name: int(layer) for layer, cell in rows for name in re.findall(r"`(\w+)/?`", cell)}


def room(path: Path) -> str:
    """Return the module or package directly under workbench/ that a file belongs to, as the table names it."""
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")

"""diff.json."""

import json
from dataclasses import asdict
from pathlib import Path

from workbench.difference.changes import Difference

JSON = "diff.json"


def write(folder: Path, before: str, after: str, found: Difference) -> None:
    """Write diff.json into an existing folder. before, after: titles of the campaigns."""
    content = {
        "format": 1,
        "before": before,
        "after": after,
        "sentence": found.sentence,
        "chance_together": found.together,
        "changes": [asdict(c) for c in found.changes],
        "undetermined": list(found.undetermined),
        "doubts": [f.sentence for f in found.findings],
    }
    text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False)
    (folder / JSON).write_text(text + "\n", encoding="utf-8")

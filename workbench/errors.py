"""Errors that a user can mend: one sentence that says what is wrong, where, and what would mend it."""

import difflib
import os
from collections.abc import Iterable

USER_ERROR = 2
INTERNAL_ERROR = 70  # EX_SOFTWARE of sysexits.h: our failure, not the user's


class WorkbenchError(Exception):
    """Something that the user can mend. The message is a whole sentence; no traceback is shown for it."""


class UnsoundRecord(WorkbenchError):
    """A record that cannot be used as it was measured. kind: as a Finding sorts it. record: which."""

    def __init__(self, sentence: str, kind: str, record: str):
        super().__init__(sentence)
        self.kind, self.record = kind, record


def mishap(error: BaseException) -> str:
    """Return what the system says of a failure, with the file where it names one: "No space left on device (out/a.csv)"."""
    said = getattr(error, "strerror", None) or str(error).rstrip(".") or type(error).__name__
    file = getattr(error, "filename", None)
    return f"{said} ({os.fsdecode(file) if isinstance(file, bytes) else file})" if file is not None else said


def nearest(name: str, names: Iterable[str], most: int = 3) -> str:
    """Return the names closest to `name` as a clause, "did you mean 'a' or 'b'?", or the whole list where none is close."""
    names = sorted(set(names))
    folded = {n.casefold(): n for n in names}
    close = [folded[c] for c in difflib.get_close_matches(name.casefold(), folded, n=most, cutoff=0.5)]
    if close:
        return "did you mean " + " or ".join(f"'{c}'" for c in close) + "?"
    return "known: " + (", ".join(names) if names else "none") + "."

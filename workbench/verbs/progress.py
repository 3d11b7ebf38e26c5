"""Progress on stderr, where a command takes long enough for somebody to wonder: what is done, which share, how long still.

How long the parts of a command take is remembered from the last time that it came to its end, for each study; the first
time SHARES stands for it. On a terminal it is one line that is written anew; elsewhere it is one line, once.
"""

import contextlib
import hashlib
import json
import re
import shutil
import sys
import threading
import time
from pathlib import Path

from workbench.verbs.shares import SHARES

QUIET = 2.0  # s, before progress is shown
TICK = 0.5  # s, after which a line is written anew although nothing new is said
OFTEN = 0.2  # s, between two states of the line on a terminal
EARLY = 0.03  # share from which on the remaining time is worth a number
NUMBER = re.compile(r"\d+(?:\.\d+)?")
OF = re.compile(r"(\d+) of (\d+)")


def kind(what: str) -> str:
    """Return what is said without its numbers, by which it is known again."""
    return NUMBER.sub("#", what)


class Progress:
    """Says on stderr what is being done, once it has taken longer than QUIET seconds. A context: the line goes at its end.

    verb: of the command. name: of what it works on, under which its times are remembered; "" to remember nothing.
    """

    def __init__(self, verb: str = "", name: str = ""):
        self.start, self.said, self.at, self.share = time.monotonic(), 0.0, 0, 0.0
        self.terminal = sys.stderr.isatty()
        self.heard: list[tuple[str, float]] = []
        self.file = _times(verb, name) if name else None
        self.known = remembered(self.file) or SHARES.get(verb, [])
        self.shown, self.what, self.ended = False, "", threading.Event()

    def __enter__(self) -> "Progress":
        threading.Thread(target=self._tick, daemon=True).start()
        return self

    def __exit__(self, raised, *_) -> None:
        self.ended.set()
        self.clear()
        if raised is None and self.file is not None and self.passed > QUIET:
            _remember(self.file, self.heard, self.passed)

    @property
    def passed(self) -> float:
        """Seconds since the command began."""
        return time.monotonic() - self.start

    def __call__(self, what: str) -> None:
        passed = self.passed
        self.heard.append((kind(what), passed))
        self.what = what
        self._follow(what)
        self._show()

    def _show(self) -> None:
        """Show where this is, where it is time to."""
        passed = self.passed
        if passed > QUIET and (passed > self.said + OFTEN if self.terminal else not self.shown):
            self.said, self.shown = passed, True
            line = f"{passed:5.1f} s  {self._done(passed)}{self.what}"
            wide = shutil.get_terminal_size().columns - 1
            said = f"\r\x1b[K{line[:wide]}" if self.terminal else f"{line}\n"
            print(said, end="", file=sys.stderr, flush=True)

    def _tick(self) -> None:
        """Show it although nothing is said for long: a step may be one call."""
        while not self.ended.wait(TICK):
            if self.what:
                self._show()

    def plainly(self, sentence: str) -> None:
        """Say a whole sentence that stays."""
        self.clear()
        print(f"workbench: {sentence}", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Take the line away, before something else is printed."""
        self.what = ""
        if self.shown and self.terminal:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)

    def _follow(self, what: str) -> None:
        """Find where in the known course this is; what is not in it changes nothing, and the share never falls."""
        name = kind(what)
        found = next((k for k in range(self.at, len(self.known)) if self.known[k][0] == name), None)
        if found is None:
            return
        self.at, share = found, self.known[found][1]
        if counted := OF.search(what):
            done, whole = map(int, counted.groups())
            after = next((s for n, s in self.known[found:] if n != name), 1.0)
            share += (after - share) * min(done / max(whole, 1), 1.0)
        self.share = max(self.share, share)

    def _done(self, passed: float) -> str:
        """Return the share and the remaining time as words, "" where nothing is known of them."""
        if self.share < EARLY:
            return ""
        left = passed * (1.0 - self.share) / self.share
        return f"{100 * self.share:.0f} %, about {spoken(left)} still  "


def spoken(seconds: float) -> str:
    """Return a time as one says it: to a second below ten, else to two figures."""
    if seconds < 90.0:
        return f"{max(seconds, 1.0):.0f} s" if seconds < 10.0 else f"{5 * round(seconds / 5):.0f} s"
    return f"{seconds / 60.0:.0f} min"


def _times(verb: str, name: str) -> Path:
    """Return the file that remembers how long the parts of a command take."""
    from workbench.kernel.cache import folder

    return folder() / "times" / f"{hashlib.sha256(f'{verb} {Path(name).absolute()}'.encode()).hexdigest()[:20]}.json"


def remembered(file: Path | None) -> list[tuple[str, float]]:
    """Return (what is said, share of the whole when it is) in their order; empty where nothing is remembered."""
    try:
        return [(str(name), min(max(float(share), 0.0), 1.0)) for name, share in json.loads(file.read_text())]
    except (OSError, ValueError, TypeError, AttributeError):
        return []


def _remember(file: Path, heard: list[tuple[str, float]], whole: float) -> None:
    """Remember when which thing was said first; what cannot be written is forgotten."""
    from workbench.kernel.cache import write_whole

    first = [(n, t / whole) for k, (n, t) in enumerate(heard) if k == 0 or heard[k - 1][0] != n]
    with contextlib.suppress(OSError):
        write_whole(file, json.dumps(first))

"""Progress on stderr, where a command takes long enough for somebody to wonder."""

import sys
import time

QUIET = 2.0  # s, before progress is shown


class Progress:
    """Says on stderr what is being done, once it has taken longer than QUIET seconds, a line a second at most."""

    def __init__(self):
        self.start = time.monotonic()
        self.said = QUIET - 1.0

    def __call__(self, what: str) -> None:
        passed = time.monotonic() - self.start
        if passed > self.said + 1.0:
            self.said = passed
            print(f"{passed:5.1f} s  {what}", file=sys.stderr, flush=True)

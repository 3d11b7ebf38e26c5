"""Cases on this machine: blocks side by side, one a process."""

from collections.abc import Callable, Iterator

from workbench.keeping import steps
from workbench.robustness.workload import Block, Columns, Work


def on_cores(given: Work, parts: list[Block], say: Callable[[str], None] = lambda _: None) -> Iterator[Columns]:
    """Yield the columns of each block, in order."""
    made = steps("draws", given.columns, parts)
    for block in parts:
        say(f"case {block.first} of {parts[-1].first + parts[-1].count}")
        yield next(made)

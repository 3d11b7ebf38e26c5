"""Cases on this machine: a block after another, whose lanes share the cores."""

from collections.abc import Callable, Iterator
from functools import partial

from workbench.keeping import step
from workbench.robustness.workload import Block, Columns, Work


def on_threads(given: Work, parts: list[Block], say: Callable[[str], None] = lambda _: None) -> Iterator[Columns]:
    """Yield the columns of each block, in order."""
    for block in parts:
        say(f"case {block.first} of {parts[-1].first + parts[-1].count}")
        yield step("draws", partial(given.columns, block))

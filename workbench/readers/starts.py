"""What a note says of the state in which records start."""

import re

# of friction that remembers nothing
RELAXED = re.compile(r"(?<!not )(?<!not yet )\b(relaxed|virgin|unloaded)\b", re.IGNORECASE)


def promised(initial_condition: str) -> bool:
    """Whether a note promises that records start with friction relaxed; "at rest" alone does not, for friction holds what came before."""
    return bool(RELAXED.search(initial_condition))

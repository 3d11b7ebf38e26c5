"""Median times of calls, and the CPU time of forks as well."""

import os
from collections.abc import Callable
from statistics import median
from time import perf_counter


def cpu() -> float:
    """CPU time in s of this process and of those that it has ended."""
    return sum(os.times()[:4])


def milliseconds(call: Callable[[], object], repeats: int = 21) -> float:
    """Median time of a call, after one that is not counted (the first compiles)."""
    call()
    times = []
    for _ in range(repeats):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return 1e3 * median(times)

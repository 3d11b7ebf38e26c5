"""One BLAS thread in every fit: two give other last bits, and on a busy machine they are slower by orders."""

import sys
from functools import wraps

_known: list = [
    0,
    None,
]  # how many modules were loaded when the process's BLAS libraries were looked for, and what was found
_under: list[int] = []  # the same, of every call that is under way with one thread


def one_thread(function):
    """Decorator: run with BLAS limited to one thread, so that results do not depend on the number of cores.

    To look for the libraries takes 2 ms, and small matrices' exponentials are asked for thousands of times: it is done again only
    where a module was loaded since, and not at all within a call that is limited already.
    """

    @wraps(function)
    def limited(*args, **kwargs):
        if _under and _under[-1] == len(sys.modules):
            return function(*args, **kwargs)
        with _controller().limit(limits=1, user_api="blas"):
            _under.append(len(sys.modules))
            try:
                return function(*args, **kwargs)
            finally:
                _under.pop()

    return limited


def _controller():
    """Return what limits the threads of every BLAS library that is loaded."""
    from threadpoolctl import ThreadpoolController

    if _known[0] != len(sys.modules):
        _known[:] = len(sys.modules), ThreadpoolController()
    return _known[1]

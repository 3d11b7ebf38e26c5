"""One BLAS thread in every fit: two give other last bits, and on a busy machine they are slower by orders."""

from functools import wraps


def one_thread(function):
    """Decorator: run with BLAS limited to one thread, so that results do not depend on the number of cores."""

    @wraps(function)
    def limited(*args, **kwargs):
        from threadpoolctl import threadpool_limits

        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited

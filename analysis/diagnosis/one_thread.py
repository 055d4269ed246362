"""Linear algebra on one thread: matrices here are small, and simulations take the other cores."""

from contextlib import AbstractContextManager


def one_thread_each() -> AbstractContextManager[object]:
    """Small matrices are slower on many threads, and slowest where those are wanted elsewhere."""
    import scipy.linalg  # noqa: F401  # its own library must be there to be limited
    from threadpoolctl import threadpool_limits

    limits: AbstractContextManager[object] = threadpool_limits(1)
    return limits

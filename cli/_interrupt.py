"""Treat Ctrl-C and SIGTERM as requests to stop that survive even if a library swallows KeyboardInterrupt."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager

SIGNALS = (signal.SIGINT, signal.SIGTERM)
"""Signals that stop a command: SIGINT from Ctrl-C, and SIGTERM from batch systems and `kill`."""


@contextmanager
def stop_signals(raises: bool) -> Iterator[Callable[[], int]]:
    """Yield a function that returns the exit code if a stop signal has arrived, and 0 otherwise.

    Args:
        raises: whether the first signal also raises KeyboardInterrupt, in order to end a wait. Later signals never
            raise it, so that they cannot interrupt the cleanup.
    """
    exit_code = 0

    def stop(number: int, _: object) -> None:
        nonlocal exit_code
        first, exit_code = not exit_code, exit_code or 128 + number
        if raises and first:
            raise KeyboardInterrupt

    before = {number: signal.signal(number, stop) for number in SIGNALS}
    try:
        yield lambda: exit_code
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)

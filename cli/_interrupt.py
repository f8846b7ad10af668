"""Ctrl-C as a request to stop that is never lost, even if a library swallows KeyboardInterrupt."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager

EXIT_CODE = 130


@contextmanager
def ctrl_c(raises: bool) -> Iterator[Callable[[], bool]]:
    """Yield a function that returns whether Ctrl-C has been pressed since then.

    Args:
        raises: whether the first Ctrl-C also raises KeyboardInterrupt, which ends a wait; later ones do not interrupt
            the cleanup.
    """
    pressed = False

    def press(*_: object) -> None:
        nonlocal pressed
        first, pressed = not pressed, True
        if raises and first:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, press)
    try:
        yield lambda: pressed
    finally:
        signal.signal(signal.SIGINT, before)

"""Ctrl-C: a request to stop that is never lost, however deep in another package it arrives."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager

EXIT_CODE = 130


@contextmanager
def ctrl_c(raises: bool) -> Iterator[Callable[[], bool]]:
    """Yield the function that tells whether Ctrl-C has been pressed since.

    raises: whether the first Ctrl-C raises KeyboardInterrupt as well, so that what waits ends; later ones do not
    disturb what is then tidied up.
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

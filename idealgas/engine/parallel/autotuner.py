"""Automatic choice between several threads and one thread, based on the time per event that each took most recently."""

import time

RETRY_AFTER = 20
"""The slower choice is tried again after this multiple of the duration of the last slice."""


class ThreadAutotuner:
    """Chooses whichever is currently faster: several threads or one thread."""

    def __init__(self) -> None:
        """Begin without a measurement."""
        self._cost: dict[bool, float] = {}  # seconds per event
        self._retry_at = 0.0  # time at which to try the slower choice again

    def use_threads(self) -> bool:
        """Whether to use several threads; from time to time, the slower choice is tried for one slice."""
        if self.undecided:
            return False in self._cost
        return self._faster if time.perf_counter() < self._retry_at else not self._faster

    @property
    def undecided(self) -> bool:
        """Whether one of the two choices has not been tried yet."""
        return len(self._cost) < 2

    def is_trial(self, shared: bool) -> bool:
        """Whether a slice serves to measure the speed of a choice; shared: whether several threads share the slice."""
        return self.undecided or shared != self._faster

    def note(self, shared: bool, events: int, seconds: float) -> None:
        """Record the duration of a slice; shared: whether several threads shared it."""
        if events > 0:
            trial = self.is_trial(shared)
            self._cost[shared] = seconds / events
            if trial or self.is_trial(shared):  # in the second case, this choice was the faster one until now
                self._retry_at = time.perf_counter() + RETRY_AFTER * seconds

    @property
    def _faster(self) -> bool:
        """Whether several threads were at least as fast as one thread when each was last used."""
        return self._cost[True] <= self._cost[False]

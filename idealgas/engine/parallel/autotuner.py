"""Whether several threads or one are the faster way to go on, by what each took the last time."""

import time

PATIENCE = 20
"""After so many times what a slice took the way that was the slower one, that way is tried again."""


class Race:
    """Which way is the faster one at the moment: with several threads, or with one."""

    def __init__(self) -> None:
        """Know nothing of either."""
        self._cost: dict[bool, float] = {}  # seconds an event
        self._again = 0.0  # when the slower way is to be tried again

    def shares(self) -> bool:
        """Whether several threads are to go on. The slower way is tried now and then, at a small part of the time."""
        if self.open:
            return False in self._cost
        return self._faster if time.perf_counter() < self._again else not self._faster

    @property
    def open(self) -> bool:
        """Whether one of the ways was not taken yet."""
        return len(self._cost) < 2

    def is_trial(self, shared: bool) -> bool:
        """Whether a slice on one way is to show what that takes, as far as is known."""
        return self.open or shared != self._faster

    def note(self, shared: bool, events: int, seconds: float) -> None:
        """Take note of a slice."""
        if events > 0:
            trial = self.is_trial(shared)
            self._cost[shared] = seconds / events
            if trial or self.is_trial(shared):  # or it was the faster way, and is no longer
                self._again = time.perf_counter() + PATIENCE * seconds

    @property
    def _faster(self) -> bool:
        """Whether several threads were faster, each way the last time that it was taken."""
        return self._cost[True] <= self._cost[False]

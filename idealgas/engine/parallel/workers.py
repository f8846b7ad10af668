"""The threads of a run, and the reasons why a slice that they share is aborted."""

from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait

from idealgas.columns import EVENT_COLUMNS, EventBatch, empty_batch
from idealgas.engine.parallel.autotuner import ThreadAutotuner
from idealgas.engine.parallel.slabs import DEFAULT_TUNING, Tuning
from idealgas.engine.parallel.subdomain import CLOCK, FAILED, FULL, TIE, VIOLATION

REASONS = {VIOLATION: "causality", TIE: "tie", FULL: "full", CLOCK: "clock", FAILED: "error"}
"""Names of the reasons for which a slice is aborted."""

STOP = "stop"
"""A further reason: the slice exceeded a limit on the number of events."""


class Workers:
    """Threads, memory and measurements that are kept for the whole run.

    Attributes:
        counts: numbers of shared slices, of aborted slices by reason, and of migrations and their side effects.
        rate: rates of all events and of collisions of two discs in the last slice, 1/time; None before the first slice.
        autotuner: choice between several threads and one thread; None to always use several threads.
    """

    def __init__(self, tuning: Tuning = DEFAULT_TUNING) -> None:
        """Begin without threads."""
        self.tuning = tuning
        self.autotuner = ThreadAutotuner() if tuning.autotune else None
        self.counts: Counter[str] = Counter()
        self.rate: tuple[float, float] | None = None
        self._pool: ThreadPoolExecutor | None = None
        self._rows: EventBatch | None = None

    @property
    def aborted(self) -> int:
        """Number of aborted slices in the run so far."""
        return sum(self.counts[why] for why in (*REASONS.values(), STOP))

    def memory(self, batch: EventBatch | None, slabs: int) -> EventBatch | None:
        """Memory for the rows of all slabs, in equal parts, with the columns of a batch; None without a log."""
        if batch is None:
            return None
        rows = self.tuning.buffer * slabs
        if self._rows is None or len(self._rows.time) != rows:
            self._rows = empty_batch(rows, [c for c in EVENT_COLUMNS if getattr(batch, c.name) is not None])
        return self._rows

    def run(self, work: Callable[[int], None], number: int, abort_slice: Callable[[], None]) -> None:
        """Call work(0) to work(number - 1) in parallel: work(0) in this thread, and each of the others in its own."""
        self._pool = self._pool or ThreadPoolExecutor(number - 1, "slab")
        futures = [self._pool.submit(work, k) for k in range(1, number)]
        try:
            work(0)
            wait(futures)
        finally:  # Ctrl-C interrupts this thread
            if not all(future.done() for future in futures):
                abort_slice()
                wait(futures)
        for future in futures:
            future.result()

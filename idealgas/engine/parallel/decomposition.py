"""Domain decomposition: several threads advance one gas, with the same result as one thread, bit for bit.

Each thread processes the events of the discs in its slab, in slices of time. If events in a slice may have happened in
the wrong order, the slice is aborted: all its changes are rolled back, and one thread repeats it.
"""

import time
from typing import Any

import numpy as np

from idealgas.columns import EventBatch
from idealgas.effects.bundle import Effects, add_sums_of, clear_sums, with_own_sums
from idealgas.engine.event_driven.kernel import advance_events
from idealgas.engine.event_driven.prefetch import make_pipeline
from idealgas.engine.event_driven.scheduler import build, make_tree
from idealgas.engine.event_driven.state import EventDrivenState
from idealgas.engine.method import Limits
from idealgas.engine.parallel.merge import PendingRows, TiedRowsError, time_order
from idealgas.engine.parallel.slabs import make_subdomains, reset, slab_edges
from idealgas.engine.parallel.subdomain import FAILED, FLAG, TIE, Subdomain
from idealgas.engine.parallel.workers import REASONS, STOP, Workers
from idealgas.engine.records import COUNTERS, UNLIMITED, Discs
from idealgas.jit import aligned
from idealgas.physics import stress
from idealgas.physics.absorbing import inside
from idealgas.physics.periodic import periodic_axes

SLICE_FRACTION = 0.8
"""Planned fraction, in a slice, of the events that remain before a limit; a slice that exceeds the limit is wasted."""

TRIAL_FACTOR = 2
"""Number of events in a slice that measures the speed, in units of the smallest number in a shared slice.

SERIAL_TRIAL or PARALLEL_TRIAL may require more events, because the overhead of a slice grows with the number of discs.
On a busy machine, a slice of several threads may take forty times as long as a slice of one thread.
"""

SERIAL_TRIAL, PARALLEL_TRIAL = 0.25, 0.5
"""Smallest number of events per disc in a slice that measures the speed, for one thread and for several."""

MIN_RATE_EVENTS = 64
"""Smallest number of events from which a rate is measured."""

PREDICTIONS_PER_EVENT = 6
"""Number of predictions at the start of an epoch that take as long as one event."""

RATE_DIVISOR = 8
"""Number by which the event rate is divided if it has predicted far too many events."""


class DomainDecomposition:
    """The threads of one epoch."""

    def __init__(self, workers: Workers, slabs: int, discs: Discs, state: EventDrivenState, effects: Effects) -> None:
        """Decompose the discs of a new epoch into a number of slabs, at least two."""
        self._workers, self._discs, self._state, self._effects = workers, discs, state, effects
        record, cells = discs.record, state.cells
        here = inside(record.x, effects.absorbing)
        fastest = float(np.sqrt((record.vx**2 + record.vy**2).max())) or 1.0
        self._subdomains = make_subdomains(
            slab_edges(np.bincount(cells.link["row"][here], minlength=cells.rows), slabs),
            periodic_axes(effects.periodic)[1],
            workers.tuning.lead * cells.height / fastest,
        )
        self._built = True
        self._pending: PendingRows | None = None
        self._reaches_limit = False
        self._reached = 0.0  # local time at the end of the last shared slice
        self._slabs: list[_Slab] = []
        self._rows: EventBatch | None = None

    @property
    def pending(self) -> bool:
        """Whether `advance` still has rows of the last slice to deliver."""
        return self._pending is not None and len(self._pending) > 0

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Process events up to the limits (see `advance_events`); the next calls deliver rows that do not fit."""
        if self.pending:
            return self._deliver(batch)
        end, autotuner = self._slice_end(limits, batch, counters[0]), self._workers.autotuner
        if limits.events == 0:
            self._run_threads(0.0, batch, FAILED)  # only compiles
            return self._run_serial(limits, epoch_start, batch, counters)
        shared = end > 0.0 and (autotuner is None or autotuner.use_threads())
        started, before = time.perf_counter(), self._work_done(counters)
        aborted = self._run_slice(end, limits, epoch_start, batch, counters) if shared else ""
        if shared and not aborted:
            rows, arrived = self._deliver(batch)
        else:
            if autotuner is not None and not shared and autotuner.is_trial(shared):
                limits = limits._replace(events=min(limits.events, self._trial_events(SERIAL_TRIAL)))
            rows, arrived = self._run_serial(limits, epoch_start, batch, counters)
        # If the rate of events rises, as in a melting lattice, slices are wasted although the threads are not slow.
        if autotuner is not None and aborted != STOP:
            autotuner.note(shared, self._work_done(counters) - before, time.perf_counter() - started)
        return rows, arrived

    def _work_done(self, counters: np.ndarray) -> int:
        """Work done in the epoch, in events; the predictions at its start are converted to events."""
        predictions = len(self._discs.record) if self._state.unpredicted[0] else 0
        return int(counters[0]["events"]) - predictions // PREDICTIONS_PER_EVENT

    def _slice_end(self, limits: Limits, batch: EventBatch | None, counter: Any) -> float:
        """Local time up to which the threads should share the next slice; 0 if sharing is not worthwhile."""
        if self._workers.rate is None:
            return 0.0
        (events, collisions), tuning = self._workers.rate, self._workers.tuning
        most = float(limits.events if batch is None else min(limits.events, tuning.buffer * len(self._subdomains) // 2))
        if collisions > 0:
            most = min(most, limits.collisions * events / collisions)
        if self._workers.autotuner is not None and self._workers.autotuner.is_trial(True):
            most = min(most, self._trial_events(PARALLEL_TRIAL))
        now = max(float(counter["time"]), self._reached)
        until = min(now + SLICE_FRACTION * most / events, limits.until)
        return until if (until - now) * events >= tuning.min_events else 0.0

    def _trial_events(self, per_disc: float) -> int:
        """Number of events in a slice that measures the speed; per_disc: smallest number per disc."""
        least = max(TRIAL_FACTOR * self._workers.tuning.min_events, MIN_RATE_EVENTS)
        return max(least, int(per_disc * len(self._discs.record)))

    def _run_serial(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Process events on this thread only."""
        if not self._built:
            _build(self._state, 0, self._state.cells.rows)
            self._built = True
        before = counters.copy()
        rows, reached = advance_events(
            self._discs, self._state, self._effects, limits, epoch_start, batch, counters, None
        )
        self._measure_rate(before[0], counters[0], float(counters[0]["time"]))
        return rows, reached

    def _measure_rate(self, before: Any, after: Any, time: float) -> None:
        """Record the rate of events up to a local time."""
        events, collisions = (int(after[name] - before[name]) for name in ("events", "disc_collisions"))
        length = time - float(before["time"])
        if events >= MIN_RATE_EVENTS and length > 0.0:
            self._workers.rate = events / length, collisions / length

    def _run_slice(
        self, end: float, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> str:
        """Process a shared slice up to a local time; return why it was aborted and rolled back, or an empty string.

        Like a database transaction, a slice happens completely or not at all: either everything that the threads have
        done is accepted, or everything is undone, even if the threads are interrupted.
        """
        self._workers.counts["slices"] += 1
        self._save()
        try:
            why = self._run_threads(end, batch, 0) or self._exceeds(limits) or self._merge_rows(epoch_start)
        except BaseException:
            self._roll_back()
            raise
        if why:
            self._workers.counts[why] += 1
            self._roll_back()
        else:
            self._accept(end, counters)
            self._reaches_limit = end == limits.until
        return why

    def _done(self, name: str) -> int:
        """Number of events of one kind in the slice, summed over the threads; name: field of COUNTERS."""
        return sum(int(slab.counters[0][name]) for slab in self._slabs)

    def _exceeds(self, limits: Limits) -> str:
        """Return STOP if the slice reached a limit on the number of events, otherwise an empty string.

        The threads cannot check these limits, because which event reaches a limit depends on the order of all events.
        """
        exceeds = self._done("events") >= limits.events or self._done("disc_collisions") >= limits.collisions
        return STOP if exceeds else ""

    def _merge_rows(self, epoch_start: float) -> str:
        """Prepare the rows of all threads for delivery; return the reason if their order is undefined, otherwise ""."""
        if self._rows is not None:
            try:
                order = time_order(self._rows.time, [slab.filled for slab in self._slabs])
            except TiedRowsError:
                return REASONS[TIE]
            self._pending = PendingRows(self._rows, order, epoch_start)
        return ""

    def _accept(self, end: float, counters: np.ndarray) -> None:
        """Add the sums and counters of all threads to the totals, and measure the rate of events."""
        before, events = counters.copy(), self._done("events")
        for slab in self._slabs:
            add_sums_of(self._effects, slab.effects)
        for name in ("events", "disc_collisions", "wall_hits", "thermostat_collisions"):
            counters[name] += self._done(name)
        if events:
            last = max((slab.counters[0] for slab in self._slabs), key=lambda counter: counter["time"])
            counters["time"], counters["events_at_this_time"] = last["time"], last["events_at_this_time"]
        self._measure_rate(before[0], counters[0], end)
        if events < MIN_RATE_EVENTS and self._workers.rate is not None:  # the rate has fallen
            self._workers.rate = self._workers.rate[0] / RATE_DIVISOR, self._workers.rate[1] / RATE_DIVISOR
        self._state.unpredicted[0] = False
        self._reached = end

    def _deliver(self, batch: EventBatch | None) -> tuple[int, bool]:
        """Fill the batch with rows of the last slice; the slice is over when all its rows are delivered."""
        rows = 0
        if batch is not None and self._pending is not None:
            rows = self._pending.fill(batch)
        return rows, self._reaches_limit and not self.pending

    def _run_threads(self, until: float, batch: EventBatch | None, flag: int) -> str:
        """Run all threads up to a local time; return the reason why they were aborted, or an empty string.

        flag: initial flag; if it is not 0, the threads stop at once.
        """
        if not self._slabs:
            self._slabs = [_Slab(self._state, self._effects, len(self._discs.record)) for _ in self._subdomains]
        self._rows, room = self._workers.memory(batch, len(self._subdomains)), self._workers.tuning.buffer
        words, limits = self._subdomains[0].words, Limits(until, UNLIMITED, UNLIMITED, UNLIMITED)
        reset(self._subdomains)
        words[FLAG] = flag
        unpredicted = bool(self._state.unpredicted[0]) and not flag

        def abort_slice() -> None:
            words[FLAG] = words[FLAG] or FAILED

        def work(k: int) -> None:
            try:
                rows = self._rows.rows(k * room, (k + 1) * room) if self._rows is not None else None
                self._slabs[k].run(self._discs, limits, rows, self._subdomains[k], unpredicted)
            except Exception:  # errors of a kernel are raised again when one thread repeats the slice
                abort_slice()

        self._built = False
        self._workers.run(work, len(self._subdomains), abort_slice)
        for subdomain in self._subdomains:
            for name in ("migrations", "clock_resets", "crossed_messages"):
                self._workers.counts[name] += int(subdomain.private[0][name])
                subdomain.private[name] = 0
        return REASONS.get(int(words[FLAG]), "")

    def _mutable_arrays(self) -> list[np.ndarray]:
        """Return all arrays that events change, except sums and schedulers, as bytes."""
        state, effects = self._state, self._effects._replace(flow=None)
        arrays = [self._discs.record, state.prediction, state.cells.head, state.cells.link]
        for effect in effects:
            if isinstance(effect, tuple):
                arrays += [part for part in effect if isinstance(part, np.ndarray)]
        return [np.ascontiguousarray(array).view(np.uint8) for array in arrays]

    def _save(self) -> None:
        """Save copies of all arrays that the slice may change."""
        if not hasattr(self, "_saved"):
            self._saved = [np.empty_like(array) for array in self._mutable_arrays()]
        for copy, array in zip(self._saved, self._mutable_arrays(), strict=True):
            np.copyto(copy, array)

    def _roll_back(self) -> None:
        """Undo all changes of the slice."""
        self._pending = None
        for copy, array in zip(self._saved, self._mutable_arrays(), strict=True):
            np.copyto(array, copy)


class _Slab:
    """Scheduler, scratch memory, sums, counters and number of rows of a thread."""

    def __init__(self, state: EventDrivenState, effects: Effects, n: int) -> None:
        self._state = state._replace(
            tree=make_tree(n),
            candidates=aligned(len(state.candidates), state.candidates.dtype),
            pipeline=make_pipeline(n, len(state.tree.start)),
            images=None if state.images is None else aligned(len(state.images), state.images.dtype),
            unpredicted=np.zeros(1, np.bool_),
        )
        self.effects = with_own_sums(effects)
        self.filled = 0
        self.counters = np.zeros(1, COUNTERS).view(np.recarray)

    def run(
        self, discs: Discs, limits: Limits, rows: EventBatch | None, subdomain: Subdomain, unpredicted: bool
    ) -> None:
        """Process the slab's events up to a time limit.

        rows: memory for the rows of events, with local times; None without a log. unpredicted: whether an epoch has
        begun whose events have not been predicted yet.
        """
        self.counters[:] = np.zeros(1, COUNTERS)
        clear_sums(self.effects)
        self._state.unpredicted[0] = unpredicted
        _build(self._state, subdomain.low, subdomain.high)
        self.filled, _ = advance_events(discs, self._state, self.effects, limits, 0.0, rows, self.counters, subdomain)
        if self.effects.flow is not None:
            stress.flush(self.effects.flow)


def _build(state: EventDrivenState, low: int, high: int) -> None:
    """Build the scheduler of the discs in rows `low` to `high` - 1; it is empty if no event has been predicted yet."""
    build(state.tree, state.prediction, state.cells.link, low, low if state.unpredicted[0] else high)

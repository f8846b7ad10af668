"""Several threads that advance one gas, each the discs of its strip; what comes out is that of one thread, bit for bit.

They work on slices of time. A slice that cannot be shared, as something in it would have happened in another order, is
given up: all that it changed is set back, and one thread does it again.
"""

import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from typing import Any

import numpy as np

from idealgas.effects.bundle import Effects, add_sums_of, clear_sums, with_own_sums
from idealgas.engine.event_driven.kernel import advance_events
from idealgas.engine.event_driven.prefetch import make_pipeline
from idealgas.engine.event_driven.scheduler import build, make_tree
from idealgas.engine.event_driven.state import EventDrivenState
from idealgas.engine.parallel.autotuner import Race
from idealgas.engine.parallel.merge import Pending, TiedRowsError, order_of
from idealgas.engine.parallel.slabs import FAST, Tuning, cut, make_borders, reset
from idealgas.engine.parallel.subdomain import CLOCK, FAILED, FLAG, FULL, TIE, VIOLATION, Border
from idealgas.engine.records import COUNTERS, UNLIMITED, Discs, Limits
from idealgas.events import EventBatch
from idealgas.jit import aligned
from idealgas.physics import stress
from idealgas.physics.periodic import periodic_axes

REASONS = {VIOLATION: "past", TIE: "tie", FULL: "full", CLOCK: "clock", FAILED: "error"}
"""Names of the reasons for which a slice is given up."""

STOP = "stop"
"""One more reason: the slice went beyond a number of events."""

SHARE = 0.8
"""Part of the events up to a limit that a slice is made for: one that comes to more is in vain."""

TRIAL = 2
"""Times the least events of a slice: as many has one that shows what a way takes, or a number by the disc, if larger.

What a slice costs beside its events is by the disc. On a busy machine a shared one may take forty times as long.
"""

TRIED_ALONE, TRIED_SHARED = 0.25, 0.5
"""Events a disc of such a slice, on one thread and on several."""

FEW = 64
"""Events that say nothing of a rate."""

PREDICTIONS = 6
"""Predictions at an epoch's start that take as long as one event."""

SLOWER = 8
"""By which a rate is divided that foretold far too many events."""


class Crew:
    """What threads keep from one epoch to the next.

    Attributes:
        facts: numbers of slices that were shared, of those given up by reason, and of what happened at borders.
        rate: events and collisions of two discs per time, as in the last slice; None before the first.
        race: between several threads and one; None where several are always to be taken.
    """

    def __init__(self, tuning: Tuning = FAST) -> None:
        """Have no thread yet."""
        self.tuning = tuning
        self.race = Race() if tuning.race else None
        self.facts: Counter[str] = Counter()
        self.rate: tuple[float, float] | None = None
        self._pool: ThreadPoolExecutor | None = None
        self._rows: EventBatch | None = None

    @property
    def given_up(self) -> int:
        """Number of slices of the run so far that were given up."""
        return sum(self.facts[why] for why in (*REASONS.values(), STOP))

    def memory(self, batch: EventBatch | None, strips: int) -> EventBatch | None:
        """Memory for the rows of all strips, a part for each, with columns as those of a batch; None without a log."""
        if batch is None:
            return None
        rows = self.tuning.buffer * strips
        if self._rows is None or len(self._rows.time) != rows:
            self._rows = EventBatch(*(_longer(column, rows) for column in batch))  # type: ignore[arg-type]
        return self._rows

    def run(self, work: Callable[[int], None], number: int, give_up: Callable[[], None]) -> None:
        """Call work(0) to work(number - 1) at once, each in a thread of its own, the first in this one."""
        self._pool = self._pool or ThreadPoolExecutor(number - 1, "strip")
        others = [self._pool.submit(work, k) for k in range(1, number)]
        try:
            work(0)
            wait(others)
        finally:  # Ctrl-C comes to this thread
            if not all(other.done() for other in others):
                give_up()
                wait(others)
        for other in others:
            other.result()


class Team:
    """The threads of one epoch."""

    def __init__(self, crew: Crew, strips: int, discs: Discs, state: EventDrivenState, effects: Effects) -> None:
        """Share the discs of an epoch that begins among a number of strips, at least two."""
        self._crew, self._discs, self._state, self._effects = crew, discs, state, effects
        record, cells = discs.record, state.cells
        fastest = float(np.sqrt((record.vx**2 + record.vy**2).max())) or 1.0
        self._borders = make_borders(
            cut(np.bincount(record.row, minlength=cells.rows), strips),
            periodic_axes(effects.periodic)[1],
            crew.tuning.lead * cells.height / fastest,
            crew.tuning.delay,
        )
        self._built = True
        self._pending: Pending | None = None
        self._arrives = False
        self._done = 0.0  # local time up to which all has happened, after the last event too
        self._strips: list[_Strip] = []
        self._rows: EventBatch | None = None

    @property
    def pending(self) -> bool:
        """Whether rows of the last slice are still to be handed on."""
        return self._pending is not None and len(self._pending) > 0

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Process events up to the limits, see `advance_events`; rows beyond the batch come with the next calls."""
        if self.pending:
            return self._deliver(batch)
        goal, race = self._goal(limits, batch, counters[0]), self._crew.race
        if limits.events == 0:
            self._share(0.0, batch, FAILED)  # compiles
            return self._alone(limits, epoch_start, batch, counters)
        shared = goal > 0.0 and (race is None or race.shares())
        started, before = time.perf_counter(), self._work(counters)
        given_up = self._given_up(goal, limits, epoch_start, batch, counters) if shared else ""
        if shared and not given_up:
            rows, arrived = self._deliver(batch)
        else:
            if race is not None and not shared and race.is_trial(shared):
                limits = limits._replace(events=min(limits.events, self._trial(TRIED_ALONE)))
            rows, arrived = self._alone(limits, epoch_start, batch, counters)
        if race is not None and given_up != STOP:  # a rate that rose, as in a lattice that melts, says nothing of speed
            race.note(shared, self._work(counters) - before, time.perf_counter() - started)
        return rows, arrived

    def _work(self, counters: np.ndarray) -> int:
        """What has been done in the epoch: events, and predictions at its start, in the time of as many events."""
        predictions = len(self._discs.record) if self._state.unpredicted[0] else 0
        return int(counters[0]["events"]) - predictions // PREDICTIONS

    def _goal(self, limits: Limits, batch: EventBatch | None, counter: Any) -> float:
        """Local time up to which a slice is to be shared; 0 for none."""
        if self._crew.rate is None:
            return 0.0
        (events, collisions), tuning = self._crew.rate, self._crew.tuning
        most = float(limits.events if batch is None else min(limits.events, tuning.buffer * len(self._borders) // 2))
        if collisions > 0:
            most = min(most, limits.collisions * events / collisions)
        if self._crew.race is not None and self._crew.race.is_trial(True):
            most = min(most, self._trial(TRIED_SHARED))
        now = max(float(counter["time"]), self._done)
        until = min(now + SHARE * most / events, limits.until)
        return until if (until - now) * events >= tuning.events else 0.0

    def _trial(self, by_disc: float) -> int:
        """Events of a slice that shows what a way takes; by_disc: events per disc, unless that comes to few."""
        return max(TRIAL * self._crew.tuning.events, int(by_disc * len(self._discs.record)), FEW)

    def _alone(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Process events on this thread only."""
        record, ids, _ = self._discs
        if not self._built:
            _build(self._state, record, 0, self._state.cells.rows)
            self._built = True
        before = counters.copy()
        rows, reached = advance_events(
            record, ids, self._state, self._effects, limits, epoch_start, batch, counters, None
        )
        self._measure(before[0], counters[0], float(counters[0]["time"]))
        return rows, reached

    def _measure(self, before: Any, after: Any, time: float) -> None:
        """Note the rate of events up to a local time."""
        events, collisions = (int(after[name] - before[name]) for name in ("events", "disc_collisions"))
        length = time - float(before["time"])
        if events >= FEW and length > 0.0:
            self._crew.rate = events / length, collisions / length

    def _given_up(
        self, goal: float, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> str:
        """Share a slice up to a local time; why that was given up, with all as it was before, or nothing."""
        facts = self._crew.facts
        facts["slices"] += 1
        self._save()
        try:
            why = self._share(goal, batch, 0)
            strips, total = self._strips, counters.copy()
            for strip in strips:
                for name in ("events", "disc_collisions", "wall_hits", "kicks"):
                    total[name] += strip.counters[name]
            last = max(strips, key=lambda strip: strip.counters[0]["time"]).counters[0]
            done = {name: int(total[0][name] - counters[0][name]) for name in ("events", "disc_collisions")}
            if not why and (done["events"] >= limits.events or done["disc_collisions"] >= limits.collisions):
                why = STOP
            if not why and self._rows is not None:
                order = order_of(self._rows.time, [strip.filled for strip in strips])
                self._pending = Pending(self._rows, order, epoch_start)
        except TiedRowsError:
            why = REASONS[TIE]
        except BaseException:
            self._restore()
            raise
        if why:
            facts[why] += 1
            self._restore()
            return why
        self._state.unpredicted[0] = False
        for strip in strips:
            strip.add_to(self._effects)
        if done["events"]:
            total["time"], total["events_at_this_time"] = last["time"], last["events_at_this_time"]
        self._measure(counters[0], total[0], goal)
        if done["events"] < FEW and self._crew.rate is not None:  # the rate was that of busier times
            self._crew.rate = self._crew.rate[0] / SLOWER, self._crew.rate[1] / SLOWER
        self._done = goal
        counters[:] = total
        self._arrives = goal == limits.until
        return ""

    def _deliver(self, batch: EventBatch | None) -> tuple[int, bool]:
        """Hand on what rows there are; the slice is over with the last of them."""
        rows = 0
        if batch is not None and self._pending is not None:
            rows = self._pending.fill(batch)
        return rows, self._arrives and not self.pending

    def _share(self, until: float, batch: EventBatch | None, flag: int) -> str:
        """Let all threads work up to a local time, with a flag; return why that was given up, or nothing."""
        record, ids, _ = self._discs
        if not self._strips:
            self._strips = [_Strip(self._state, self._effects, len(record)) for _ in self._borders]
        self._rows, room = self._crew.memory(batch, len(self._borders)), self._crew.tuning.buffer
        words, limits = self._borders[0].words, Limits(until, UNLIMITED, UNLIMITED, UNLIMITED)
        reset(self._borders)
        words[FLAG] = flag
        unpredicted = bool(self._state.unpredicted[0]) and not flag

        def give_up() -> None:
            words[FLAG] = words[FLAG] or FAILED

        def work(k: int) -> None:
            try:
                own = self._rows.rows(k * room, (k + 1) * room) if self._rows is not None else None
                self._strips[k].run(record, ids, limits, own, self._borders[k], unpredicted)
            except Exception:  # raised by a kernel: one thread will come to it, and raise it again
                give_up()

        self._built = False
        self._crew.run(work, len(self._borders), give_up)
        for border in self._borders:
            for name in ("posts", "set_back", "while_posting"):
                self._crew.facts[name] += int(border.own[0][name])
                border.own[name] = 0
        return REASONS.get(int(words[FLAG]), "")

    def _changing(self) -> list[np.ndarray]:
        """All that events change but sums and schedules, as arrays of bytes."""
        state, effects = self._state, self._effects._replace(flow=None)
        arrays = [self._discs.record, state.prediction, state.cells.head, state.cells.link]
        for effect in effects:
            if isinstance(effect, tuple):
                arrays += [part for part in effect if isinstance(part, np.ndarray)]
        return [np.ascontiguousarray(array).view(np.uint8) for array in arrays]

    def _save(self) -> None:
        """Keep a copy of all that the slice may change."""
        if not hasattr(self, "_saved"):
            self._saved = [np.empty_like(array) for array in self._changing()]
        for copy, array in zip(self._saved, self._changing(), strict=True):
            np.copyto(copy, array)

    def _restore(self) -> None:
        """Set back all that the slice has changed."""
        self._pending = None
        for copy, array in zip(self._saved, self._changing(), strict=True):
            np.copyto(array, copy)


class _Strip:
    """What one thread has for itself: schedule, scratch memory, sums, counters and the number of its rows."""

    def __init__(self, state: EventDrivenState, effects: Effects, n: int) -> None:
        self._state = state._replace(
            tree=make_tree(n),
            candidates=aligned(len(state.candidates), state.candidates.dtype),
            pipeline=make_pipeline(n, len(state.tree.start)),
            images=None if state.images is None else aligned(len(state.images), state.images.dtype),
            unpredicted=np.zeros(1, np.bool_),
        )
        self._effects = with_own_sums(effects)
        self.filled = 0
        self.counters = np.zeros(1, COUNTERS).view(np.recarray)

    def run(
        self, record: Any, ids: Any, limits: Limits, rows: EventBatch | None, border: Border, unpredicted: bool
    ) -> None:
        """Process the strip's events up to a limit of time.

        rows: memory for them, with local times; None for none. unpredicted: whether an epoch begins.
        """
        self.counters[:] = np.zeros(1, COUNTERS)
        clear_sums(self._effects)
        self._state.unpredicted[0] = unpredicted
        _build(self._state, record, border.low, border.high)
        self.filled, _ = advance_events(
            record, ids, self._state, self._effects, limits, 0.0, rows, self.counters, border
        )
        if self._effects.flow is not None:
            stress.flush(self._effects.flow)

    def add_to(self, effects: Effects) -> None:
        """Add the sums of the slice to those of the run."""
        add_sums_of(effects, self._effects)


def _build(state: EventDrivenState, record: Any, low: int, high: int) -> None:
    """Make the schedule that of the discs in some rows, see `build`; empty before anything is predicted."""
    build(state.tree, state.prediction, record, low, low if state.unpredicted[0] else high)


def _longer(column: np.ndarray | None, rows: int) -> np.ndarray | None:
    return None if column is None else np.empty((rows, *column.shape[1:]), column.dtype)

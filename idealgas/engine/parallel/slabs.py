"""Strips of rows of cells, one for each thread: how many, where they are cut, and what their threads share."""

import os
from typing import NamedTuple

import numba
import numpy as np

from idealgas.engine.parallel.atomics import LINE
from idealgas.engine.parallel.subdomain import (
    ACTIVE,
    FLAG,
    LATE,
    LEAST_ROWS,
    OWN,
    ZONE,
    Border,
    clock_word,
    lines,
    lock_word,
    mail_word,
)
from idealgas.engine.records import Threads
from idealgas.jit import aligned


class Tuning(NamedTuple):
    """What makes threads fast, and changes nothing else.

    Attributes:
        rows: least rows of a strip.
        discs: least discs of a strip.
        events: least events of a slice that several threads share.
        slice: events of a slice that are enough, however many discs there are: as many as take some seconds.
        buffer: rows of events that a strip has room for.
        lead: rows that the fastest disc may cross in the time by which events inside a strip are ahead of others.
        race: whether one thread goes on alone while that is faster, as on a busy machine.
        delay: strip k waits for long at one event in `delay * (k + 1)`, for tests; 0 for never.
    """

    rows: int = 32
    discs: int = 5_000
    events: int = 20_000
    slice: int = 1 << 21
    buffer: int = 1 << 18
    lead: float = 1.5
    race: bool = True
    delay: int = 0


FAST = Tuning()


def cores() -> int:
    """Number of processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def share_out(threads: int | None, rows: int, n: int, local: bool, tuning: Tuning = FAST) -> Threads:
    """How n discs in so many rows of cells are shared.

    threads: as many as asked for, None for as many as are worth it. local: whether discs
    meet only what is near them.
    """
    if numba.config.DISABLE_JIT:
        return Threads(1, "nothing is compiled")
    if not local:
        return Threads(1, "every disc may meet the piston")
    if threads is None:
        limits = {
            n // tuning.discs: f"each has at least {tuning.discs} discs",
            rows // tuning.rows: f"each has at least {tuning.rows} rows of cells",
            cores(): "as many as there are cores",
        }
    else:
        limits = {
            max(rows // LEAST_ROWS, 1): f"each has at least {LEAST_ROWS} rows of cells",
            threads: "as run.threads says",
        }
    number = min(limits)
    worth = max(2 * tuning.events, min(4 * n, tuning.slice))  # all discs are copied before
    if number <= 1:
        return Threads(1, limits[number])
    return Threads(number, limits[number], events=worth, alone=tuning.events // 2 if number >= cores() else 0)


def cut(discs_in_row: np.ndarray, strips: int) -> list[int]:
    """First rows of the strips, and the row after the last: equal shares of the discs, at least LEAST_ROWS rows each.

    discs_in_row: (R,) by row of cells, ring included.
    """
    last = len(discs_in_row) - 1
    share = np.cumsum(discs_in_row) / max(discs_in_row.sum(), 1)
    edges = [1, *(int(np.searchsorted(share, k / strips)) + 1 for k in range(1, strips)), last]
    for k in range(1, strips):
        edges[k] = max(edges[k], edges[k - 1] + LEAST_ROWS)
    for k in range(strips - 1, 0, -1):
        edges[k] = min(edges[k], edges[k + 1] - LEAST_ROWS)
    return edges


def make_borders(edges: list[int], ring: bool, lead: float, delay: int) -> list[Border]:
    """The strips between the edges; ring: the last one and the first are neighbours. lead: time."""
    strips = len(edges) - 1
    words = aligned(lines(strips) * LINE, np.dtype("i8"))
    borders = []
    for k in range(strips):
        own = aligned(1, OWN)
        own.draw = k + 1
        below, above = ring or k > 0, ring or k < strips - 1
        borders.append(
            Border(
                me=k,
                strips=strips,
                low=edges[k],
                high=edges[k + 1],
                inside=(edges[k] + ZONE * below, edges[k + 1] - ZONE * above),
                below=k if below else -1,
                above=(k + 1) % strips if above else -1,
                under=(k - 1) % strips,
                over=(k + 1) % strips,
                lead=lead,
                delay=delay * (k + 1),
                own=own,
                words=words,
                times=words.view(np.float64),
            )
        )
    return borders


def reset(borders: list[Border]) -> None:
    """Prepare the strips for a slice, in which nothing has happened yet."""
    b = borders[0]
    b.words[FLAG], b.words[ACTIVE] = 0, len(borders)
    for k in range(len(borders)):
        b.times[clock_word(k)] = b.times[clock_word(k) + 1] = b.times[lock_word(b, k) + 1] = LATE
        b.words[lock_word(b, k)] = 0
        b.words[mail_word(b, k, 0)] = b.words[mail_word(b, k, 1)] = -1
    for border in borders:
        own = border.own
        for name in OWN.names or ():
            if OWN[name] == np.float64:
                own[name] = LATE
        own["at_once"] = own["held"] = own["idle"] = own["posted"] = 0

"""Decomposition of the box into slabs of rows of cells, one per thread, and the memory that the threads share."""

from typing import NamedTuple

import numpy as np

from idealgas.engine.method import Threads
from idealgas.engine.parallel.atomics import LINE
from idealgas.engine.parallel.subdomain import (
    ACTIVE,
    BEFORE_ALL,
    FLAG,
    HALO,
    MIN_ROWS,
    PRIVATE,
    Subdomain,
    clock_word,
    lines,
    lock_word,
    message_word,
)
from idealgas.jit import INTERPRETED, aligned
from idealgas.system import cores


class Tuning(NamedTuple):
    """Parameters of the threads, which affect only the speed.

    Attributes:
        min_rows: smallest number of rows of cells in a slab.
        min_discs: smallest number of discs in a slab.
        min_events: smallest number of events in a slice that several threads share.
        max_events: number of events that suffices for a slice, however many discs there are; it takes a few seconds.
        buffer: number of event rows for which a slab has memory.
        lead: number of rows of cells that the fastest disc can cross in the time by which interior events may be ahead
            of the neighbouring slabs.
        autotune: whether one thread continues alone as long as this is faster, for example on a busy machine.
    """

    min_rows: int = 32
    min_discs: int = 5_000
    min_events: int = 20_000
    max_events: int = 1 << 21
    buffer: int = 1 << 18
    lead: float = 1.5
    autotune: bool = True


DEFAULT_TUNING = Tuning()


def choose_threads(threads: int | None, rows: int, n: int, far: str, tuning: Tuning = DEFAULT_TUNING) -> Threads:
    """Choose the number of threads that share n discs.

    Args:
        threads: requested number; None for as many as are worthwhile.
        rows: number of rows of cells.
        n: number of discs.
        far: reason why discs may collide with distant partners; empty if they cannot.
        tuning: parameters of the threads.

    Returns:
        The number of threads, with the reason.
    """
    if INTERPRETED:
        return Threads(1, "nothing is compiled")
    if far:
        return Threads(1, far)
    if threads is None:
        limits = {
            n // tuning.min_discs: f"each has at least {tuning.min_discs} discs",
            rows // tuning.min_rows: f"each has at least {tuning.min_rows} rows of cells",
            cores(): "as many as there are cores",
        }
    else:
        limits = {
            max(rows // MIN_ROWS, 1): f"each has at least {MIN_ROWS} rows of cells",
            threads: "as run.threads says",
        }
    number = min(limits)
    worthwhile = max(2 * tuning.min_events, min(4 * n, tuning.max_events))  # a slice begins with a copy of all discs
    if number <= 1:
        return Threads(1, limits[number])
    serial = tuning.min_events // 2 if number >= cores() else 0
    return Threads(number, limits[number], min_events=worthwhile, serial_events=serial)


def slab_edges(discs_in_row: np.ndarray, slabs: int) -> list[int]:
    """Return the first row of each slab, and the row after the last slab.

    The slabs have about equal numbers of discs, and at least MIN_ROWS rows each. discs_in_row: (R,) number of discs in
    each row of cells, including the ring around the box.
    """
    last = len(discs_in_row) - 1
    share = np.cumsum(discs_in_row) / max(discs_in_row.sum(), 1)
    edges = [1, *(int(np.searchsorted(share, k / slabs)) + 1 for k in range(1, slabs)), last]
    for k in range(1, slabs):
        edges[k] = max(edges[k], edges[k - 1] + MIN_ROWS)
    for k in range(slabs - 1, 0, -1):
        edges[k] = min(edges[k], edges[k + 1] - MIN_ROWS)
    return edges


def make_subdomains(edges: list[int], ring: bool, lead: float) -> list[Subdomain]:
    """Return the slabs between the edges.

    ring: whether the last slab and the first are neighbours. lead: time by which interior events may be ahead of the
    neighbouring slabs.
    """
    slabs = len(edges) - 1
    words = aligned(lines(slabs) * LINE, np.dtype("i8"))
    subdomains = []
    for k in range(slabs):
        below, above = ring or k > 0, ring or k < slabs - 1
        subdomains.append(
            Subdomain(
                rank=k,
                slabs=slabs,
                low=edges[k],
                high=edges[k + 1],
                interior=(edges[k] + HALO * below, edges[k + 1] - HALO * above),
                below=k if below else -1,
                above=(k + 1) % slabs if above else -1,
                rank_below=(k - 1) % slabs,
                rank_above=(k + 1) % slabs,
                lead=lead,
                private=aligned(1, PRIVATE),
                words=words,
                times=words.view(np.float64),
            )
        )
    return subdomains


def reset(subdomains: list[Subdomain]) -> None:
    """Prepare the subdomains for a slice, before its first event."""
    sub = subdomains[0]
    sub.words[FLAG], sub.words[ACTIVE] = 0, len(subdomains)
    for k in range(len(subdomains)):
        sub.times[clock_word(k)] = sub.times[clock_word(k) + 1] = sub.times[lock_word(sub, k) + 1] = BEFORE_ALL
        sub.words[lock_word(sub, k)] = 0
        sub.words[message_word(sub, k, 0)] = sub.words[message_word(sub, k, 1)] = -1
    for subdomain in subdomains:
        private = subdomain.private
        for name in PRIVATE.names or ():
            if PRIVATE[name] == np.float64:
                private[name] = BEFORE_ALL
        private["simultaneous"] = private["locked"] = private["idle"] = private["unchecked"] = 0

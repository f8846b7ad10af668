"""The deepest overlap of discs, searched for in neighbouring cells only."""

from idealgas.engine.audit import U, overlap_of
from idealgas.engine.event_driven.contacts import gather_block
from idealgas.jit import inline, njit


@inline
def deepest_around(record, state, i, periodic):
    """Deepest overlap of disc i with discs of smaller index, divided by the sum of the radii; 0 without any."""
    deepest = 0.0
    disc = record[U(i)]
    count = gather_block(state, disc, periodic)
    for k in range(count):
        j = state.candidates[U(k)]
        while j >= 0:
            if j < i:
                deepest = max(deepest, overlap_of(disc, record[U(j)], periodic))
            j = state.cells.link[U(j)].next
    return deepest


@njit
def deepest_overlap(record, state, periodic):
    """Deepest overlap of all pairs of discs, divided by the sum of their radii; all records are at one time."""
    deepest = 0.0
    for i in range(record.shape[0]):
        deepest = max(deepest, deepest_around(record, state, i, periodic))
    return deepest

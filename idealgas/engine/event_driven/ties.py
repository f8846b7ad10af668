"""Events of one time in the schedule: which comes first.

Discs of a gas hardly ever have events at one time, but for the two that foretell their own contact. So the tree finds
some earliest event, and asks for the order only where the next one has the same time: it is then *settled* for it.
"""

import numpy as np

from idealgas.engine.event_driven.prediction import event_ids
from idealgas.engine.order import precedes
from idealgas.jit import inline, noinline

U = np.uintp


@noinline
def comes_first(predictions, ids, i, j):
    """Whether disc i's next event comes before that of disc j at the same time."""
    a, b = event_ids(predictions[U(i)], ids, i)
    c, d = event_ids(predictions[U(j)], ids, j)
    return precedes(a, b, c, d)


@inline
def settle_group(tree, predictions, ids, group, parent):
    """Make the winner of a group the one that comes first among those that share the earliest time."""
    first = np.int64(-1)
    for node in range(group, min(group + 8, parent)):
        if tree.time[U(node)] == tree.time[U(parent)]:
            i = np.int64(tree.winner[U(node)])
            if first < 0 or comes_first(predictions, ids, i, first):
                first = i
    tree.winner[U(parent)] = first


@noinline
def settle_path(tree, predictions, ids, i, time):
    """Settle the groups of disc i on all levels, as far as they have events of a time."""
    group = np.int64(i)
    base = 0
    for level in range(1, tree.start.shape[0]):
        offset = (group - base) >> 3
        group = base + (offset << 3)
        base = tree.start[U(level)]
        parent = base + offset
        if tree.time[U(parent)] == time:
            settle_group(tree, predictions, ids, group, parent)
        group = parent

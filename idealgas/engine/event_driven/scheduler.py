"""The scheduler: an implicit 8-ary tournament tree. It has a leaf for each disc, and its root is the next event.

The keys of a level are contiguous in memory, padded with times after NEVER; the index of the winning disc is stored for
each key. An event is removed before the next events of its discs are predicted, so that the processor can do both in
parallel. Pushing an event usually takes one or two comparisons, because most events are not the earliest of their
group.

Simultaneous events are rare, except for a contact that both discs of the pair have predicted. The tree therefore
returns any one of the earliest events. Only if the event after it has the same time are ties resolved, by the order of
ids.
"""

from typing import NamedTuple

import numpy as np

from idealgas.engine.event_driven.prediction import event_ids, precedes
from idealgas.jit import aligned, inline, njit, noinline
from idealgas.physics.motion import NEVER

NEVER_KEY = int(np.float64(NEVER).view(np.int64))
NO_TIE = -1.0  # earlier than any time

U = np.uintp


class Tree(NamedTuple):
    """Tournament tree of the discs' next events; its leaves are the discs in order of index, then the pistons.

    Attributes:
        time: (total,) f8, local time of the earliest event below each node.
        key: (total,) i8, the same memory as `time`; times are not negative, so their bits have the same order.
        winner: (total,) i4, index of the disc with the earliest event below each node.
        start: (levels,) i8, first node of each level.
        tie_time: (1,) f8, latest time at which ties were resolved. At this time the winners are the first events by
            the order of ids; at other times any of several simultaneous events may be the winner.
    """

    time: np.ndarray
    key: np.ndarray
    winner: np.ndarray
    start: np.ndarray
    tie_time: np.ndarray


def make_tree(n: int) -> Tree:
    """Make a tournament tree of n leaves, which must be cleared before use."""
    start = [0]
    nodes = n
    total = -(-n // 8) * 8
    while nodes > 1 or len(start) == 1:
        nodes = -(-nodes // 8)
        start.append(total)
        total += 4 if 1 < nodes <= 4 else -(-nodes // 8) * 8  # four are enough below the root of a small tree
    time = aligned(total, np.dtype("f8"))
    winner = aligned(total, np.dtype("i4"))
    winner[:n] = np.arange(n)
    return Tree(time, time.view(np.int64), winner, np.array(start), aligned(1, np.dtype("f8")))


@inline
def clear(tree):
    """Remove all events. All keys then differ, so that no leaf ties with the padding."""
    for node in range(tree.key.shape[0]):
        tree.key[node] = NEVER_KEY + node
    tree.tie_time[0] = NO_TIE


@inline
def first_of_four(key, first):
    """Return the earliest key of four consecutive nodes, and a node with this key."""
    k0 = key[U(first)]
    k1 = key[U(first + 1)]
    k2 = key[U(first + 2)]
    k3 = key[U(first + 3)]
    n0 = 1 if k1 < k0 else 0
    n2 = 3 if k3 < k2 else 2
    k0 = min(k0, k1)
    k2 = min(k2, k3)
    return min(k0, k2), first + (n2 if k2 < k0 else n0)


@inline
def first_of_group(key, group, width):
    """Return the earliest key of a group of eight nodes (four on a level of width 4), and a node with this key."""
    k0, n0 = first_of_four(key, group)
    if width == 4:
        return k0, n0
    k4, n4 = first_of_four(key, group + 4)
    return min(k0, k4), (n4 if k4 < k0 else n0)


@noinline
def comes_first(predictions, ids, i, j):
    """Whether disc i's next event precedes the simultaneous next event of disc j."""
    a, b = event_ids(predictions[U(i)], ids, i)
    c, d = event_ids(predictions[U(j)], ids, j)
    return precedes(a, b, c, d)


@noinline
def resolve_path(tree, predictions, ids, i, time):
    """Resolve the ties at a given time in the groups on the path from disc i's leaf to the root.

    In each group whose earliest event has this time, the first of the tied events in the order of ids becomes the
    winner.
    """
    group = np.int64(i)
    base = 0
    for level in range(1, tree.start.shape[0]):
        offset = (group - base) >> 3
        group = base + (offset << 3)
        base = tree.start[U(level)]
        parent = base + offset
        if tree.time[U(parent)] == time:
            first = np.int64(-1)
            for node in range(group, min(group + 8, parent)):
                if tree.time[U(node)] == time:
                    candidate = np.int64(tree.winner[U(node)])
                    if first < 0 or comes_first(predictions, ids, candidate, first):
                        first = candidate
            tree.winner[U(parent)] = first
        group = parent


@inline
def push(tree, predictions, ids, i):
    """Insert the next event of disc i into its empty leaf, and into all higher nodes at which it is the earliest."""
    _, key, winner, start, tie_time = tree
    prediction = predictions[U(i)]
    time = min(prediction.contact, prediction.crossing)
    tree.time[U(i)] = time
    new_key = key[U(i)]
    node = np.int64(i)
    base = 0
    for level in range(1, start.shape[0]):
        offset = (node - base) >> 3
        base = start[U(level)]
        node = base + offset
        if new_key >= key[U(node)]:
            is_later = new_key > key[U(node)] or time != tie_time[0]
            if is_later or not comes_first(predictions, ids, np.int64(i), np.int64(winner[U(node)])):
                return
        key[U(node)] = new_key
        winner[U(node)] = i


@inline
def remove(tree, predictions, ids, i):
    """Remove disc i's event from its leaf, and from all higher nodes at which it was the earliest."""
    times, key, winner, start, tie_time = tree
    removed = times[U(i)]
    key[U(i)] = NEVER_KEY + i
    group = np.int64(i)
    base = 0
    for level in range(1, start.shape[0]):
        offset = (group - base) >> 3
        group = base + (offset << 3)
        width = start[U(level)] - base
        base = start[U(level)]
        parent = base + offset
        if winner[U(parent)] != i:
            break
        earliest, best = first_of_group(key, group, width)
        key[U(parent)] = earliest
        winner[U(parent)] = winner[U(best)]
        group = parent
    if removed == tie_time[0]:
        resolve_path(tree, predictions, ids, i, removed)


@inline
def update(tree, predictions, ids, i):
    """Replace disc i's event in the tree with its newly predicted next event."""
    remove(tree, predictions, ids, i)
    push(tree, predictions, ids, i)


@inline
def next_event(tree):
    """Return the local time of the next event, and the index of its disc; of simultaneous events, any is returned."""
    root = tree.start[U(tree.start.shape[0] - 1)]
    return tree.time[U(root)], np.int64(tree.winner[U(root)])


@inline
def has_other_event(tree, predictions, i, j, time):
    """Whether disc j has another event at the time of its collision with disc i."""
    prediction = predictions[U(j)]
    same = (prediction.partner == i) & (prediction.contact == time) & (prediction.crossing > time)
    return (tree.time[U(j)] == time) & (not same)


@noinline
def resolve_ties(tree, predictions, ids, i, j):
    """Put back the next event of disc i and, unless j is -1, of disc j, and resolve all ties at their time.

    Ties are so rare that a search through an eighth of the tree is fast enough.
    """
    push(tree, predictions, ids, i)
    if j >= 0:
        push(tree, predictions, ids, j)
    time, _ = next_event(tree)
    tree.tie_time[0] = time
    parents = tree.start[1]
    for offset in range(parents >> 3):
        if tree.time[U(parents + offset)] == time:
            for leaf in range(offset << 3, (offset << 3) + 8):
                if tree.time[U(leaf)] == time:
                    resolve_path(tree, predictions, ids, leaf, time)


@njit
def build(tree, predictions, link, low, high):
    """Build the tree from the events of those discs that are in the rows `low` to `high` - 1 of cells."""
    clear(tree)
    for i in range(link.shape[0]):
        if low <= link[U(i)].row < high:
            prediction = predictions[U(i)]
            tree.time[U(i)] = min(prediction.contact, prediction.crossing)
    nodes = link.shape[0]
    base = 0
    for level in range(1, tree.start.shape[0]):
        nodes = (nodes + 7) // 8
        for offset in range(nodes):
            earliest, best = first_of_group(tree.key, base + 8 * offset, tree.start[level] - base)
            tree.key[U(tree.start[level] + offset)] = earliest
            tree.winner[U(tree.start[level] + offset)] = tree.winner[U(best)]
        base = tree.start[level]

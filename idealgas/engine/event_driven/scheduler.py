"""The schedule: one entry a disc in an implicit 8-ary tournament tree, whose root is the next event.

The keys of a level are contiguous in memory, padded with times after NEVER; the index of the disc that won is stored
beside each key. An event is withdrawn before its discs' next ones are predicted, which the processor does meanwhile; to
enter these takes a comparison or two, as most are not the earliest of their group. `simultaneous` settles ties.
"""

from typing import NamedTuple

import numpy as np

from idealgas.engine.event_driven.ties import comes_first, settle_path
from idealgas.jit import aligned, inline, njit, noinline
from idealgas.physics.motion import NEVER

NEVER_KEY = int(np.float64(NEVER).view(np.int64))
UNSETTLED = -1.0  # no time

U = np.uintp


class Tree(NamedTuple):
    """Tournament tree of the discs' next events; its leaves are the discs, in order of index, and the piston.

    Attributes:
        time: (total,) f8, local time of the earliest event below each node.
        key: (total,) i8, the same memory; times are not negative, so their bits have the same order.
        winner: (total,) i4, index of the disc with that event.
        start: (levels,) i8, first node of each level.
        settled: (1,) f8, latest time of which there were several events: among these, the winners are those that come
            first. Where events have another time in common, any of them may be a winner.
    """

    time: np.ndarray
    key: np.ndarray
    winner: np.ndarray
    start: np.ndarray
    settled: np.ndarray


def make_tree(n: int) -> Tree:
    """Tournament tree of n leaves, to be cleared before use."""
    start = [0]
    nodes = n
    total = -(-n // 8) * 8
    while nodes > 1 or len(start) == 1:
        nodes = -(-nodes // 8)
        start.append(total)
        total += 4 if 1 < nodes <= 4 else -(-nodes // 8) * 8  # below the root four may be enough
    time = aligned(total, np.dtype("f8"))
    winner = aligned(total, np.dtype("i4"))
    winner[:n] = np.arange(n)
    return Tree(time, time.view(np.int64), winner, np.array(start), aligned(1, np.dtype("f8")))


@inline
def clear(tree):
    """Remove all events from the schedule; all keys then differ, so that none ties with the padding."""
    for node in range(tree.key.shape[0]):
        tree.key[node] = NEVER_KEY + node
    tree.settled[0] = UNSETTLED


@inline
def first_of_four(key, first):
    """Earliest key of four nodes in a row, and a node that has it."""
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
    """Earliest key of a group of eight nodes, and a node that has it; width: nodes of its level, which may be four."""
    k0, n0 = first_of_four(key, group)
    if width == 4:
        return k0, n0
    k4, n4 = first_of_four(key, group + 4)
    return min(k0, k4), (n4 if k4 < k0 else n0)


@inline
def schedule(tree, predictions, ids, i):
    """Enter the next event of disc i, of which the tree has none, and climb as far as it is the earliest."""
    _, key, winner, start, settled = tree
    prediction = predictions[U(i)]
    time = min(prediction.contact, prediction.crossing)
    tree.time[U(i)] = time
    own = key[U(i)]
    node = np.int64(i)
    base = 0
    for level in range(1, start.shape[0]):
        offset = (node - base) >> 3
        base = start[U(level)]
        node = base + offset
        if own >= key[U(node)]:
            is_later = own > key[U(node)] or time != settled[0]
            if is_later or not comes_first(predictions, ids, np.int64(i), np.int64(winner[U(node)])):
                return
        key[U(node)] = own
        winner[U(node)] = i


@inline
def withdraw(tree, predictions, ids, i):
    """Remove disc i's event from the tree, and climb as far as it was the earliest."""
    times, key, winner, start, settled = tree
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
    if removed == settled[0]:
        settle_path(tree, predictions, ids, i, removed)


@inline
def reschedule(tree, predictions, ids, i):
    """Enter the next event of disc i in place of the one in the tree."""
    withdraw(tree, predictions, ids, i)
    schedule(tree, predictions, ids, i)


@inline
def root_of(tree):
    """Node of the next event."""
    return tree.start[U(tree.start.shape[0] - 1)]


@inline
def next_time(tree):
    """Local time of the next event."""
    return tree.time[U(root_of(tree))]


@inline
def next_disc(tree):
    """Index of the disc with the next event, or with one of the next events that are simultaneous."""
    return np.int64(tree.winner[U(root_of(tree))])


@inline
def has_another(tree, predictions, i, j, time):
    """Whether disc j has another event at the time at which disc i is to meet it; often j foretells the same one."""
    prediction = predictions[U(j)]
    same = (prediction.partner == i) & (prediction.contact == time) & (prediction.crossing > time)
    return (tree.time[U(j)] == time) & (not same)


@inline
def is_settled(tree, time):
    """Whether an event at a time, which was withdrawn, is the first of those that are simultaneous.

    It is if no other one is left in the tree, or if the tree is settled for the time.
    """
    return (next_time(tree) != time) | (tree.settled[0] == time)


@noinline
def settle(tree, predictions, ids, i, j):
    """Put back the next events of disc i and, unless it is -1, of disc j, and settle the tree for their time.

    There are hardly ever such events, so it may look through an eighth of the tree for them.
    """
    schedule(tree, predictions, ids, i)
    if j >= 0:
        schedule(tree, predictions, ids, j)
    time = next_time(tree)
    tree.settled[0] = time
    parents = tree.start[1]
    for offset in range(parents >> 3):
        if tree.time[U(parents + offset)] == time:
            for leaf in range(offset << 3, (offset << 3) + 8):
                if tree.time[U(leaf)] == time:
                    settle_path(tree, predictions, ids, leaf, time)


@njit
def plant(tree, predictions, record, low, high):
    """Make the tree that of the discs in rows `low` to before `high` of the cells, and of no other."""
    clear(tree)
    for i in range(record.shape[0]):
        if low <= record[U(i)].row < high:
            prediction = predictions[U(i)]
            tree.time[U(i)] = min(prediction.contact, prediction.crossing)
    nodes = record.shape[0]
    base = 0
    for level in range(1, tree.start.shape[0]):
        nodes = (nodes + 7) // 8
        for offset in range(nodes):
            earliest, best = first_of_group(tree.key, base + 8 * offset, tree.start[level] - base)
            tree.key[U(tree.start[level] + offset)] = earliest
            tree.winner[U(tree.start[level] + offset)] = tree.winner[U(best)]
        base = tree.start[level]

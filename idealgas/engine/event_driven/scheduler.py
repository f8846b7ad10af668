"""The schedule: one entry a disc in an implicit 8-ary tournament tree, whose root is the next event.

The keys of a level are contiguous in memory, padded with times after NEVER; the index of the disc that won is stored
beside each key. An update climbs the tree only while the winner of a group changes.
"""

from typing import NamedTuple

import numpy as np

from idealgas._jit import aligned, inline, njit
from idealgas.engine.order import precedes, wall_rank
from idealgas.physics.constants import NEVER
from idealgas.sides import FIRST_SEGMENT, HEAT_BATH

PREDICTION = np.dtype(
    [
        ("contact", "f8"),  # local time of the earliest contact with a disc or a wall segment
        ("crossing", "f8"),  # local time at which the disc leaves its cell, meets a side of the box or is kicked
        ("partner", "i4"),  # index of the other disc, -1 for none, -2 - k for wall segment k
        (
            "partner_count",
            "u4",
        ),  # the partner's count when predicted: the contact is stale once it differs
        ("image_x", "i2"),  # box lengths to the partner's record or the segment, where sides are periodic
        ("image_y", "i2"),
        ("crossing_code", "i4"),  # 0-3: crosses to the cell left, right, below, above; 4-7: meets that side; or KICK
    ],
    align=True,
)
SIDE_OF_BOX = 4
KICK = SIDE_OF_BOX + HEAT_BATH
"""Codes of what is no cell crossing: SIDE_OF_BOX and the number of what the disc meets."""

NO_CONTACT = 0.5 * NEVER  # before NEVER: a pair without a contact, at NEVER, is not simultaneous with it
NO_CONTACT_KEY = int(np.float64(NO_CONTACT).view(np.int64))
NEVER_KEY = int(np.float64(NEVER).view(np.int64))

U = np.uintp  # unsigned: negative indices need not be checked for


class Tree(NamedTuple):
    """Tournament tree of the discs' next events; its leaves are the discs, in order of index, and the piston.

    Attributes:
        time: (total,) f8, local time of the earliest event below each node.
        key: (total,) i8, the same memory; times are not negative, so their bits have the same order.
        winner: (total,) i4, index of the disc with that event.
        start: (levels,) i8, first node of each level.
    """

    time: np.ndarray
    key: np.ndarray
    winner: np.ndarray
    start: np.ndarray


def make_tree(n: int) -> Tree:
    """Tournament tree of n leaves, to be cleared before use."""
    start = [0]
    nodes = n
    total = -(-n // 8) * 8
    while nodes > 1 or len(start) == 1:
        nodes = -(-nodes // 8)
        start.append(total)
        total += -(-nodes // 8) * 8
    time = aligned(total, np.dtype("f8"))
    winner = aligned(total, np.dtype("i4"))
    winner[:n] = np.arange(n)
    return Tree(time, time.view(np.int64), winner, np.array(start))


@inline
def clear(key):
    """Remove all events from the schedule; all keys then differ, so that none ties with the padding."""
    for node in range(key.shape[0]):
        key[node] = NEVER_KEY + node


@inline
def segment_partner(segment):
    """Number that stands for a wall segment among the partners of a prediction."""
    return -2 - segment


@inline
def segment_of(partner):
    """Number of the wall segment that a prediction's partner stands for."""
    return -2 - partner


@inline
def images_of(prediction):
    """Numbers of box lengths (x, y) between a disc's record and its partner."""
    return np.int64(prediction.image_x), np.int64(prediction.image_y)


@inline
def partner_rank(ids, partner):
    """Rank of a disc's partner in the order of simultaneous events: its id, or the rank of a wall."""
    if partner >= 0:
        return np.int64(ids[U(partner)])
    return np.int64(wall_rank(FIRST_SEGMENT + segment_of(partner)))


@inline
def contact_is_next(prediction, ids, i):
    """Whether a disc's next event is its contact, not its crossing.

    A crossing into a cell precedes all events of its time.
    """
    if prediction.contact != prediction.crossing:
        return prediction.contact < prediction.crossing
    if prediction.crossing_code < SIDE_OF_BOX or prediction.partner == -1 or i == ids.shape[0]:
        return False
    own = np.int64(ids[U(i)])
    return precedes(own, partner_rank(ids, prediction.partner), own, wall_rank(prediction.crossing_code - SIDE_OF_BOX))


@inline
def event_ids(prediction, ids, i):
    """The two ids by which a disc's next event is ordered among simultaneous ones.

    The last leaf, beyond the discs, is the piston's: its contact is a hit of its side, its crossing the end stop.
    """
    contact = contact_is_next(prediction, ids, i)
    side = np.int64(wall_rank(prediction.crossing_code - SIDE_OF_BOX))
    if i == ids.shape[0]:
        return (np.int64(ids[U(prediction.partner)]), side) if contact else (np.int64(-1), np.int64(-1))
    own = np.int64(ids[U(i)])
    if contact:
        return own, partner_rank(ids, prediction.partner)
    if prediction.crossing_code < SIDE_OF_BOX:
        return np.int64(-1), own
    return own, side


@inline
def first_of_tied(tree, group, key, predictions, ids):
    """Node whose event comes first among those of a group that share the earliest time."""
    best = -1
    for node in range(group, group + 8):
        if tree.key[node] == key:
            i = np.int64(tree.winner[node])
            if best < 0:
                best = node
                a, b = event_ids(predictions[i], ids, i)
            else:
                c, d = event_ids(predictions[i], ids, i)
                if precedes(c, d, a, b):
                    best, a, b = node, c, d
    return best


@inline
def first_of_eight(tree, group, predictions, ids):
    """Earliest key of a group of eight nodes, and the node that has it."""
    key = tree.key
    k0 = key[U(group)]
    k1 = key[U(group + 1)]
    k2 = key[U(group + 2)]
    k3 = key[U(group + 3)]
    k4 = key[U(group + 4)]
    k5 = key[U(group + 5)]
    k6 = key[U(group + 6)]
    k7 = key[U(group + 7)]
    n0 = 1 if k1 < k0 else 0
    n1 = 3 if k3 < k2 else 2
    n2 = 5 if k5 < k4 else 4
    n3 = 7 if k7 < k6 else 6
    tied = (k0 == k1) | (k2 == k3) | (k4 == k5) | (k6 == k7)
    k0 = min(k0, k1)
    k2 = min(k2, k3)
    k4 = min(k4, k5)
    k6 = min(k6, k7)
    n0 = n1 if k2 < k0 else n0
    n2 = n3 if k6 < k4 else n2
    tied |= (k0 == k2) | (k4 == k6)
    k0 = min(k0, k2)
    k4 = min(k4, k6)
    node = group + (n2 if k4 < k0 else n0)
    tied |= k0 == k4
    earliest = min(k0, k4)
    if tied and earliest < NO_CONTACT_KEY:
        node = first_of_tied(tree, group, earliest, predictions, ids)
    return earliest, node


@inline
def schedule(tree, predictions, ids, i):
    """Enter the time of disc i's next event in the tree."""
    prediction = predictions[U(i)]
    tree.time[U(i)] = min(prediction.contact, prediction.crossing)
    climb(tree, predictions, ids, i)


@inline
def withdraw(tree, predictions, ids, i):
    """Remove disc i's event from the tree."""
    tree.key[U(i)] = NEVER_KEY + i
    climb(tree, predictions, ids, i)


@inline
def climb(tree, predictions, ids, i):
    """Bring the tree up to date after a change of the key of disc i.

    A group whose winner is another node needs no search: either the changed node is earlier or nothing changes.
    """
    _, key, winner, start = tree
    earliest = key[U(i)]
    first = np.int64(i)
    node = np.int64(i)
    base = 0
    shift = 0
    for level in range(1, start.shape[0]):
        group = node & ~7
        offset = (node - base) >> 3
        base = start[U(level)]
        parent = base + offset
        if winner[U(parent)] >> shift != i >> shift and earliest != key[U(parent)]:
            if earliest > key[U(parent)]:
                return
        else:
            earliest, best = first_of_eight(tree, group, predictions, ids)
            first = np.int64(winner[U(best)])
            if key[U(parent)] == earliest and winner[U(parent)] == first and first != i:
                return
        key[U(parent)] = earliest
        winner[U(parent)] = first
        node = parent
        shift += 3


@njit
def plant(tree, predictions, ids, record, low, high):
    """Make the tree that of the discs in rows `low` to before `high` of the cells, and of no other."""
    clear(tree.key)
    for i in range(record.shape[0]):
        if low <= record[U(i)].row < high:
            prediction = predictions[U(i)]
            tree.time[U(i)] = min(prediction.contact, prediction.crossing)
    nodes = record.shape[0]
    base = 0
    for level in range(1, tree.start.shape[0]):
        nodes = (nodes + 7) // 8
        for offset in range(nodes):
            earliest, best = first_of_eight(tree, base + 8 * offset, predictions, ids)
            tree.key[U(tree.start[level] + offset)] = earliest
            tree.winner[U(tree.start[level] + offset)] = tree.winner[U(best)]
        base = tree.start[level]


@inline
def next_disc(tree):
    """Index of the disc with the next event."""
    return np.int64(tree.winner[U(tree.start[U(tree.start.shape[0] - 1)])])

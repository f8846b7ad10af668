"""Find pairs of discs that touch or nearly touch."""

from collections.abc import Iterator

import numpy as np

NOT_PERIODIC = (0.0, 0.0)
MARGIN = 1e-9
"""Relative distance beyond contact up to which pairs are returned; callers decide which of them touch."""


def near_pairs(
    position: np.ndarray, radius: np.ndarray, period: tuple[float, float] = NOT_PERIODIC
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield the pairs of discs that touch, overlap or nearly touch, in several batches.

    Discs are grouped by size, in ranges of a factor of two. Each group is searched for pairs within the group and for
    pairs with smaller discs, so that a few large discs among many small ones cost little.

    Args:
        position: (N, 2), length.
        radius: (N,), length.
        period: width and height of a box with periodic sides, length; 0 along an axis that is not periodic.

    Yields:
        Indices (n,) of the first and of the second disc of each pair.
    """
    from scipy.spatial import cKDTree

    position, length = position.copy(), np.array(period)
    for axis in np.flatnonzero(length):
        position[:, axis] = np.minimum(position[:, axis] % length[axis], np.nextafter(length[axis], 0.0))
    size = np.frexp(radius)[1]
    for level in np.unique(size):
        large, small = np.flatnonzero(size == level), np.flatnonzero(size < level)
        largest = float(radius[large].max())
        tree = cKDTree(position[large], boxsize=length, balanced_tree=False, compact_nodes=False)
        pairs = tree.query_pairs(_reach(2 * largest, period), output_type="ndarray")
        yield large[pairs[:, 0]], large[pairs[:, 1]]
        if len(small):
            reach = _reach(largest + float(radius[small].max()), period)
            near = tree.sparse_distance_matrix(cKDTree(position[small], boxsize=length), reach, output_type="ndarray")
            yield large[near["i"]], small[near["j"]]


def _reach(contact: float, period: tuple[float, float]) -> float:
    """Return the distance up to which discs may touch, with margins larger than the rounding errors of coordinates."""
    return contact * (1 + MARGIN) + 1e-15 * max(period)

"""Checks for overlaps of individually specified discs with each other, with the sides of the box and with walls."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from idealgas.effects.wall import WallTable
from idealgas.pairs import MARGIN
from idealgas.physics.arc_geometry import bounds, nearest_points
from idealgas.physics.motion import MAX_DISPLACEMENT
from idealgas.scene.checks.walls import wall_issues
from idealgas.toml.issues import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.discs import InitialDiscs
    from idealgas.scene.document import Document
    from idealgas.scene.tables import Box

ROUNDINGS = 16
"""Allowance for rounding at a contact: errors of two positions, of two flights and of the time of the event."""

MOST_OVERLAPS = 1_000
"""Largest number of overlaps that are reported."""

FEW = 1024
"""Largest number of discs for which comparing all pairs is faster than importing the search tree."""

PART = 2048
"""Number of discs for which the list of all pairs fits in memory."""


def rounding(extent: float, reach: np.ndarray | float) -> np.ndarray | float:
    """Return the largest overlap that can be due to rounding, length; the engine treats such discs as touching.

    Besides the rounding of coordinates, it allows for the rounding of an epoch's clock, multiplied by the speed of the
    fastest disc.

    Args:
        extent: largest coordinate, length.
        reach: distance between the centres at contact, or the diameter of a disc at a wall, length.
    """
    return ROUNDINGS * 2.0**-53 * (extent + MAX_DISPLACEMENT * reach)


def disc_keys(scene: Document, numbers: tuple[int, ...], *names: str) -> tuple[Key, ...]:
    """Return the keys of given discs with these numbers, in their tables [[disc]], or the key of the table [start]."""
    if scene.start is not None:
        return (("start",),)
    return tuple(("disc", n, name) for name in names for n in numbers)


def label(scene: Document, number: int) -> str:
    """Return the name of a given disc for the beginning of a message; empty if the key already names the disc."""
    return "" if scene.start is None else f"disc {number} "


def overlap_issues(scene: Document, box: Box | None) -> Iterator[Issue]:
    """Check for given discs that overlap, also across periodic sides; at most MOST_OVERLAPS pairs are reported."""
    discs = scene.explicit_discs
    for a, b, distance in overlapping(discs, box, scene.accepted_overlap):
        low, high = int(discs.index[a]), int(discs.index[b])
        got = f"a distance of {distance} between centres"
        allowed = f">= {discs.radius[a] + discs.radius[b]}, the sum of the radii"
        keys = disc_keys(scene, (high, low), "position", "radius")
        yield Issue(keys, f"{label(scene, high)}overlaps disc {low}", got, allowed)


def overlapping(discs: InitialDiscs, box: Box | None, accepted: float = 0.0) -> Iterator[tuple[int, int, float]]:
    """Yield the indices and distance of each pair of discs that overlap by more than rounding and the accepted overlap.

    At most MOST_OVERLAPS pairs are yielded.

    Args:
        discs: the discs.
        box: the box; None if its table is invalid.
        accepted: accepted overlap, length.
    """
    extent = max(box.size) if box else float(np.abs(discs.position).max(initial=0.0))
    owner, centre = images(discs.position, discs.radius, box)
    pairs: dict[tuple[int, int], float] = {}
    for a, b, distance in overlaps(centre, discs.radius[owner], extent, accepted):
        pair = int(min(owner[a], owner[b])), int(max(owner[a], owner[b]))
        if pair[0] != pair[1]:
            pairs[pair] = min(distance, pairs.get(pair, math.inf))
        if len(pairs) == MOST_OVERLAPS:
            break
    for (low, high), distance in sorted(pairs.items()):
        yield low, high, distance


def images(position: np.ndarray, radius: np.ndarray, box: Box | None) -> tuple[np.ndarray, np.ndarray]:
    """Return the index (M,) and centre (M, 2) of every disc and of every periodic image that reaches into the box."""
    owner, centre = np.arange(len(radius)), position
    for axis in range(2):
        if box is not None and box.periodic[axis]:
            low = np.flatnonzero(centre[:, axis] < radius[owner])
            high = np.flatnonzero(centre[:, axis] > box.size[axis] - radius[owner])
            shift = np.eye(2)[axis] * box.size[axis]
            centre = np.concatenate((centre, centre[low] + shift, centre[high] - shift))
            owner = np.concatenate((owner, owner[low], owner[high]))
    return owner, centre


def overlaps(
    centre: np.ndarray, radius: np.ndarray, extent: float, accepted: float = 0.0
) -> Iterator[tuple[int, int, float]]:
    """Yield the indices of each pair of overlapping discs, lower index first, and the distance between their centres.

    Args:
        centre: (M, 2), length.
        radius: (M,), length.
        extent: largest coordinate, which determines the rounding error, length.
        accepted: overlap that is accepted in addition to the rounding error, length.
    """
    for i, k in _near_pairs(centre, radius, accepted):
        reach = radius[i] + radius[k]
        reach -= rounding(extent, reach) + accepted
        dx, dy = (centre[i] - centre[k]).T
        close = (dx * dx + dy * dy < reach * reach) & (reach > 0)
        for a, b, x, y in zip(i[close].tolist(), k[close].tolist(), dx[close], dy[close], strict=True):
            yield min(a, b), max(a, b), math.hypot(x, y)


def _near_pairs(centre: np.ndarray, radius: np.ndarray, accepted: float) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield pairs of discs that may overlap by more than is accepted, in batches, so that the caller can stop early.

    Discs are grouped by size, in powers of two, so that a few large discs among many small ones cost little. Two
    groups, or two halves of a group, are compared only after the pairs within each have been yielded. If the caller
    found few overlaps among those, every disc has few neighbours, so the next batch is small as well. Batches therefore
    fit in memory even if all discs are in the same place.
    """
    if len(radius) <= FEW:
        yield np.triu_indices(len(radius), 1)
        return
    from scipy.spatial import cKDTree  # slow to import

    def tree_of(group: np.ndarray) -> cKDTree:
        return cKDTree(centre[group], balanced_tree=False, compact_nodes=False)

    def reach(a: np.ndarray, b: np.ndarray) -> float:
        return max((1 + MARGIN) * float(radius[a].max() + radius[b].max()) - accepted, 0.0)

    def within(group: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        if len(group) <= PART:
            pairs = tree_of(group).query_pairs(reach(group, group), output_type="ndarray")
            yield group[pairs[:, 0]], group[pairs[:, 1]]
        else:
            a, b = np.array_split(group, 2)
            yield from within(a)
            yield from within(b)
            yield between(a, b)

    def between(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        near = tree_of(a).sparse_distance_matrix(tree_of(b), reach(a, b), output_type="ndarray")
        return a[near["i"]], b[near["j"]]

    size = np.frexp(radius)[1]
    for level in np.unique(size):
        large, small = np.flatnonzero(size == level), np.flatnonzero(size < level)
        yield from within(large[cKDTree(centre[large]).indices])  # in an order that separates the halves in space
        if len(small):
            yield between(large, small)


def deepest_overlap(discs: InitialDiscs, box: Box, walls: Sequence[WallTable], interacting: bool) -> float:
    """Return the deepest overlap of discs with sides, walls and, if interacting, each other; 0 if within rounding."""
    radius = discs.radius
    pairs = overlapping(discs, box) if interacting else ()
    depths = [radius[a] + radius[b] - distance for a, b, distance in pairs]
    depths += [radius[k] - distance for k, _, distance in wall_overlaps(discs, box, dict(enumerate(walls)))]
    for axis in (a for a in range(2) if not box.periodic[a]):
        x = discs.position[:, axis]
        depths += [(radius - x).max(), (x + radius - box.size[axis]).max()]
    return float(max([0.0, *(depth for depth in depths if depth > rounding(max(box.size), 2 * radius.min()))]))


def wall_overlaps(
    discs: InitialDiscs, box: Box, walls: Mapping[int, WallTable], accepted: float = 0.0
) -> Iterator[tuple[int, int, float]]:
    """Yield disc index, wall number and distance for each disc that overlaps a wall by more than is accepted."""
    owner, centre = images(discs.position, discs.radius, box)
    slack = rounding(max(box.size), 2 * discs.radius) + accepted
    order = np.argsort(centre[:, 0], kind="stable")
    along, largest = centre[order, 0], float(discs.radius.max(initial=0.0))
    for i, wall in walls.items():
        low, high = bounds(wall.start, wall.end, wall.arc)
        reach = largest + wall.radius
        near = order[along.searchsorted(low[0] - reach) : along.searchsorted(high[0] + reach, "right")]
        distance = distance_to_wall(centre[near], wall)
        if wall.is_permeable:
            passes = np.array([wall.lets_pass(name) for name in discs.names])
            distance = np.where(passes[discs.species[owner[near]]], _distance_to_ends(centre[near], wall), distance)
        for k in np.flatnonzero(distance < (discs.radius - slack)[owner[near]]).tolist():
            yield int(owner[near[k]]), i, float(distance[k])


def discs_in_walls(scene: Document) -> Iterator[Issue]:
    """Check for given discs that overlap a wall that is present at the start; at most MOST_OVERLAPS are reported."""
    pairs: dict[tuple[int, int], float] = {}
    box, walls = scene.box, {i: wall for i, wall in enumerate(scene.walls) if wall is not None and wall.is_present(0.0)}
    declared = {i: wall for i, wall in walls.items() if isinstance(wall, WallTable)}
    walls = {i: wall for i, wall in walls.items() if i not in declared or not list(wall_issues(box.size, wall))}
    for k, i, distance in wall_overlaps(scene.explicit_discs, box, walls, scene.accepted_overlap):
        pairs[k, i] = min(distance, pairs.get((k, i), math.inf))
        if len(pairs) == MOST_OVERLAPS:
            break
    for (k, i), distance in sorted(pairs.items()):
        number, radius = int(scene.explicit_discs.index[k]), scene.explicit_discs.radius[k]
        keys = (*disc_keys(scene, (number,), "position", "radius"), walls[i].place)
        wrong = f"{label(scene, number)}overlaps {walls[i].title}"
        yield Issue(keys, wrong, f"a distance of {distance} to it", f">= {radius}, the radius")


def _distance_to_ends(points: np.ndarray, wall: WallTable) -> np.ndarray:
    """Return the distances of points (M, 2) from the ends of a permeable wall; infinite if discs pass both ways."""
    if wall.permeable_from is None:
        return np.full(len(points), np.inf)
    return np.min([np.hypot(*(points - end).T) for end in (wall.start, wall.end)], axis=0)


def distance_to_wall(points: np.ndarray, wall: WallTable) -> np.ndarray:
    """Return the distances of points (M, 2) from a wall, or from the rim of a fixed disc, length."""
    return np.asarray(np.hypot(*(points - nearest_points(points, wall.start, wall.end, wall.arc)).T) - wall.radius)

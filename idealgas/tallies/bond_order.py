"""Bond-orientational order of discs: how well the neighbours of a disc form a regular hexagon.

Two discs are neighbours if their cells in the Voronoi diagram of the centres share an edge, and each neighbour is
weighted by the length of this edge. ψ₆ is then a continuous function of the positions (Mickel, Kapfer, Schröder-Turk &
Mecke, J. Chem. Phys. 138, 044501 (2013)).
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.spatial import QhullError, Voronoi

from idealgas.errors import UserError

FOLD = 6
"""Number of neighbours of a disc in a triangular lattice."""

DENSE = 0.5
"""Smallest packing fraction for which a report includes the order of a gas."""

MARGIN = 4.0
"""Initial width of the border of periodic images around the box, in mean distances 1/√n between discs."""

SHORTEST = 1e-6
"""Length of the shortest shared edge that makes two discs neighbours, in mean distances between discs.

Shorter edges result from rounding if four or more discs lie on a circle.
"""

SAME = "neighbours cannot be found: two discs have the same position"

ROUNDING = 1e-9
"""Largest distance of a position outside the box, in box lengths, that is attributed to rounding."""


class BondOrder(NamedTuple):
    """Order around each of N discs.

    Attributes:
        value: (N,), complex, local ψ₆ = Σ l exp(6iθ)/Σ l over the neighbours, where l is the length of the shared edge
            and θ the angle of the line to the neighbour. Its modulus is 1 in a triangular lattice and 0 for a disc
            without neighbours.
        neighbours: (N,), number of neighbours.
    """

    value: np.ndarray
    neighbours: np.ndarray


def bond_order(position: np.ndarray, box: tuple[float, float], periodic: tuple[bool, bool]) -> BondOrder:
    """Return the local order of the discs at positions (N, 2) in a box.

    Along a periodic axis, periodic images of the discs count as neighbours. A reflecting side cuts cells off; it is not
    a neighbour, and edges along it do not count.

    Raises:
        UserError: if the positions have no Voronoi diagram because several discs have the same position, or if a disc
            is not in the box.
    """
    if (np.abs(position / box - 0.5) > 0.5 + ROUNDING).any():
        raise UserError("neighbours cannot be found: a disc is outside the box")
    number, spacing = len(position), math.sqrt(box[0] * box[1] / len(position))
    open_sides = np.array(periodic)
    low, high = np.where(open_sides, -np.inf, 0.0), np.where(open_sides, np.inf, box)
    margin = MARGIN * spacing
    while True:
        points = _with_images(position, box, periodic, margin)
        pairs, ends = _edges(points, number, 3 * (np.array(box) + 2 * margin))
        ends, inside = _clipped(ends, low, high)
        pairs = pairs[inside]
        radius = np.hypot(*np.moveaxis(ends - points[pairs[:, :1]], 2, 0))[..., None]
        known = (ends - radius >= -margin) & (ends + radius <= np.array(box) + margin)  # no image is missing in them
        if known[..., open_sides].all():
            break
        margin *= 2
    edges = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    shared = edges > SHORTEST * spacing
    pairs, edges = pairs[shared], edges[shared]
    bond = points[pairs[:, 1]] - points[pairs[:, 0]]
    turns = edges * np.exp(1j * FOLD * np.arctan2(bond[:, 1], bond[:, 0]))
    total, count, length = np.zeros(number, complex), np.zeros(number, np.int64), np.zeros(number)
    for side in pairs.T:  # exp(6iθ) is the same from either end of the line
        of_discs = side < number
        np.add.at(total, side[of_discs], turns[of_discs])
        np.add.at(length, side[of_discs], edges[of_discs])
        np.add.at(count, side[of_discs], 1)
    return BondOrder(np.divide(total, length, out=np.zeros_like(total), where=length > 0), count)


def _with_images(
    position: np.ndarray, box: tuple[float, float], periodic: tuple[bool, bool], margin: float
) -> np.ndarray:
    """Return positions (M, 2) of the discs, followed by their images up to `margin` (length) beyond periodic sides."""
    points = position
    for axis, (size, wrapped) in enumerate(zip(box, periodic, strict=True)):
        if wrapped:
            copies = math.ceil(margin / size)
            images = [points + n * size * (np.arange(2) == axis) for n in range(-copies, copies + 1) if n]
            beyond = np.concatenate(images)
            near = (beyond[:, axis] >= -margin) & (beyond[:, axis] <= size + margin)
            points = np.concatenate((points, beyond[near]))
    return points


def _edges(points: np.ndarray, number: int, away: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs (E, 2) of points that share an edge, and the ends of the edges (E, 2, 2).

    At least one point of each pair is among the first `number`. Four additional points close all cells; their distance
    `away` (2,) from the first point is larger than that of any position in the box from a disc.
    """
    frame = points[0] + away * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    try:
        diagram = Voronoi(np.concatenate((points, frame)))
    except (QhullError, ValueError):
        raise UserError(SAME) from None
    pairs = diagram.ridge_points
    if len(np.unique(pairs)) < len(points) + len(frame):  # a point without a cell
        raise UserError(SAME)
    of_discs = (pairs < number).any(axis=1) & (pairs < len(points)).all(axis=1)
    return pairs[of_discs], diagram.vertices[np.array(diagram.ridge_vertices)[of_discs]]


def _clipped(ends: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Clip edges, given by their ends (E, 2, 2), to coordinates between `low` and `high` (2,).

    Returns:
        The ends (K, 2, 2) of the clipped edges of nonzero length, and whether each edge has such a part, (E,).
    """
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        at = np.stack(((low - start) / along, (high - start) / along))
    still = along == 0
    at[0][still], at[1][still] = -np.inf, np.inf
    outside = (still & ((start < low) | (start > high))).any(axis=1)
    first, last = np.maximum(at.min(axis=0).max(axis=1), 0.0), np.minimum(at.max(axis=0).min(axis=1), 1.0)
    inside = (first < last) & ~outside
    share = np.stack((first, last), axis=1)[inside, :, None]
    return start[inside, None] + share * along[inside, None], inside

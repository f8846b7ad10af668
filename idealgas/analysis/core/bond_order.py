"""Bond-orientational order of discs: how well the neighbours of a disc stand at the corners of a regular hexagon.

Neighbours are those of the Voronoi diagram of the centres, and each counts by the length of the edge that the two cells
share: ψ₆ is then a continuous function of the positions (Mickel, Kapfer, Schröder-Turk & Mecke, J. Chem. Phys. 138,
044501 (2013)).
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.spatial import QhullError, Voronoi

from idealgas.errors import UserError

FOLD = 6
"""Number of neighbours of a disc in a triangular lattice."""

MARGIN = 4.0
"""Width of the border of images that is tried first, in mean distances 1/√n between discs."""

SHORTEST = 1e-6
"""Shortest shared edge of two neighbours that are counted, in mean distances: shorter ones come from rounding, where
four discs or more stand on a circle."""

ROUNDING = 1e-9
"""How far outside the box a position may be, in box lengths."""


class BondOrder(NamedTuple):
    """Order around each of N discs.

    value: (N,), local ψ₆ = Σ l exp(6iθ)/Σ l over the neighbours, with the length l of the shared edge and the angle θ
    of the line to the neighbour; complex, 1 in size in a triangular lattice, 0 for a disc without neighbours.
    neighbours: (N,), number of neighbours.
    """

    value: np.ndarray
    neighbours: np.ndarray


def bond_order(position: np.ndarray, box: tuple[float, float], periodic: tuple[bool, bool]) -> BondOrder:
    """Local order of the discs at positions (N, 2) in a box.

    Along a periodic axis the cells go on in the images of the discs. A side that reflects cuts cells off: it is no
    neighbour, and its edges do not count.

    Raises:
        UserError: if the positions have no Voronoi diagram, as those of several discs are the same, or if a disc is not
            in the box.
    """
    if (np.abs(position / box - 0.5) > 0.5 + ROUNDING).any():
        raise UserError("neighbours cannot be found: a disc is outside the box")
    number, spacing = len(position), math.sqrt(box[0] * box[1] / len(position))
    margin = MARGIN * spacing
    while True:
        points, real = _with_images(position, box, periodic, margin)
        pairs, edges, far = _edges(points, number)
        covered = [margin if wrapped or margin < size else np.inf for wrapped, size in zip(periodic, box, strict=True)]
        if far is not None and (far[:, 0] >= -np.array(covered)).all() and (far[:, 1] <= box + np.array(covered)).all():
            break
        margin *= 2
    shared = real[pairs].all(axis=1) & (edges > SHORTEST * spacing)
    pairs, edges = pairs[shared], edges[shared]
    bond = points[pairs[:, 1]] - points[pairs[:, 0]]
    turns = edges * np.exp(1j * FOLD * np.arctan2(bond[:, 1], bond[:, 0]))
    total, count, length = np.zeros(number, complex), np.zeros(number, np.int64), np.zeros(number)
    for side in pairs.T:  # the line has the same 6θ seen from either end
        own = side < number
        np.add.at(total, side[own], turns[own])
        np.add.at(length, side[own], edges[own])
        np.add.at(count, side[own], 1)
    return BondOrder(np.divide(total, length, out=np.zeros_like(total), where=length > 0), count)


def _with_images(
    position: np.ndarray, box: tuple[float, float], periodic: tuple[bool, bool], margin: float
) -> tuple[np.ndarray, np.ndarray]:
    """Positions (M, 2), first those of the discs, and whether a disc is there (M,): not at mirror images in a side.

    Images reach as far as `margin` (length) beyond the box. A side is the edge between a disc and its mirror image.
    """
    points, real = position, np.ones(len(position), bool)
    for axis, (size, wrapped) in enumerate(zip(box, periodic, strict=True)):
        unit = np.arange(2) == axis
        if wrapped:
            copies = math.ceil(margin / size)
            images = [points + n * size * unit for n in range(-copies, copies + 1) if n]
        else:
            images = [np.where(unit, 2 * side - points, points) for side in (0.0, size)]
        beyond, there = np.concatenate(images), np.tile(real & wrapped, len(images))
        near = (beyond[:, axis] >= -margin) & (beyond[:, axis] <= size + margin)
        points, real = np.concatenate((points, beyond[near])), np.concatenate((real, there[near]))
    return points, real


def _edges(points: np.ndarray, number: int) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Pairs (E, 2) of points that share an edge, one of them among the first `number`, and the edges' lengths (E,).

    Third, the lowest and highest coordinates of the circle around each corner of these cells that is free of points,
    (C, 2, 2): where the points are not all known, such a circle may hide one. None if a cell is open.
    """
    try:
        diagram = Voronoi(points)
    except (QhullError, ValueError):
        raise UserError("neighbours cannot be found: two discs have the same position") from None
    own = (diagram.ridge_points < number).any(axis=1)
    pairs, ends = diagram.ridge_points[own], np.array(diagram.ridge_vertices)[own]
    if (ends < 0).any():
        return pairs, np.zeros(len(pairs)), None
    corners = diagram.vertices[ends]
    radius = np.hypot(*np.moveaxis(corners - points[pairs[:, :1]], 2, 0))[..., None]
    far = np.stack((corners - radius, corners + radius), axis=2).reshape(-1, 2, 2)
    return pairs, np.hypot(*(corners[:, 1] - corners[:, 0]).T), far

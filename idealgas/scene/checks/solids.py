"""Checks of solids: their curves must be closed and must not cross, and no disc may start inside a solid."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from idealgas.physics.arc_geometry import drawn_points
from idealgas.scene.checks.overlaps import MOST_OVERLAPS, disc_keys, distance_to_wall, images, label, rounding
from idealgas.toml.issues import Issue, Key

if TYPE_CHECKING:
    from idealgas.effects.wall import WallTable
    from idealgas.scene.discs import FixedDisc
    from idealgas.scene.document import Document


def solid_issues(scene: Document) -> Iterator[Issue]:
    """Check solids, and check for fixed discs that protrude into a solid or cover the whole box."""
    made = [wall for wall in scene.pieces if wall is not None and wall.solid]
    fixed = scene.fixed_discs
    if not made and not fixed:
        return
    solids = scene.solids
    for k, end in solids.loose:
        wall = scene.pieces[k]
        allowed = f'exactly one other wall with solid = "{wall.solid}" that ends there'
        yield Issue((wall.key("solid"),), "curve not closed", f"an end at {list(end)}", allowed)
    if solids.loose:
        return
    if made and (crossing := _crossing(made)):
        a, b = crossing
        keys: tuple[Key, ...] = (a.place if a.piece is not None else a.key("solid"), b.place)
        yield Issue(keys, "curves that cross", b.title, "curves that do not cross")
    elif made and fixed and (reaching := list(_reaching(scene, fixed, made))):
        yield from reaching
    elif solids.area >= scene.box.size[0] * scene.box.size[1] * (1 - 1e-12):
        place: Key = made[0].key("solid") if made else fixed[0].place
        got = f"{'solids' if made else 'fixed discs'} everywhere"
        yield Issue((place,), "no area is left", got, "room for the gas")
    discs = scene.explicit_discs
    for k in np.flatnonzero(solids.contain(discs.position))[:MOST_OVERLAPS].tolist():
        number = int(discs.index[k])
        keys = disc_keys(scene, (number,), "position")
        yield Issue(keys, f"{label(scene, number)}in a solid", str(discs.position[k].tolist()), "a position outside")


def _reaching(scene: Document, fixed: Sequence[FixedDisc], solid: Sequence[WallTable]) -> Iterator[Issue]:
    """Check for fixed discs that protrude into a solid; at most MOST_OVERLAPS are reported.

    Args:
        scene: the scene.
        fixed: the fixed discs.
        solid: walls of solids.
    """
    position, radius = np.array([disc.start for disc in fixed]), np.array([disc.radius for disc in fixed])
    reaches = scene.solids.contain(position)
    owner, centre = images(position, radius, scene.box)
    slack = rounding(max(scene.box.size), 2 * radius)
    for wall in solid:
        reaches[owner[distance_to_wall(centre, wall) < (radius - slack)[owner]]] = True
    for k in np.flatnonzero(reaches)[:MOST_OVERLAPS].tolist():
        keys = (*disc_keys(scene, (fixed[k].number,), "position", "radius"), solid[0].key("solid"))
        yield Issue(
            keys, "fixed disc protrudes into a solid", str(position[k].tolist()), f"{radius[k]} or more from it"
        )


def _crossing(walls: Sequence[WallTable]) -> tuple[WallTable, WallTable] | None:
    """Return two walls that cross when drawn as polygonal lines; None if no walls cross."""
    parts = [
        (k, a, b) for k, wall in enumerate(walls) for a, b in pairwise(drawn_points(wall.start, wall.end, wall.arc))
    ]
    parts.sort(key=lambda part: min(part[1][0], part[2][0]))
    owner = np.array([k for k, *_ in parts])
    start, end = (np.array([part[n] for part in parts]) for n in (1, 2))
    left, right = np.minimum(start, end)[:, 0], np.maximum(start, end)[:, 0]
    for n in range(len(parts)):
        a, b = start[n], end[n]
        later = slice(n + 1, int(left.searchsorted(right[n], "right")))  # parts that begin before part n ends, along x
        apart = _side(a, b, start[later]) * _side(a, b, end[later])
        facing = _side(start[later], end[later], a) * _side(start[later], end[later], b)
        if (crossed := np.flatnonzero((apart < 0) & (facing < 0))).size:
            first, second = sorted((int(owner[n]), int(owner[n + 1 + crossed[0]])))
            return walls[first], walls[second]
    return None


def _side(a: np.ndarray, b: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Return 1 for points to the left of the line from a to b, -1 for points to its right, and 0 for points on it."""
    along, away = b - a, point - a
    return np.sign(along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0])

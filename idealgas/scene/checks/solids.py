"""Checks of solids: their curves are closed and do not cross, and no given disc is in them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from idealgas.physics.arc_geometry import drawn_points
from idealgas.scene.checks.overlaps import MOST_OVERLAPS, disc_keys, label
from idealgas.toml.issues import Issue

if TYPE_CHECKING:
    from idealgas.scene.document import Document


def solid_issues(scene: Document) -> Iterator[Issue]:
    """Errors of solids."""
    if not any(wall is not None and wall.solid for wall in scene.wall):
        return
    solids = scene.solids
    for k, end in solids.loose:
        allowed = f'an end of another wall with solid = "{scene.wall[k].solid}" there, and only one'
        yield Issue((("wall", k, "solid"),), "no closed curve", f"an end at {list(end)}", allowed)
    if solids.loose:
        return
    if crossing := _crossing(scene):
        a, b = crossing
        yield Issue(
            (("wall", a, "solid"), ("wall", b, "solid")), "curves that cross", f"wall {b}", "closed curves apart"
        )
    elif solids.area >= scene.box.size[0] * scene.box.size[1] * (1 - 1e-12):
        first = next(k for k, wall in enumerate(scene.wall) if wall is not None and wall.solid)
        yield Issue((("wall", first, "solid"),), "no area is left", "solids everywhere", "some place for the gas")
    discs = scene.given
    for k in np.flatnonzero(solids.contain(discs.position))[:MOST_OVERLAPS].tolist():
        number = int(discs.index[k])
        keys = disc_keys(scene, (number,), "position")
        yield Issue(keys, f"{label(scene, number)}in a solid", str(discs.position[k].tolist()), "a place out of it")


def _crossing(scene: Document) -> tuple[int, int] | None:
    """Numbers of two walls of solids that cross, as they are drawn; None without any."""
    parts = [
        (k, a, b)
        for k, wall in enumerate(scene.wall)
        if wall is not None and wall.solid
        for a, b in pairwise(drawn_points(wall.start, wall.end, wall.arc))
    ]
    parts.sort(key=lambda part: min(part[1][0], part[2][0]))
    owner = np.array([k for k, *_ in parts])
    start, end = (np.array([part[n] for part in parts]) for n in (1, 2))
    left, right = np.minimum(start, end)[:, 0], np.maximum(start, end)[:, 0]
    for n in range(len(parts)):
        a, b = start[n], end[n]
        later = slice(n + 1, int(left.searchsorted(right[n], "right")))  # those that begin before this one ends
        apart = _side(a, b, start[later]) * _side(a, b, end[later])
        facing = _side(start[later], end[later], a) * _side(start[later], end[later], b)
        if (found := np.flatnonzero((apart < 0) & (facing < 0))).size:
            first, second = sorted((int(owner[n]), int(owner[n + 1 + found[0]])))
            return first, second
    return None


def _side(a: np.ndarray, b: np.ndarray, point: np.ndarray) -> np.ndarray:
    """1 for points on the left of the lines from a to b, -1 on the right."""
    along, away = b - a, point - a
    return np.sign(along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0])

"""Walls that are nothing, nowhere, or in the way of a disc."""

from __future__ import annotations

import math
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.scene.checks.valid import valid
from idealgas.scene.geometry import distance_to_wall, images
from idealgas.sides import SIDES
from idealgas.toml.error import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.tables.box import Box
    from idealgas.scene.tables.document import Document
    from idealgas.scene.tables.wall import Wall

SHORTEST = 1e-9
"""Length of a wall in units of the box's longer side: below, a double cannot tell its ends apart."""


def issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Faults of single walls, of their names, and explicit discs that overlap one that is there at the start."""
    if "box" in invalid:
        return
    box = scene.box
    first: dict[str, int] = {}
    whole: list[tuple[int, Wall]] = []
    for i, wall in valid(scene.wall):
        found = list(_own_issues(box, i, wall))
        yield from found
        if not found:
            whole.append((i, wall))
        if wall.name in SIDES:
            yield Issue((("wall", i, "name"),), "name taken by a side of the box", f'"{wall.name}"', "any other word")
        elif wall.name is not None and first.setdefault(wall.name, i) != i:
            yield Issue((("wall", i, "name"),), "second wall of this name", f'"{wall.name}"', "a name of its own")
    for k, d in valid(scene.disc):
        for i, wall in whole:
            distance = min(distance_to_wall(centre, wall) for centre in images(d.position, d.radius, box))
            if wall.there_at_start and distance < d.radius:
                keys: tuple[Key, ...] = (("disc", k, "position"), ("disc", k, "radius"), ("wall", i))
                yield Issue(keys, f"overlaps wall {i}", f"a distance of {distance} to it", f">= {d.radius}, the radius")


def _own_issues(box: Box, i: int, wall: Wall) -> Iterator[Issue]:
    keys: tuple[Key, ...] = (("wall", i, "from"), ("wall", i, "to"))
    ends = f"{list(wall.start)} to {list(wall.end)}"
    if not all(0 <= end[axis] <= box.size[axis] for end in (wall.start, wall.end) for axis in range(2)):
        allowed = f"0 <= x <= {box.size[0]} and 0 <= y <= {box.size[1]} at both ends"
        yield Issue((*keys, ("box", "size")), "wall not in the box", ends, allowed)
    length = math.hypot(wall.end[0] - wall.start[0], wall.end[1] - wall.start[1])
    if length < SHORTEST * max(box.size):
        yield Issue(keys, "a wall of no length", ends, f"a length >= {SHORTEST * max(box.size)}")
    elif any(wall.start[a] == wall.end[a] in (0, box.size[a]) for a in range(2)):
        yield Issue(keys, "a wall along a side of the box", ends, "walls inside the box; a side is a wall already")
    if wall.opens_at is not None and wall.closes_at is not None and wall.closes_at <= wall.opens_at:
        keys = (("wall", i, "closes_at"), ("wall", i, "opens_at"))
        yield Issue(keys, "closes before it opens", f"{wall.closes_at}", f"> {wall.opens_at}")

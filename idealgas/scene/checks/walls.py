"""Checks of the walls that are declared in tables [[wall]]."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

from idealgas.columns import SIDES
from idealgas.effects.arc import FLATTEST
from idealgas.effects.schedule import as_times
from idealgas.physics.arc_geometry import bounds
from idealgas.toml.issues import Issue, Key

if TYPE_CHECKING:
    from idealgas.effects.wall import WallTable
    from idealgas.scene.document import Document

SHORTEST = 1e-9
"""Shortest wall in units of the box's longer side; double precision cannot separate the ends of a shorter wall."""


def walls_issues(scene: Document) -> Iterator[Issue]:
    """Check each wall and fixed disc separately, and check that the names of walls are unique."""
    size = scene.box.size
    for disc in scene.fixed_discs:
        if not all(0 <= x <= length for x, length in zip(disc.start, size, strict=True)):
            keys: tuple[Key, ...] = (("disc", disc.number, "position"), ("box", "size"))
            allowed = f"0 <= x <= {size[0]} and 0 <= y <= {size[1]}"
            yield Issue(keys, "fixed disc not in the box", str(list(disc.start)), allowed)
    first: dict[str, Key] = {}
    for wall in (wall for wall in scene.pieces if wall is not None):
        yield from wall_issues(size, wall)
        key = wall.key("name")
        if wall.name in (*SIDES, "piston"):
            taken = "the piston" if wall.name == "piston" else "a side of the box"
            yield Issue((key,), f"name taken by {taken}", f'"{wall.name}"', "any other word")
        elif wall.name is not None and first.setdefault(wall.name, key) != key:
            yield Issue((key,), "second wall with this name", f'"{wall.name}"', "a unique name")


def wall_issues(size: tuple[float, float], wall: WallTable) -> Iterator[Issue]:
    """Yield issues of a piece of a wall, except for its name.

    size: width and height of the box, length.
    """
    keys = wall.ends_keys
    ends = f"{list(wall.start)} to {list(wall.end)}"
    length = math.dist(wall.start, wall.end)
    if wall.via is not None:
        keys, ends = (wall.key("via"), *keys), f"{list(wall.start)} via {list(wall.via)} to {list(wall.end)}"
        arc, farthest = wall.arc, FLATTEST * max(size)
        nearest = min(math.dist(wall.via, wall.start), math.dist(wall.via, wall.end))
        if arc is None or arc.radius > farthest or nearest < SHORTEST * max(size):
            yield Issue(keys, "no arc through these points", ends, f"points not on a line, a radius <= {farthest:g}")
            return
    low, high = bounds(wall.start, wall.end, wall.arc)
    slack = SHORTEST * max(size) if wall.via else 0.0  # rounding of an arc
    allowed = f"0 <= x <= {size[0]} and 0 <= y <= {size[1]}"
    if wall.piece is not None:
        for key, point in zip(keys, (wall.start, wall.end), strict=True):
            if not all(0 <= x <= most for x, most in zip(point, size, strict=True)):
                yield Issue((key, ("box", "size")), "point not in the box", str(list(point)), allowed)
    elif not all(-slack <= low[axis] and high[axis] <= size[axis] + slack for axis in range(2)):
        yield Issue((*keys, ("box", "size")), "wall not in the box", ends, f"{allowed} everywhere")
    if wall.via is not None and wall.start == wall.end:
        pass
    elif length < SHORTEST * max(size):
        closing = "; closed = true joins the last point to the first" if wall.piece and keys[1][-1] == 0 else ""
        yield Issue(keys, "wall too short", ends, f"a length >= {SHORTEST * max(size)}{closing}")
    elif wall.via is None and any(wall.start[a] == wall.end[a] in (0, size[a]) for a in range(2)):
        yield Issue(
            keys, "a wall along a side of the box", ends, "walls inside the box; the sides of the box are already walls"
        )
    times = [time for absence in wall.absences for time in absence]
    if wall.is_permeable and wall.solid:
        keys = (wall.key("solid"), wall.key("permeable_to"), wall.key("permeable_from"))
        yield Issue(keys, "a solid that lets discs pass", f'"{wall.solid}" and a permeable wall', "only one of them")
    if wall.absorbing and wall.temperature is not None:
        keys = (wall.key("absorbing"), wall.key("temperature"))
        yield Issue(keys, "an absorbing wall with a temperature", str(wall.temperature), "only one of them")
    if times and wall.solid:
        keys = (wall.key("solid"), wall.key("opens_at"), wall.key("closes_at"))
        yield Issue(keys, "a solid that opens", f'"{wall.solid}" and a gate', "only one of them")
    if any(later <= earlier for earlier, later in pairwise(times)):
        keys = (wall.key("closes_at"), wall.key("opens_at"))
        opens, closes = as_times(wall.opens_at), as_times(wall.closes_at)
        single = len(opens) == len(closes) == 1
        allowed = f"> {wall.opens_at}" if single else "times in order, each opening before its closing"
        wrong = "closes before it opens" if single else "openings and closings do not alternate"
        yield Issue(keys, wrong, str(closes[0]) if single else f"{list(closes)} after {list(opens)}", allowed)

"""Checks of vibrating sides: room for the discs between them, and walls too close to them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from idealgas.columns import SIDES, sides_across
from idealgas.effects.vibration import reach
from idealgas.scene.checks.piston import least_depth
from idealgas.toml.issues import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.document import Document


def issues(scene: Document) -> Iterator[Issue]:
    """Check the vibrating sides of a scene whose tables are valid."""
    for axis in range(2):
        heights = {SIDES[side]: reach(scene.box.sides[side]) for side in sides_across(axis)}
        keys: tuple[Key, ...] = tuple(("box", name, "vibrating", "amplitude") for name, h in heights.items() if h)
        size, least = scene.box.size[axis], least_depth(scene, axis)
        if keys and size < least:
            yield Issue((*keys, ("box", "size")), "crushes the gas", f"a box of {size:.6g}", f">= {least:.6g}")
        for i, wall in enumerate(scene.wall):
            for name, height in heights.items():
                above = abs(wall.start[axis] - scene.box.size[axis] * (SIDES.index(name) % 2))
                if height and wall.start[axis] == wall.end[axis] and above < height + 2 * scene.largest_radius:
                    got, allowed = f"{above:.6g} from it", f">= {height + 2 * scene.largest_radius:.6g}"
                    place: tuple[Key, ...] = (("wall", i), ("box", name, "vibrating", "amplitude"))
                    yield Issue(place, f"discs crushed between the wall and the vibrating {name} side", got, allowed)

"""Checks of sheared sides and of vibrating sides."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from idealgas.columns import SIDES, sides_across
from idealgas.effects import EFFECTS
from idealgas.effects.vibration import reach
from idealgas.scene.checks.piston import least_depth
from idealgas.toml.issues import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.document import Document

TOGETHER = tuple(effect.name for effect in EFFECTS if effect.shearable)
"""Effects that can be combined with sheared sides; none of them depends on the position along y."""

LEAST = 2.0
"""Smallest width and height of a box with sheared sides, in diameters of the largest disc."""


def shear_issues(scene: Document) -> Iterator[Issue]:
    """Check that sheared sides are combined only with compatible effects and leave room for a disc beside its image."""
    if not scene.properties.shear:
        return
    top: Key = ("box", "top", "shear")
    for effect in scene.active_effects:
        if effect.name not in TOGETHER:
            allowed = ", ".join(name for name in TOGETHER if name != "sheared sides")
            yield Issue((*effect.keys, top), "not supported between sheared sides", effect.name, allowed)
    if scene.log.pressure:
        keys: tuple[Key, ...] = (("log", "pressure"), top)
        yield Issue(keys, "not recorded between sheared sides", "pressure = true", "false")
    least = 2 * LEAST * scene.largest_radius
    if min(scene.box.size) < least:
        got = "{:.6g} by {:.6g}".format(*scene.box.size)
        yield Issue((("box", "size"), top), "box too small for sheared sides", got, f">= {least:.6g}")


def vibration_issues(scene: Document) -> Iterator[Issue]:
    """Check that vibrating sides leave room for the discs and that no wall is too close to a vibrating side."""
    for axis in range(2):
        heights = {SIDES[side]: reach(scene.box.sides[side]) for side in sides_across(axis)}
        keys: tuple[Key, ...] = tuple(("box", name, "vibrating", "amplitude") for name, h in heights.items() if h)
        size, least = scene.box.size[axis], least_depth(scene, axis)
        if keys and size < least:
            yield Issue((*keys, ("box", "size")), "crushes the gas", f"a box of {size:.6g}", f">= {least:.6g}")
        for wall in scene.pieces:
            for name, height in heights.items():
                above = abs(wall.start[axis] - scene.box.size[axis] * (SIDES.index(name) % 2))
                if height and wall.start[axis] == wall.end[axis] and above < height + 2 * scene.largest_radius:
                    got, allowed = f"{above:.6g} from it", f">= {height + 2 * scene.largest_radius:.6g}"
                    place: tuple[Key, ...] = (wall.place, ("box", name, "vibrating", "amplitude"))
                    yield Issue(place, f"discs crushed between the wall and the vibrating {name} side", got, allowed)

"""Checks of sheared sides: compatible effects, and room for a disc beside its image."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from idealgas.effects import EFFECTS
from idealgas.toml.issues import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.document import Document

TOGETHER = tuple(effect.name for effect in EFFECTS if effect.shearable)
"""Effects that a scene with sheared sides may have; none of them depends on the position along y."""

LEAST = 2.0
"""Smallest width and height of the box, in diameters of the largest disc."""


def issues(scene: Document) -> Iterator[Issue]:
    """Check a scene whose tables are valid, if it has sheared sides."""
    if not scene.properties.shear:
        return
    top: Key = ("box", "top", "shear")
    for effect in scene.active_effects:
        if effect.name not in TOGETHER:
            allowed = ", ".join(name for name in TOGETHER if name != "sheared sides")
            yield Issue((*effect.keys, top), "not between sheared sides", effect.name, allowed)
    if scene.log.pressure:
        keys: tuple[Key, ...] = (("log", "pressure"), top)
        yield Issue(keys, "not recorded between sheared sides", "pressure = true", "false")
    least = 2 * LEAST * scene.largest_radius
    if min(scene.box.size) < least:
        got = "{:.6g} by {:.6g}".format(*scene.box.size)
        yield Issue((("box", "size"), top), "box too small for sheared sides", got, f">= {least:.6g}")

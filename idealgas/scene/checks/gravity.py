"""Gravity that does nothing, or that nothing stops."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.sides import SIDES, sides_across
from idealgas.toml.error import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.tables.document import Document


def issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Gravity without acceleration, or along periodic sides, where discs would accelerate indefinitely."""
    gravity = scene.gravity
    if gravity is None or {"gravity", "box"} & invalid:
        return
    key: Key = ("gravity", "acceleration")
    if not any(gravity.acceleration):
        yield Issue((key,), "no acceleration", str(list(gravity.acceleration)), "no [gravity], or one that pulls")
    for axis, (acceleration, periodic) in enumerate(zip(gravity.acceleration, scene.box.periodic, strict=True)):
        if acceleration and periodic:
            low, high = (SIDES[side] for side in sides_across(axis))
            keys = (key, ("box", low), ("box", high))
            what = f"gravity through the periodic sides {low} and {high}"
            yield Issue(keys, what, f"a component of {acceleration}", "0, or sides that end the fall")

"""Gravity that does nothing, or that nothing stops."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from idealgas.document.error import Issue, Key
from idealgas.scene.tables.box import SIDES

if TYPE_CHECKING:
    from idealgas.scene.tables.box import Box
    from idealgas.scene.tables.gravity import Gravity


def gravity_issues(box: Box, gravity: Gravity) -> Iterator[Issue]:
    """Gravity that does not pull, or pulls through joined sides for ever."""
    key: Key = ("gravity", "acceleration")
    if not any(gravity.acceleration):
        yield Issue((key,), "no acceleration", str(list(gravity.acceleration)), "no [gravity], or one that pulls")
    for axis, (pull, periodic) in enumerate(zip(gravity.acceleration, box.periodic, strict=True)):
        if pull and periodic:
            low, high = SIDES[2 * axis : 2 * axis + 2]
            keys = (key, ("box", low), ("box", high))
            what = f"gravity through the periodic sides {low} and {high}"
            yield Issue(keys, what, f"a component of {pull}", "0, or sides that end the fall")

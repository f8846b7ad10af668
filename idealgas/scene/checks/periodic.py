"""Sides that are joined to none."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from idealgas.document.error import Issue, Key
from idealgas.scene.tables.box import SIDES

if TYPE_CHECKING:
    from idealgas.scene.tables.box import Box


def periodic_issues(box: Box) -> Iterator[Issue]:
    """Sides that are joined to none."""
    for axis in range(2):
        names = SIDES[2 * axis : 2 * axis + 2]
        periodic = [side == "periodic" for side in box.sides[2 * axis : 2 * axis + 2]]
        if any(periodic) and not all(periodic):
            this, other = names if periodic[0] else names[::-1]
            keys: tuple[Key, ...] = (("box", this), ("box", other))
            yield Issue(keys, "periodic on one side only", f"{other} not periodic", f"{this} and {other} periodic")

"""Checks of periodic sides: opposite sides are periodic together."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.scene.tables.periodic import PERIODIC
from idealgas.sides import SIDES, sides_across
from idealgas.toml.error import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.tables.document import Document


def issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Periodic sides that face one which is not."""
    for axis in range(2) if "box" not in invalid else ():
        names = [SIDES[side] for side in sides_across(axis)]
        periodic = [scene.box.sides[side] == PERIODIC for side in sides_across(axis)]
        if any(periodic) and not all(periodic):
            this, other = names if periodic[0] else names[::-1]
            keys: tuple[Key, ...] = (("box", this), ("box", other))
            yield Issue(keys, "periodic on one side only", f"{other} not periodic", f"{this} and {other} periodic")

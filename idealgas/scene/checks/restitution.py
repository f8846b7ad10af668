"""A contact duration that has no default."""

from __future__ import annotations

import math
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.toml.error import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.tables.document import Document


def issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """A contact duration that has no default."""
    restitution = scene.restitution
    needed = {"restitution", "species", "disc", "box", "gravity", "piston"}
    if restitution is None or restitution.elastic or needed & invalid or not (scene.species or scene.disc):
        return
    if math.isinf(scene.contact_duration):
        keys: tuple[Key, ...] = (("restitution", "contact_duration"),)
        yield Issue(keys, "no default where nothing moves at the start", "nothing", "a time > 0")

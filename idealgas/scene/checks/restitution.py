"""A contact duration that has no default."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from idealgas.document.error import Issue, Key
from idealgas.scene.defaults import contact_duration

if TYPE_CHECKING:
    from idealgas.scene.tables.discs import Disc, Species
    from idealgas.scene.tables.restitution import Restitution


def restitution_issues(restitution: Restitution, species: Sequence[Species], disc: Sequence[Disc]) -> Iterator[Issue]:
    """A contact duration that has no default."""
    if not restitution.elastic and math.isinf(contact_duration(restitution, species, disc)):
        keys: tuple[Key, ...] = (("restitution", "contact_duration"),)
        yield Issue(keys, "no default where nothing moves at the start", "nothing", "a time > 0")

"""What is wrong with a scene as a whole: every check of every table, put together."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.scene.checks import gravity, periodic, piston, restitution, rotation, thermostat, wall
from idealgas.scene.checks.discs import overlap_issues, room_issues, species_issues
from idealgas.scene.checks.placement import placement_issues
from idealgas.scene.checks.run import endless_issues, method_issues, number_issues
from idealgas.scene.checks.valid import valid
from idealgas.toml.error import Issue

if TYPE_CHECKING:
    from idealgas.scene.tables.document import Document

EFFECTS = (rotation, restitution, periodic, wall, gravity, piston, thermostat)
"""Checks of the effects; of thermal walls there is nothing to check that their numbers do not say."""


def issues(scene: Document, invalid: AbstractSet[str] = frozenset()) -> Iterator[Issue]:
    """Faults between the tables of a scene, and between the keys of one.

    Tables named in `invalid`, and None in an array of tables, have issues of their own and are left out.
    """
    kinds, discs = valid(scene.species), valid(scene.disc)
    box = None if "box" in invalid else scene.box
    if not scene.species and not scene.disc:
        yield Issue((("species",),), "no discs", "nothing", "at least one [[species]] or [[disc]]")
    yield from species_issues(kinds)
    yield from overlap_issues(discs, box)
    for effect in EFFECTS:
        yield from effect.issues(scene, invalid)
    if box is not None:
        yield from room_issues(box, scene.room, kinds, discs, invalid)
        yield from placement_issues(scene, kinds)
    if not {"run", "species", "disc", "gravity", "piston"} & invalid:
        yield from endless_issues(scene)
        if box is not None and (scene.species or scene.disc):
            yield from number_issues(scene, invalid)
    if "run" not in invalid:
        yield from method_issues(scene, invalid)

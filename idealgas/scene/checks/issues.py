"""What is wrong with a scene as a whole: every check of every table, in one place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING, TypeVar

from idealgas.document.error import Issue
from idealgas.scene.checks.gravity import gravity_issues
from idealgas.scene.checks.periodic import periodic_issues
from idealgas.scene.checks.piston import piston_issues
from idealgas.scene.checks.restitution import restitution_issues
from idealgas.scene.checks.rotation import rotation_issues
from idealgas.scene.checks.run import endless_issues, method_issues
from idealgas.scene.checks.wall import wall_issues
from idealgas.scene.geometry import room

if TYPE_CHECKING:
    from idealgas.scene.tables.document import Document
from idealgas.scene.checks.discs import overlap_issues, room_issues, species_issues

Item = TypeVar("Item")


def issues(scene: Document, invalid: AbstractSet[str] = frozenset()) -> Iterator[Issue]:
    """Faults between the tables of a scene, and between the keys of one.

    Tables named in `unsound`, and None in an array of tables, have faults of their own and are left out.
    """
    kinds, discs, walls = _valid(scene.species), _valid(scene.disc), _valid(scene.wall)
    box = None if "box" in invalid else scene.box
    piston = None if "piston" in invalid else scene.piston
    if not scene.species and not scene.disc:
        yield Issue((("species",),), "no discs", "nothing", "at least one [[species]] or [[disc]]")
    yield from species_issues(kinds)
    if "rotation" not in invalid:
        yield from rotation_issues(scene.rotation, kinds, discs)
    if scene.restitution and not {"restitution", "species", "disc"} & invalid:
        yield from restitution_issues(scene.restitution, scene.species, scene.disc)
    yield from overlap_issues(discs, box)
    if box is not None:
        yield from periodic_issues(box)
        yield from wall_issues(box, walls, discs)
        if scene.gravity and "gravity" not in invalid:
            yield from gravity_issues(box, scene.gravity)
        if piston is not None and not invalid:
            yield from piston_issues(scene, piston)
        confined = piston is not None and 0 <= piston.start(box.size) <= box.size[piston.axis]
        yield from room_issues(box, room(box, piston if confined else None), kinds, discs, invalid)
    if not {"run", "species", "disc", "gravity", "piston"} & invalid:
        yield from endless_issues(scene)
    if "run" not in invalid:
        yield from method_issues(scene, invalid)


def _valid(items: Sequence[Item | None]) -> list[tuple[int, Item]]:
    return [(i, item) for i, item in enumerate(items) if item is not None]

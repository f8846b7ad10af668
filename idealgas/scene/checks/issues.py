"""What is wrong with a scene as a whole: every check of every table, in one place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING, TypeVar

from idealgas.document.error import Fault
from idealgas.scene.checks.gravity import gravity_faults
from idealgas.scene.checks.periodic import side_faults
from idealgas.scene.checks.piston import piston_faults
from idealgas.scene.checks.restitution import restitution_faults
from idealgas.scene.checks.rotation import spin_faults
from idealgas.scene.checks.run import endless_faults, method_faults
from idealgas.scene.checks.wall import wall_faults
from idealgas.scene.geometry import room

if TYPE_CHECKING:
    from idealgas.scene.tables.document import Document
from idealgas.scene.checks.discs import overlap_faults, room_faults, species_faults

Item = TypeVar("Item")


def faults(scene: Document, unsound: AbstractSet[str] = frozenset()) -> Iterator[Fault]:
    """Faults between the tables of a scene, and between the keys of one.

    Tables named in `unsound`, and None in an array of tables, have faults of their own and are left out.
    """
    kinds, discs, walls = _sound(scene.species), _sound(scene.disc), _sound(scene.wall)
    box = None if "box" in unsound else scene.box
    piston = None if "piston" in unsound else scene.piston
    if not scene.species and not scene.disc:
        yield Fault((("species",),), "no discs", "nothing", "at least one [[species]] or [[disc]]")
    yield from species_faults(kinds)
    if "rotation" not in unsound:
        yield from spin_faults(scene.rotation, kinds, discs)
    if scene.restitution and not {"restitution", "species", "disc"} & unsound:
        yield from restitution_faults(scene.restitution, scene.species, scene.disc)
    yield from overlap_faults(discs, box)
    if box is not None:
        yield from side_faults(box)
        yield from wall_faults(box, walls, discs)
        if scene.gravity and "gravity" not in unsound:
            yield from gravity_faults(box, scene.gravity)
        if piston is not None and not unsound:
            yield from piston_faults(scene, piston)
        confined = piston is not None and 0 <= piston.start(box.size) <= box.size[piston.axis]
        yield from room_faults(box, room(box, piston if confined else None), kinds, discs, unsound)
    if not {"run", "species", "disc", "gravity", "piston"} & unsound:
        yield from endless_faults(scene)
    if "run" not in unsound:
        yield from method_faults(scene, unsound)


def _sound(items: Sequence[Item | None]) -> list[tuple[int, Item]]:
    return [(i, item) for i, item in enumerate(items) if item is not None]

"""Effects that do not go together or that do nothing."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from idealgas.scene.defaults import contact_duration
from idealgas.scene.effects import SIDES
from idealgas.scene.fault import Fault, Key

if TYPE_CHECKING:
    from idealgas.scene.effects import Gravity, Restitution, Rotation
    from idealgas.scene.model import Box, Disc, Species


def side_faults(box: Box) -> Iterator[Fault]:
    """Sides that are joined to none."""
    for axis in range(2):
        names = SIDES[2 * axis : 2 * axis + 2]
        periodic = [side == "periodic" for side in box.sides[2 * axis : 2 * axis + 2]]
        if any(periodic) and not all(periodic):
            this, other = names if periodic[0] else names[::-1]
            keys: tuple[Key, ...] = (("box", this), ("box", other))
            yield Fault(keys, "periodic on one side only", f"{other} not periodic", f"{this} and {other} periodic")


def gravity_faults(box: Box, gravity: Gravity) -> Iterator[Fault]:
    """Gravity that does not pull, or pulls through joined sides for ever."""
    key: Key = ("gravity", "acceleration")
    if not any(gravity.acceleration):
        yield Fault((key,), "no acceleration", str(list(gravity.acceleration)), "no [gravity], or one that pulls")
    for axis, (pull, joined) in enumerate(zip(gravity.acceleration, box.joined, strict=True)):
        if pull and joined:
            low, high = SIDES[2 * axis : 2 * axis + 2]
            keys = (key, ("box", low), ("box", high))
            what = f"gravity through the periodic sides {low} and {high}"
            yield Fault(keys, what, f"a component of {pull}", "0, or sides that end the fall")


def spin_faults(
    rotation: Rotation | None, species: list[tuple[int, Species]], disc: list[tuple[int, Disc]]
) -> Iterator[Fault]:
    """Spins without rotation, and rotation that no spin ever feels."""
    for table, items in (("species", species), ("disc", disc)):
        for i, item in items:
            given = [key for key in ("angular_velocity", "spin_temperature") if getattr(item, key, None) is not None]
            keys: tuple[Key, ...] = tuple((table, i, key) for key in given)
            if given and rotation is None:
                yield Fault((*keys, ("rotation",)), "a spin without rotation", given[0], "it with a table [rotation]")
            elif len(given) > 1:
                yield Fault(keys, "two spins", " and ".join(given), "one of them")
    if rotation is not None and rotation.roughness == -1 and rotation.wall_roughness == -1:
        keys = (("rotation", "roughness"), ("rotation", "wall_roughness"))
        allowed = "no [rotation], or a roughness > -1"
        yield Fault(keys, "spins that nothing changes", "smooth discs and smooth walls", allowed)


def restitution_faults(restitution: Restitution, species: Sequence[Species], disc: Sequence[Disc]) -> Iterator[Fault]:
    """A contact duration that has no default."""
    if not restitution.elastic and math.isinf(contact_duration(restitution, species, disc)):
        keys: tuple[Key, ...] = (("restitution", "contact_duration"),)
        yield Fault(keys, "no default where nothing moves at the start", "nothing", "a time > 0")

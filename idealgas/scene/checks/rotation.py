"""Spins without rotation, and rotation that no spin ever feels."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.scene.checks.valid import valid
from idealgas.toml.error import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.tables.document import Document


def issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Spins without rotation, and rotation that no spin ever feels."""
    rotation = scene.rotation
    if "rotation" in invalid:
        return
    for table, items in (("species", scene.species), ("disc", scene.disc)):
        for i, item in valid(items):
            given = [key for key in ("angular_velocity", "spin_temperature") if getattr(item, key, None) is not None]
            keys: tuple[Key, ...] = tuple((table, i, key) for key in given)
            if given and rotation is None:
                yield Issue((*keys, ("rotation",)), "a spin without rotation", given[0], "it with a table [rotation]")
            elif len(given) > 1:
                yield Issue(keys, "two spins", " and ".join(given), "one of them")
    smooth = rotation is not None and rotation.roughness == -1 and rotation.wall_roughness == -1
    if smooth and scene.thermostat is None and "thermostat" not in invalid:
        keys = (("rotation", "roughness"), ("rotation", "wall_roughness"))
        allowed = "no [rotation], or a roughness > -1"
        yield Issue(keys, "spins that nothing changes", "smooth discs and smooth walls", allowed)

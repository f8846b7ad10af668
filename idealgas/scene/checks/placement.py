"""Whether discs can be placed as asked on a triangular lattice, or by compression; nothing here makes an array."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from idealgas.scene.lattice import triangular_lattice
from idealgas.toml.error import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.tables.discs import Species
    from idealgas.scene.tables.document import Document

PERIODIC_ONLY = ("triangular", "compressed")
"""Placements that take the whole of a periodic box."""

NARROWEST = 5.0
"""Smallest width of a box in which discs are compressed, in radii: a disc must not meet two images of another one."""


def placement_issues(scene: Document, kinds: list[tuple[int, Species]]) -> Iterator[Issue]:
    """Species on a triangular lattice or compressed whose box does not suit, and lattices without room."""
    some = [(i, s) for i, s in kinds if s.placement in PERIODIC_ONLY]
    for i, s in some:
        keys: tuple[Key, ...] = (("species", i, "placement"),)
        if not all(scene.box.periodic):
            sides = tuple(("box", side) for side in ("left", "right", "bottom", "top"))
            yield Issue((*keys, *sides), f"{s.placement} in a box with sides", f'"{s.placement}"', "periodic sides")
        elif s.region is not None:
            yield Issue(
                (("species", i, "region"), *keys), f"region for {s.placement} discs", str(list(s.region)), "none"
            )
        elif s.placement == "compressed":
            yield from _compressed(scene, kinds, i)
    lattice = [(i, s) for i, s in some if s.placement == "triangular"]
    if lattice and all(scene.box.periodic):
        yield from _on_lattice(scene.box.size, lattice)


def _compressed(scene: Document, kinds: list[tuple[int, Species]], i: int) -> Iterator[Issue]:
    """Compression of a species beside what does not move, or in a box that is too narrow."""
    key: Key = ("species", i, "placement")
    others = [f"species.{k}.placement = {s.placement}" for k, s in kinds if s.placement != "compressed"]
    others += ["[[disc]]"] if scene.disc else []
    others += ["[[wall]]"] if scene.wall else []
    if others:
        allowed = "compressed for all species, and no [[disc]] or [[wall]]"
        yield Issue((key,), "compressed beside what is not", ", ".join(others), allowed)
    least = NARROWEST * max(s.radius for _, s in kinds)
    if min(scene.box.size) < least:
        got = f"a side of {min(scene.box.size)}"
        yield Issue((key, ("box", "size")), "box too narrow to compress the discs in it", got, f">= {least}")


def _on_lattice(size: tuple[float, float], kinds: list[tuple[int, Species]]) -> Iterator[Issue]:
    """Discs that do not fit on their triangular lattice."""
    number, first = sum(s.count for _, s in kinds), kinds[0][0]
    keys: tuple[Key, ...] = (("species", first, "count"), ("species", first, "placement"), ("box", "size"))
    lattice = triangular_lattice(number, size)
    if lattice is None:
        yield Issue(keys, "no triangular lattice through periodic sides", f"{number} discs", "an even number of discs")
        return
    least = 2 * max(s.radius for _, s in kinds)
    if lattice.nearest < least:
        got = f"sites {lattice.nearest:.6g} apart, {lattice.columns} in each of {lattice.rows} rows"
        allowed = f">= {least:.6g}, two radii; box.size = {list(lattice.unstrained)} has no strain"
        yield Issue(keys, "no room for all discs on a triangular lattice", got, allowed)

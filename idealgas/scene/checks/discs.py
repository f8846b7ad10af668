"""Checks of the discs: how they move, and whether they fit into the box and onto lattices."""

from __future__ import annotations

import math
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

import numpy as np

from idealgas.errors import did_you_mean
from idealgas.scene.checks.overlaps import MOST_OVERLAPS, disc_keys, label, rounding
from idealgas.scene.checks.piston import CLOSE_PACKING
from idealgas.scene.discs import EXPLICIT
from idealgas.scene.lattice import triangular_lattice
from idealgas.toml.issues import Issue, Key
from idealgas.toml.table import Rectangle

if TYPE_CHECKING:
    from idealgas.scene.document import Document
    from idealgas.scene.tables import Box, Species


RANDOM_PACKING = 0.65
"""Largest packing fraction at which discs can be placed at random; see `idealgas.initial.placement`."""

RESOLUTION = 1e-9
"""Smallest radius relative to the longer side of the box; below it, floats may not distinguish a contact from a gap."""

PERIODIC_ONLY = ("triangular", "compressed")
"""Placements that require a box with four periodic sides and fill all of it."""

NARROWEST = 5.0
"""Smallest width of a box for compression, in units of the largest radius.

It ensures that a disc never meets two periodic images of the same disc.
"""


def species_issues(scene: Document) -> Iterator[Issue]:
    """Check that species have unique names, enough discs, and exactly one kind of initial motion."""
    first: dict[str, int] = {}
    numbers = scene.explicit_discs.numbers
    for i, s in scene.placed:
        if s.name == EXPLICIT and EXPLICIT not in numbers:
            yield Issue((("species", i, "name"),), "name taken by the [[disc]] tables", '"disc"', "any other word")
        elif first.setdefault(s.name, i) != i:
            yield Issue((("species", i, "name"),), "second species with this name", f'"{s.name}"', "a unique name")
        count, there = scene.species[i].count, numbers.get(s.name, 0)
        if there > count:
            yield Issue((("species", i, "count"), ("start",)), "fewer discs than are given", f"{count}", f">= {there}")
        given = [key for key in ("temperature", "speed", "velocities") if getattr(s, key) is not None]
        needed = s.count > 0 or scene.draws_velocities
        if len(given) > 1 or (needed and not given):
            keys = (("species", i), *(("species", i, key) for key in given))
            what = "more than one motion" if given else "no motion"
            yield Issue(
                keys, what, " and ".join(given) or "nothing", "exactly one of temperature, speed and velocities"
            )
        wanted = count if scene.draws_velocities else s.count
        if s.velocities is not None and needed and len(s.velocities) != wanted:
            keys = (("species", i, "velocities"), ("species", i, "count"))
            yield Issue(keys, "wrong number of velocities", str(len(s.velocities)), f"{wanted}, the value of count")
    yield from _given_species_issues(scene, first)


def _given_species_issues(scene: Document, tables: dict[str, int]) -> Iterator[Issue]:
    """Check that given discs agree with their species, and that they have a species if new velocities are drawn."""
    discs = scene.explicit_discs
    for k, name in enumerate(discs.names):
        if name not in tables:
            if scene.draws_velocities:
                allowed = f'a [[species]] table with name = "{name}"'
                yield Issue(
                    (("start", "velocities"), ("species",)), "no species for new velocities", "nothing", allowed
                )
            continue
        for key in ("radius", "mass"):
            expected = getattr(scene.species[tables[name]], key)
            if not isinstance(expected, float):
                continue
            differs = np.flatnonzero((discs.species == k) & (getattr(discs, key) != expected))
            for i in differs[:1]:
                number = int(discs.index[i])
                keys = (*disc_keys(scene, (number,), key), ("species", tables[name], key))
                wrong = f"{label(scene, number)}not the {key} of its species"
                yield Issue(keys, wrong, f"{getattr(discs, key)[i]}", f'{expected}, the value of species "{name}"')


def permeable_issues(scene: Document) -> Iterator[Issue]:
    """Check that each species named in `permeable_to` of a wall has discs."""
    known = dict.fromkeys((*(s.name for _, s in scene.placed), *scene.explicit_discs.names))
    for i, wall in enumerate(scene.wall):
        for name in (wall and wall.permeable_to) or ():
            if name not in known:
                key = ("wall", i, "permeable_to")
                wrong = f"no such species{did_you_mean(name, known)}"
                yield Issue((key,), wrong, f'"{name}"', " or ".join(f'"{each}"' for each in known))


def room_issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Check that the discs lie in the space available to the gas, and that their sizes and numbers are possible."""
    box, space, discs = scene.box, scene.room, scene.explicit_discs
    kinds = [(i, s) for i, s in scene.placed if s.count]
    outside = [*_regions_outside(scene, space, kinds), *_discs_outside(scene)]
    yield from outside
    smallest = RESOLUTION * max(box.size)
    small: list[tuple[tuple[Key, ...], str, float]] = [
        ((("species", i, "radius"),), "", min(size.radius for size in s.sizes)) for i, s in kinds
    ]
    for k in np.flatnonzero(discs.radius < smallest)[:MOST_OVERLAPS].tolist():
        number = int(discs.index[k])
        small.append((disc_keys(scene, (number,), "radius"), label(scene, number), float(discs.radius[k])))
    for keys, which, radius in small:
        if radius < smallest:
            wrong = f"{which}too small for the box in double precision"
            yield Issue((*keys, ("box", "size")), wrong, f"{radius}", f">= {smallest}")
    if not outside and not {"species", "disc"} & invalid and scene.properties.interacting:
        yield from _crowding(scene, _name_of(box, space), kinds)


def _regions_outside(scene: Document, space: Rectangle, kinds: list[tuple[int, Species]]) -> Iterator[Issue]:
    left, bottom, right, top = space
    place, limits = _name_of(scene.box, space), _limits(scene)
    for i, s in kinds:
        key: Key = ("species", i, "region")
        x0, y0, x1, y1 = s.region or space
        if not (left <= x0 < x1 <= right and bottom <= y0 < y1 <= top):
            allowed = f"[x0, y0, x1, y1] with {left:.17g} <= x0 < x1 <= {right} and {bottom:.17g} <= y0 < y1 <= {top}"
            yield Issue((key, *limits), f"region not in the {place}", str(list(s.region or space)), allowed)
        elif 2 * s.largest_radius > min(x1 - x0, y1 - y0):
            keys = (("species", i, "radius"), key, *limits)
            where = "region" if s.region else place
            got, allowed = f"{s.largest_radius}", f"<= {min(x1 - x0, y1 - y0) / 2}"
            yield Issue(keys, f"discs wider than the {where}", got, allowed)


def _discs_outside(scene: Document) -> Iterator[Issue]:
    """Check that given discs lie in the space available to the gas; at most MOST_OVERLAPS are reported."""
    box, space, discs = scene.box, scene.room, scene.explicit_discs
    limits = _limits(scene)
    place, widest = _name_of(box, space), min(space[2] - space[0], space[3] - space[1])
    slack = rounding(max(box.size), 2 * discs.radius) + scene.accepted_overlap
    inside = 2 * discs.radius <= widest
    for axis in range(2):
        x = discs.position[:, axis]
        low, high = space[axis] + discs.radius - slack, space[axis + 2] - discs.radius + slack
        inside &= ((x >= 0) & (x < box.size[axis])) if box.periodic[axis] else ((x >= low) & (x <= high))
    for k in np.flatnonzero(~inside)[:MOST_OVERLAPS].tolist():
        number, radius = int(discs.index[k]), float(discs.radius[k])
        which = label(scene, number)
        if 2 * radius > widest:
            keys = (*disc_keys(scene, (number,), "radius"), *limits)
            yield Issue(keys, f"{which or 'disc '}wider than the {place}", f"{radius}", f"<= {widest / 2}")
            continue
        allowed = " and ".join(
            f"0 <= {name} < {box.size[axis]}"
            if box.periodic[axis]
            else f"{space[axis] + radius} <= {name} <= {space[axis + 2] - radius}"
            for axis, name in enumerate("xy")
        )
        keys = (*disc_keys(scene, (number,), "position", "radius"), *limits)
        yield Issue(keys, f"{which or 'disc '}not in the {place}", str(discs.position[k].tolist()), allowed)


def _limits(scene: Document) -> tuple[Key, ...]:
    """Return the keys that determine the space available to the gas."""
    return (("box", "size"), *(("piston", k, "position") for k in range(len(scene.piston))))


def _name_of(box: Box, space: Rectangle) -> str:
    return "box" if space == (0.0, 0.0, *box.size) else "space in front of the piston"


def _crowding(scene: Document, name: str, kinds: list[tuple[int, Species]]) -> Iterator[Issue]:
    """Check the packing fraction in each region and in the whole space available to the gas."""
    whole, discs = scene.room, scene.explicit_discs
    for region in dict.fromkeys(s.region or whole for _, s in kinds):
        here = [(i, s) for i, s in kinds if region in (whole, s.region)]
        covered = math.pi * sum(_area(s) for _, s in here)
        area = (region[2] - region[0]) * (region[3] - region[1])
        if region == whole:
            covered += math.pi * math.fsum((discs.radius**2).tolist())
            area = scene.free_area
        packing = covered / area
        random = all(s.placement == "random" for _, s in here)
        if packing > (RANDOM_PACKING if random else CLOSE_PACKING):
            most = max(here, key=lambda item: _area(item[1]))[0]
            keys = [("species", i, key) for i, _ in here for key in ("count", "radius", "region", "placement")]
            place = name if region == whole else "region"
            allowed = f"<= {CLOSE_PACKING:.4f} on a lattice, <= {RANDOM_PACKING} at random"
            yield Issue(
                (("species", most, "count"), *keys, *_limits(scene)),
                f"too many discs for the {place}",
                f"packing fraction {packing:.4g}",
                allowed,
            )


def _area(species: Species) -> float:
    """Return the total area of the discs of a species, divided by π, length²."""
    return sum(size.number * size.radius**2 for size in species.sizes)


def placement_issues(scene: Document) -> Iterator[Issue]:
    """Check that the box is suitable for compressed discs and for triangular lattices."""
    kinds = [(i, s) for i, s in scene.placed if s.count]
    special = [(i, s) for i, s in kinds if s.placement in PERIODIC_ONLY]
    for i, s in special:
        keys: tuple[Key, ...] = (("species", i, "placement"),)
        if not all(scene.box.periodic):
            sides = tuple(("box", side) for side in ("left", "right", "bottom", "top"))
            yield Issue(
                (*keys, *sides),
                f"{s.placement} placement requires a periodic box",
                f'"{s.placement}"',
                "periodic sides",
            )
        elif s.region is not None:
            yield Issue(
                (("species", i, "region"), *keys), f"region for {s.placement} discs", str(list(s.region)), "none"
            )
        elif s.placement == "compressed":
            yield from _compressed(scene, kinds, i)
    lattice = [(i, s) for i, s in special if s.placement == "triangular"]
    if lattice and all(scene.box.periodic):
        yield from _on_lattice(scene.box.size, lattice)


def _compressed(scene: Document, kinds: list[tuple[int, Species]], i: int) -> Iterator[Issue]:
    """Check that compressed discs have a sufficiently wide box without walls, and that all discs are compressed."""
    key: Key = ("species", i, "placement")
    uncompressed = [f"species.{s.name}.placement = {s.placement}" for _, s in kinds if s.placement != "compressed"]
    uncompressed += ["[start]" if scene.start else "[[disc]]"] if len(scene.explicit_discs) else []
    uncompressed += ["[[wall]]"] if scene.walls else []
    if uncompressed:
        allowed = "compressed for all species, and no [[disc]], [start] or [[wall]]"
        yield Issue((key,), "not everything is compressed", ", ".join(uncompressed), allowed)
    least = NARROWEST * max(s.largest_radius for _, s in kinds)
    if min(scene.box.size) < least:
        got = f"a side of {min(scene.box.size)}"
        yield Issue((key, ("box", "size")), "box too narrow to compress the discs in it", got, f">= {least}")


def _on_lattice(size: tuple[float, float], kinds: list[tuple[int, Species]]) -> Iterator[Issue]:
    """Check that all discs fit on their triangular lattice."""
    number, first = sum(s.count for _, s in kinds), kinds[0][0]
    keys: tuple[Key, ...] = (("species", first, "count"), ("species", first, "placement"), ("box", "size"))
    lattice = triangular_lattice(number, size)
    if lattice is None:
        yield Issue(keys, "no triangular lattice fits a periodic box", f"{number} discs", "an even number of discs")
        return
    least = 2 * max(s.largest_radius for _, s in kinds)
    if lattice.nearest < least:
        got = f"sites {lattice.nearest:.6g} apart, {lattice.columns} in each of {lattice.rows} rows"
        allowed = f">= {least:.6g}, two radii; box.size = {list(lattice.unstrained)} has no strain"
        yield Issue(keys, "no room for all discs on a triangular lattice", got, allowed)

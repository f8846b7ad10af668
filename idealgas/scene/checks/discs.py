"""Whether the discs fit into the box and move; nothing here makes an array."""

from __future__ import annotations

import math
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.scene.checks.piston import CLOSE_PACKING
from idealgas.scene.geometry import images, overlaps
from idealgas.toml.error import Issue, Key
from idealgas.toml.table import Rectangle

if TYPE_CHECKING:
    from idealgas.scene.tables.box import Box
    from idealgas.scene.tables.discs import Disc, Species

RANDOM_PACKING = 0.65
"""Packing fraction up to which discs are placed at random; see `idealgas.initial.placement`."""

RESOLUTION = 1e-9
"""Smallest radius in units of the box's longer side: below, a double cannot tell contact from gap."""


MOST_OVERLAPS = 1_000
"""Lines about overlaps after which the others of a scene are not told."""


def species_issues(kinds: list[tuple[int, Species]]) -> Iterator[Issue]:
    """Species whose names are taken, or that do not say in exactly one way how their discs move."""
    first: dict[str, int] = {}
    for i, s in kinds:
        if s.name == "disc":
            yield Issue((("species", i, "name"),), "name taken by the [[disc]] tables", '"disc"', "any other word")
        elif first.setdefault(s.name, i) != i:
            yield Issue((("species", i, "name"),), "second species of this name", f'"{s.name}"', "a name of its own")
        given = [key for key in ("temperature", "speed", "velocities") if getattr(s, key) is not None]
        if len(given) != 1:
            keys = (("species", i), *(("species", i, key) for key in given))
            what = "more than one motion" if given else "no motion"
            yield Issue(
                keys, what, " and ".join(given) or "nothing", "exactly one of temperature, speed and velocities"
            )
        if s.velocities is not None and len(s.velocities) != s.count:
            keys = (("species", i, "velocities"), ("species", i, "count"))
            yield Issue(keys, "not one velocity for each disc", str(len(s.velocities)), f"{s.count}, as count says")


def overlap_issues(discs: list[tuple[int, Disc]], box: Box | None) -> Iterator[Issue]:
    """Explicit discs that overlap an earlier one, be it through periodic sides; the first MOST_OVERLAPS of them."""
    placed = [(i, d.radius, centre) for i, d in discs for centre in images(d.position, d.radius, box)]
    found: dict[tuple[int, int], float] = {}
    for a, b, distance in overlaps([(centre, radius) for _, radius, centre in placed]):
        pair = placed[a][0], placed[b][0]
        if pair[0] != pair[1] and len(found) < MOST_OVERLAPS:
            found.setdefault(pair, distance)
        elif len(found) == MOST_OVERLAPS:
            break
    radius = {i: d.radius for i, d in discs}
    for (low, high), distance in found.items():
        keys: tuple[Key, ...] = tuple(("disc", n, key) for key in ("position", "radius") for n in (high, low))
        got = f"a distance of {distance} between centres"
        yield Issue(keys, f"overlaps disc {low}", got, f">= {radius[low] + radius[high]}, the sum of the radii")


def room_issues(
    box: Box,
    space: Rectangle,
    kinds: list[tuple[int, Species]],
    discs: list[tuple[int, Disc]],
    invalid: AbstractSet[str],
) -> Iterator[Issue]:
    """Discs that are outside the space the gas has, too large or too small for it, or too many."""
    outside = [*_regions_outside(box, space, kinds), *_discs_outside(box, space, discs)]
    yield from outside
    smallest = RESOLUTION * max(box.size)
    for table, items in (("species", kinds), ("disc", discs)):
        for i, item in items:
            if item.radius < smallest:
                keys = ((table, i, "radius"), ("box", "size"))
                yield Issue(keys, "too small for the box in double precision", f"{item.radius}", f">= {smallest}")
    if not outside and not {"species", "disc"} & invalid:
        yield from _crowding(space, _name_of(box, space), kinds, discs)


def _regions_outside(box: Box, space: Rectangle, kinds: list[tuple[int, Species]]) -> Iterator[Issue]:
    left, bottom, right, top = space
    place = _name_of(box, space)
    others: tuple[Key, ...] = (("box", "size"), ("piston", "position"))
    for i, s in kinds:
        key: Key = ("species", i, "region")
        x0, y0, x1, y1 = s.region or space
        if not (left <= x0 < x1 <= right and bottom <= y0 < y1 <= top):
            allowed = f"[x0, y0, x1, y1] with {left:.17g} <= x0 < x1 <= {right} and {bottom:.17g} <= y0 < y1 <= {top}"
            yield Issue((key, *others), f"region not in the {place}", str(list(s.region or space)), allowed)
        elif 2 * s.radius > min(x1 - x0, y1 - y0):
            keys = (("species", i, "radius"), key, *others)
            where = "region" if s.region else place
            yield Issue(keys, f"discs wider than the {where}", f"{s.radius}", f"<= {min(x1 - x0, y1 - y0) / 2}")


def _discs_outside(box: Box, space: Rectangle, discs: list[tuple[int, Disc]]) -> Iterator[Issue]:
    place = _name_of(box, space)
    others: tuple[Key, ...] = (("box", "size"), ("piston", "position"))
    widest = min(space[2] - space[0], space[3] - space[1])
    for i, d in discs:
        if 2 * d.radius > widest:
            yield Issue(
                (("disc", i, "radius"), *others), f"disc wider than the {place}", f"{d.radius}", f"<= {widest / 2}"
            )
            continue
        allowed = []
        inside = True
        for axis, name in enumerate("xy"):
            low, high = space[axis] + d.radius, space[axis + 2] - d.radius
            if box.periodic[axis]:
                inside &= 0 <= d.position[axis] < box.size[axis]
                allowed.append(f"0 <= {name} < {box.size[axis]}")
            else:
                inside &= low <= d.position[axis] <= high
                allowed.append(f"{low} <= {name} <= {high}")
        if not inside:
            keys = (("disc", i, "position"), ("disc", i, "radius"), *others)
            yield Issue(keys, f"disc not in the {place}", str(list(d.position)), " and ".join(allowed))


def _name_of(box: Box, space: Rectangle) -> str:
    return "box" if space == (0.0, 0.0, *box.size) else "space before the piston"


def _crowding(
    whole: Rectangle, name: str, kinds: list[tuple[int, Species]], discs: list[tuple[int, Disc]]
) -> Iterator[Issue]:
    """More discs than a region, or the whole space of that name, can hold."""
    for region in dict.fromkeys(s.region or whole for _, s in kinds):
        here = [(i, s) for i, s in kinds if region in (whole, s.region)]
        covered = math.pi * sum(s.count * s.radius**2 for _, s in here)
        if region == whole:
            covered += math.pi * sum(d.radius**2 for _, d in discs)
        packing = covered / ((region[2] - region[0]) * (region[3] - region[1]))
        random = all(s.placement == "random" for _, s in here)
        if packing > (RANDOM_PACKING if random else CLOSE_PACKING):
            most = max(here, key=lambda item: item[1].count * item[1].radius ** 2)[0]
            others = [("species", i, key) for i, _ in here for key in ("count", "radius", "region", "placement")]
            place = name if region == whole else "region"
            allowed = f"<= {CLOSE_PACKING:.4f} on a lattice, <= {RANDOM_PACKING} at random"
            yield Issue(
                (("species", most, "count"), *others, ("box", "size"), ("piston", "position")),
                f"too many discs for the {place}",
                f"packing fraction {packing:.4g}",
                allowed,
            )

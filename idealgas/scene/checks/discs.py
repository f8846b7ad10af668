"""Checks of the discs: their motion, overlaps, and room in the box and on lattices."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.physics.motion import MAX_DISPLACEMENT
from idealgas.scene.checks.piston import CLOSE_PACKING
from idealgas.scene.lattice import triangular_lattice
from idealgas.toml.issues import Issue, Key
from idealgas.toml.table import Rectangle

if TYPE_CHECKING:
    from idealgas.effects.wall import Wall
    from idealgas.scene.document import Document
    from idealgas.scene.tables import Box, Disc, Species


RANDOM_PACKING = 0.65
"""Largest packing fraction of random placement; see `idealgas.initial.placement`."""

RESOLUTION = 1e-9
"""Smallest radius in units of the longer side of the box, so that floats distinguish contact from gap."""

ROUNDINGS = 16
"""Number of roundings of a coordinate at a contact: of two positions, two flights, and the time of the event."""

MOST_OVERLAPS = 1_000
"""Largest number of overlaps that are reported."""

PERIODIC_ONLY = ("triangular", "compressed")
"""Placements that need a whole periodic box."""

NARROWEST = 5.0
"""Smallest width of a box for compression, in radii, so that no disc meets two images of another one."""

Point = tuple[float, float]


def species_issues(kinds: list[tuple[int, Species]]) -> Iterator[Issue]:
    """Check that the names of species are unique, and that each has exactly one way of motion."""
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


def rounding(extent: float, reach: float) -> float:
    """Largest overlap (length) that rounding explains; the engine takes such discs for discs in contact.

    extent: largest coordinate, length. reach: distance of the centres at contact, or the diameter of a disc at a wall,
    length. The clock of an epoch adds the rounding of the path of its fastest disc.
    """
    return ROUNDINGS * 2.0**-53 * (extent + MAX_DISPLACEMENT * reach)


def overlap_issues(discs: list[tuple[int, Disc]], box: Box | None) -> Iterator[Issue]:
    """Report explicit discs that overlap, also through periodic sides, at most MOST_OVERLAPS pairs."""
    placed = [(i, d.radius, centre) for i, d in discs for centre in images(d.position, d.radius, box)]
    extent = max(box.size) if box else max((abs(x) for _, d in discs for x in d.position), default=0.0)
    found: dict[tuple[int, int], float] = {}
    for a, b, distance in overlaps([(centre, radius) for _, radius, centre in placed], extent):
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
    """Check that the discs lie in the space of the gas, and are not too large, too small or too many."""
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
        slack = rounding(max(box.size), 2 * d.radius)
        for axis, name in enumerate("xy"):
            low, high = space[axis] + d.radius, space[axis + 2] - d.radius
            if box.periodic[axis]:
                inside &= 0 <= d.position[axis] < box.size[axis]
                allowed.append(f"0 <= {name} < {box.size[axis]}")
            else:
                inside &= low - slack <= d.position[axis] <= high + slack
                allowed.append(f"{low} <= {name} <= {high}")
        if not inside:
            keys = (("disc", i, "position"), ("disc", i, "radius"), *others)
            yield Issue(keys, f"disc not in the {place}", str(list(d.position)), " and ".join(allowed))


def _name_of(box: Box, space: Rectangle) -> str:
    return "box" if space == (0.0, 0.0, *box.size) else "space before the piston"


def _crowding(
    whole: Rectangle, name: str, kinds: list[tuple[int, Species]], discs: list[tuple[int, Disc]]
) -> Iterator[Issue]:
    """Check the packing fractions of the regions and of the whole space."""
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


def placement_issues(scene: Document, kinds: list[tuple[int, Species]]) -> Iterator[Issue]:
    """Check the boxes of compressed discs and of triangular lattices."""
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
    """Check for compression in a narrow box, or next to discs and walls that are not compressed."""
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
    """Check that all discs fit on their triangular lattice."""
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


def images(centre: Point, radius: float, box: Box | None) -> Iterator[Point]:
    """Centre of a disc, and those of its images that reach into a periodic box."""
    shifts = []
    for axis in range(2):
        here = [0.0]
        if box is not None and box.periodic[axis]:
            if centre[axis] < radius:
                here.append(box.size[axis])
            if centre[axis] > box.size[axis] - radius:
                here.append(-box.size[axis])
        shifts.append(here)
    for dx in shifts[0]:
        for dy in shifts[1]:
            yield centre[0] + dx, centre[1] + dy


def overlaps(discs: Sequence[tuple[Point, float]], extent: float) -> Iterator[tuple[int, int, float]]:
    """Indices of two discs that overlap, the lower one first, and their distance; each disc is (centre, radius).

    extent: largest coordinate, length, from which it follows what counts as rounding.

    Discs of about one radius, from a power of two to the next, share a grid with cells no smaller than their diameter.
    Each disc is compared with those of the nine cells around it in the grids of its own size and of larger ones, so
    the time is that of N log N, unless very many discs overlap.
    """
    size = [math.frexp(radius)[1] for _, radius in discs]  # radius < 2^size
    grids: dict[int, dict[tuple[int, int], list[int]]] = {level: {} for level in sorted(set(size))}
    for i, (centre, _) in enumerate(discs):
        grids[size[i]].setdefault(_cell(centre, size[i]), []).append(i)
    for i, (centre, radius) in enumerate(discs):
        for level, grid in grids.items():
            if level < size[i]:
                continue
            column, row = _cell(centre, level)
            for cell in ((column + c, row + r) for c in (-1, 0, 1) for r in (-1, 0, 1)):
                for k in grid.get(cell, ()):
                    other, reach = discs[k][0], radius + discs[k][1]
                    reach -= rounding(extent, reach)
                    dx, dy = centre[0] - other[0], centre[1] - other[1]
                    if dx * dx + dy * dy < reach * reach and (k < i or level > size[i]):
                        yield min(i, k), max(i, k), math.hypot(dx, dy)


def _cell(centre: Point, size: int) -> tuple[int, int]:
    """Column and row of a point in a grid of cells of the width 2 * 2^size."""
    return math.floor(math.ldexp(centre[0], -size - 1)), math.floor(math.ldexp(centre[1], -size - 1))


def distance_to_wall(point: Point, wall: Wall) -> float:
    """Distance of a point from a wall."""
    along = (wall.end[0] - wall.start[0], wall.end[1] - wall.start[1])
    x, y = point[0] - wall.start[0], point[1] - wall.start[1]
    share = min(max((x * along[0] + y * along[1]) / (along[0] ** 2 + along[1] ** 2), 0.0), 1.0)
    return math.hypot(x - share * along[0], y - share * along[1])

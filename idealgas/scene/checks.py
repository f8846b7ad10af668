"""What no table can know alone: whether discs fit, move and come to an end. Nothing here makes an array."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING, TypeVar

from idealgas.scene.effect_checks import gravity_faults, restitution_faults, side_faults, spin_faults
from idealgas.scene.fault import Fault, Key
from idealgas.scene.geometry import images, room
from idealgas.scene.method_checks import method_faults
from idealgas.scene.piston_checks import CLOSE_PACKING, piston_faults
from idealgas.scene.table import Rectangle
from idealgas.scene.wall_checks import wall_faults

if TYPE_CHECKING:
    from idealgas.scene.model import Box, Disc, Scene, Species

RANDOM_PACKING = 0.65
"""Packing fraction up to which discs are placed at random; see `idealgas.placement`."""

RESOLUTION = 1e-9
"""Smallest radius in units of the box's longer side: below, a double cannot tell contact from gap."""


Item = TypeVar("Item")


def faults(scene: Scene, unsound: AbstractSet[str] = frozenset()) -> Iterator[Fault]:
    """Faults between the tables of a scene, and between the keys of one.

    Tables named in `unsound`, and None in an array of tables, have faults of their own and are left out.
    """
    kinds, discs, walls = _sound(scene.species), _sound(scene.disc), _sound(scene.wall)
    box = None if "box" in unsound else scene.box
    piston = None if "piston" in unsound else scene.piston
    if not scene.species and not scene.disc:
        yield Fault((("species",),), "no discs", "nothing", "at least one [[species]] or [[disc]]")
    yield from _species_faults(kinds)
    if "rotation" not in unsound:
        yield from spin_faults(scene.rotation, kinds, discs)
    if scene.restitution and not {"restitution", "species", "disc"} & unsound:
        yield from restitution_faults(scene.restitution, scene.species, scene.disc)
    yield from _overlaps(discs, box)
    if box is not None:
        yield from side_faults(box)
        yield from wall_faults(box, walls, discs)
        if scene.gravity and "gravity" not in unsound:
            yield from gravity_faults(box, scene.gravity)
        if piston is not None and not unsound:
            yield from piston_faults(scene, piston)
        confined = piston is not None and 0 <= piston.start(box.size) <= box.size[piston.axis]
        yield from _room_faults(box, room(box, piston if confined else None), kinds, discs, unsound)
    if not {"run", "species", "disc", "gravity", "piston"} & unsound:
        yield from _endless(scene)
    if "run" not in unsound:
        yield from method_faults(scene, unsound)


def _sound(items: Sequence[Item | None]) -> list[tuple[int, Item]]:
    return [(i, item) for i, item in enumerate(items) if item is not None]


def _species_faults(kinds: list[tuple[int, Species]]) -> Iterator[Fault]:
    first: dict[str, int] = {}
    for i, s in kinds:
        if s.name == "disc":
            yield Fault((("species", i, "name"),), "name taken by the [[disc]] tables", '"disc"', "any other word")
        elif first.setdefault(s.name, i) != i:
            yield Fault((("species", i, "name"),), "second species of this name", f'"{s.name}"', "a name of its own")
        given = [key for key in ("temperature", "speed", "velocities") if getattr(s, key) is not None]
        if len(given) != 1:
            keys = (("species", i), *(("species", i, key) for key in given))
            what = "more than one motion" if given else "no motion"
            yield Fault(
                keys, what, " and ".join(given) or "nothing", "exactly one of temperature, speed and velocities"
            )
        if s.velocities is not None and len(s.velocities) != s.count:
            keys = (("species", i, "velocities"), ("species", i, "count"))
            yield Fault(keys, "not one velocity for each disc", str(len(s.velocities)), f"{s.count}, as count says")


def _overlaps(discs: list[tuple[int, Disc]], box: Box | None) -> Iterator[Fault]:
    """Explicit discs that overlap an earlier one, found by a sweep along x over the discs and their images."""
    seen: set[tuple[int, int]] = set()
    active: list[tuple[int, Disc, float, float]] = []
    placed = [(i, d, x, y) for i, d in discs for x, y in images(d.position, d.radius, box)]
    for i, d, x, y in sorted(placed, key=lambda item: item[2] - item[1].radius):
        active = [item for item in active if item[2] + item[1].radius > x - d.radius]
        for k, a, a_x, a_y in active:
            dx, dy, contact = a_x - x, a_y - y, a.radius + d.radius
            low, high = sorted((i, k))
            if dx * dx + dy * dy < contact * contact and low != high and (low, high) not in seen:
                seen.add((low, high))
                keys: tuple[Key, ...] = tuple(("disc", n, key) for key in ("position", "radius") for n in (high, low))
                distance = f"a distance of {math.hypot(dx, dy)} between centres"
                yield Fault(keys, f"overlaps disc {low}", distance, f">= {contact}, the sum of the radii")
        active.append((i, d, x, y))


def _room_faults(
    box: Box,
    space: Rectangle,
    kinds: list[tuple[int, Species]],
    discs: list[tuple[int, Disc]],
    unsound: AbstractSet[str],
) -> Iterator[Fault]:
    """Discs that are outside the space the gas has, too large or too small for it, or too many."""
    outside = [*_regions_outside(box, space, kinds), *_discs_outside(box, space, discs)]
    yield from outside
    smallest = RESOLUTION * max(box.size)
    for table, items in (("species", kinds), ("disc", discs)):
        for i, item in items:
            if item.radius < smallest:
                keys = ((table, i, "radius"), ("box", "size"))
                yield Fault(keys, "too small for the box in double precision", f"{item.radius}", f">= {smallest}")
    if not outside and not {"species", "disc"} & unsound:
        yield from _crowding(space, _name_of(box, space), kinds, discs)


def _regions_outside(box: Box, space: Rectangle, kinds: list[tuple[int, Species]]) -> Iterator[Fault]:
    left, bottom, right, top = space
    place = _name_of(box, space)
    others: tuple[Key, ...] = (("box", "size"), ("piston", "position"))
    for i, s in kinds:
        key: Key = ("species", i, "region")
        x0, y0, x1, y1 = s.region or space
        if not (left <= x0 < x1 <= right and bottom <= y0 < y1 <= top):
            allowed = f"[x0, y0, x1, y1] with {left:.17g} <= x0 < x1 <= {right} and {bottom:.17g} <= y0 < y1 <= {top}"
            yield Fault((key, *others), f"region not in the {place}", str(list(s.region or space)), allowed)
        elif 2 * s.radius > min(x1 - x0, y1 - y0):
            keys = (("species", i, "radius"), key, *others)
            where = "region" if s.region else place
            yield Fault(keys, f"discs wider than the {where}", f"{s.radius}", f"<= {min(x1 - x0, y1 - y0) / 2}")


def _discs_outside(box: Box, space: Rectangle, discs: list[tuple[int, Disc]]) -> Iterator[Fault]:
    place = _name_of(box, space)
    others: tuple[Key, ...] = (("box", "size"), ("piston", "position"))
    widest = min(space[2] - space[0], space[3] - space[1])
    for i, d in discs:
        if 2 * d.radius > widest:
            yield Fault(
                (("disc", i, "radius"), *others), f"disc wider than the {place}", f"{d.radius}", f"<= {widest / 2}"
            )
            continue
        allowed = []
        inside = True
        for axis, name in enumerate("xy"):
            low, high = space[axis] + d.radius, space[axis + 2] - d.radius
            if box.joined[axis]:
                inside &= 0 <= d.position[axis] < box.size[axis]
                allowed.append(f"0 <= {name} < {box.size[axis]}")
            else:
                inside &= low <= d.position[axis] <= high
                allowed.append(f"{low} <= {name} <= {high}")
        if not inside:
            keys = (("disc", i, "position"), ("disc", i, "radius"), *others)
            yield Fault(keys, f"disc not in the {place}", str(list(d.position)), " and ".join(allowed))


def _name_of(box: Box, space: Rectangle) -> str:
    return "box" if space == (0.0, 0.0, *box.size) else "space before the piston"


def _crowding(
    whole: Rectangle, name: str, kinds: list[tuple[int, Species]], discs: list[tuple[int, Disc]]
) -> Iterator[Fault]:
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
            yield Fault(
                (("species", most, "count"), *others, ("box", "size"), ("piston", "position")),
                f"too many discs for the {place}",
                f"packing fraction {packing:.4g}",
                allowed,
            )


def _endless(scene: Scene) -> Iterator[Fault]:
    """Runs without a stop rule, or with one that is never met."""
    run = scene.run
    keys: tuple[Key, ...] = (("run",), ("run", "until"), ("run", "events"), ("run", "collisions_per_disc"))
    if run.until is not None or run.trials is not None:
        return
    if run.events is None and run.collisions_per_disc is None:
        yield Fault(keys, "no stop rule", "nothing", "at least one of until, events and collisions_per_disc")
        return
    alone = sum(s.count for s in scene.species) + len(scene.disc) == 1
    if (
        not any(s.temperature or s.speed or any(map(any, s.velocities or ())) for s in scene.species)
        and not any(any(d.velocity) for d in scene.disc)
        and not scene.gravity
        and not scene.piston
    ):
        yield Fault(keys, "nothing moves, so no event ends the run", "every speed 0", "a run with until")
    elif run.events is None and alone:
        yield Fault(keys, "a single disc never collides", "collisions_per_disc alone", "a run with until or events")
    elif alone and all(scene.box.joined) and not scene.wall:
        yield Fault(keys, "a single disc meets nothing in a periodic box", "events alone", "a run with until")

"""What no table can know alone: whether discs fit, move and come to an end. Nothing here makes an array."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from idealgas.scene.model import Box, Disc, Run, Species

Key = tuple[str | int, ...]
"""Path of a key in the document: ("species", 0, "radius")."""

CLOSE_PACKING = math.pi / math.sqrt(12)
"""Largest packing fraction of equal discs."""

RANDOM_PACKING = 0.65
"""Packing fraction up to which discs are placed at random; see `idealgas.placement`."""

RESOLUTION = 1e-9
"""Smallest radius in units of the box's longer side: below, a double cannot tell contact from gap."""


class Fault(NamedTuple):
    """Something wrong: the key to show first, then the others that have a part in it."""

    keys: tuple[Key, ...]
    wrong: str
    got: str
    allowed: str

    def __str__(self) -> str:
        return f"{dotted(self.keys[0])}: {self.wrong} (got {self.got}; allowed {self.allowed})"


def dotted(key: Key) -> str:
    """A key as it is written in messages and in --set."""
    return ".".join(map(str, key))


def faults(
    box: Box | None, species: Sequence[Species | None], disc: Sequence[Disc | None], run: Run | None
) -> Iterator[Fault]:
    """Faults of a scene; a part that is `None` has faults of its own and is left out."""
    kinds = [(i, s) for i, s in enumerate(species) if s is not None]
    discs = [(i, d) for i, d in enumerate(disc) if d is not None]
    if not species and not disc:
        yield Fault((("species",),), "no discs", "nothing", "at least one [[species]] or [[disc]]")
    yield from _species_faults(kinds)
    yield from _overlaps(discs)
    if box is not None:
        outside = list(_outside(box, kinds, discs))
        yield from outside
        if not outside and None not in species and None not in disc:
            yield from _crowding(box, kinds, discs)
    if run is not None:
        yield from _endless(run, species, disc)


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


def _overlaps(discs: list[tuple[int, Disc]]) -> Iterator[Fault]:
    """Explicit discs that overlap an earlier one, found by a sweep along x."""
    active: list[tuple[int, Disc]] = []
    for i, d in sorted(discs, key=lambda item: item[1].position[0] - item[1].radius):
        x, y = d.position
        active = [(k, a) for k, a in active if a.position[0] + a.radius > x - d.radius]
        for k, a in active:
            dx, dy, contact = a.position[0] - x, a.position[1] - y, a.radius + d.radius
            if dx * dx + dy * dy < contact * contact:
                low, high = sorted((i, k))
                keys: tuple[Key, ...] = tuple(("disc", n, key) for key in ("position", "radius") for n in (high, low))
                distance = f"a distance of {math.hypot(dx, dy)} between centres"
                yield Fault(keys, f"overlaps disc {low}", distance, f">= {contact}, the sum of the radii")
        active.append((i, d))


def _outside(box: Box, kinds: list[tuple[int, Species]], discs: list[tuple[int, Disc]]) -> Iterator[Fault]:
    """Discs and regions that are not in the box; discs too large for it, or too small to resolve."""
    size = ("box", "size")
    width, height = box.size
    for i, s in kinds:
        key: Key = ("species", i, "region")
        x0, y0, x1, y1 = s.region or (0.0, 0.0, width, height)
        if not (0 <= x0 < x1 <= width and 0 <= y0 < y1 <= height):
            allowed = f"[x0, y0, x1, y1] with 0 <= x0 < x1 <= {width} and 0 <= y0 < y1 <= {height}"
            yield Fault((key, size), "region not in the box", str(list(s.region or ())), allowed)
        elif 2 * s.radius > min(x1 - x0, y1 - y0):
            place = "region" if s.region else "box"
            allowed = f"<= {min(x1 - x0, y1 - y0) / 2}"
            yield Fault((("species", i, "radius"), key, size), f"discs wider than the {place}", f"{s.radius}", allowed)
    for i, d in discs:
        x, y = d.position
        r = d.radius
        if 2 * r > min(width, height):
            keys: tuple[Key, ...] = (("disc", i, "radius"), size)
            yield Fault(keys, "disc wider than the box", f"{r}", f"<= {min(width, height) / 2}")
        elif not (r <= x <= width - r and r <= y <= height - r):
            keys = (("disc", i, "position"), ("disc", i, "radius"), size)
            allowed = f"{r} <= x <= {width - r} and {r} <= y <= {height - r}"
            yield Fault(keys, "disc not in the box", str(list(d.position)), allowed)
    smallest = RESOLUTION * max(width, height)
    for table, items in (("species", kinds), ("disc", discs)):
        for i, item in items:
            if item.radius < smallest:
                keys = ((table, i, "radius"), size)
                yield Fault(keys, "too small for the box in double precision", f"{item.radius}", f">= {smallest}")


def _crowding(box: Box, kinds: list[tuple[int, Species]], discs: list[tuple[int, Disc]]) -> Iterator[Fault]:
    """More discs than a region, or the box, can hold."""
    whole = (0.0, 0.0, *box.size)
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
            place = "box" if region == whole else "region"
            allowed = f"<= {CLOSE_PACKING:.4f} on a lattice, <= {RANDOM_PACKING} at random"
            yield Fault(
                (("species", most, "count"), *others, ("box", "size")),
                f"too many discs for the {place}",
                f"packing fraction {packing:.4g}",
                allowed,
            )


def _endless(run: Run, species: Sequence[Species | None], disc: Sequence[Disc | None]) -> Iterator[Fault]:
    """Runs without a stop rule, or with one that is never met."""
    keys: tuple[Key, ...] = (("run",), ("run", "until"), ("run", "events"), ("run", "collisions_per_disc"))
    if run.until is not None:
        return
    if run.events is None and run.collisions_per_disc is None:
        yield Fault(keys, "no stop rule", "nothing", "at least one of until, events and collisions_per_disc")
        return
    if None in species or None in disc:
        return
    kinds = [s for s in species if s is not None]
    discs = [d for d in disc if d is not None]
    if not any(s.temperature or s.speed or any(map(any, s.velocities or ())) for s in kinds) and not any(
        any(d.velocity) for d in discs
    ):
        yield Fault(keys, "nothing moves, so no event ends the run", "every speed 0", "a run with until")
    elif run.events is None and sum(s.count for s in kinds) + len(discs) == 1:
        yield Fault(keys, "a single disc never collides", "collisions_per_disc alone", "a run with until or events")

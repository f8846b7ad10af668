"""Checks of the piston: its sides, position and motion, and walls in its range."""

from __future__ import annotations

import math
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.columns import SIDES, opposite
from idealgas.effects.periodic import PERIODIC
from idealgas.toml.issues import Issue, Key

if TYPE_CHECKING:
    from idealgas.effects.piston import Piston
    from idealgas.scene.document import Document

WAY = ", as one with a mass comes as near to the other side as the discs let it"

CLOSE_PACKING = math.pi / math.sqrt(12)
"""Largest packing fraction of equal discs."""


def issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Check the piston of a scene whose tables are valid."""
    piston = scene.piston
    if piston is None or invalid:
        return
    for name, allowed in ((piston.side, "reflecting"), (_facing(piston), "reflecting or thermal")):
        side = getattr(scene.box, name)
        if side == PERIODIC or (name == piston.side and side != "reflecting"):
            got = "periodic" if side == PERIODIC else "thermal"
            keys: tuple[Key, ...] = (("piston", "side"), ("box", name))
            yield Issue(keys, f"a piston that moves towards or from a {got} side", f"{name} {got}", f"{name} {allowed}")
    length = scene.box.size[piston.axis]
    start = piston.start(scene.box.size)
    if not 0 <= start <= length:
        keys = (("piston", "position"), ("box", "size"))
        yield Issue(keys, "piston not in the box", f"{start}", f"0 <= position <= {length}")
        return
    found = list(_motion_issues(piston))
    yield from found
    if not found:
        moves = _forced_issues(scene, piston) if piston.mass is None else _pressed_issues(scene, piston)
        found = list(moves)
        yield from found
    if not found:
        yield from _walls_in_the_way(scene, piston)


def _facing(piston: Piston) -> str:
    """Name of the side opposite the piston."""
    return SIDES[opposite(SIDES.index(piston.side))]


def _motion_issues(piston: Piston) -> Iterator[Issue]:
    given = [key for key in ("velocity", "mass", "pressure") if getattr(piston, key) is not None]
    if given not in (["velocity"], ["mass", "pressure"], ["velocity", "mass", "pressure"]):
        keys: tuple[Key, ...] = (("piston",), *(("piston", key) for key in given))
        what = "not one motion" if given else "no motion"
        yield Issue(
            keys,
            what,
            ", ".join(given) or "nothing",
            "velocity, mass and pressure, or all three",
        )


def _depth(scene: Document, piston: Piston, position: float) -> float:
    """Length of the gas at a piston position."""
    return position if piston.outward > 0 else scene.box.size[piston.axis] - position


def _least_depth(scene: Document, piston: Piston) -> float:
    """Smallest distance of a piston from the opposite side, with all discs in between."""
    return max(scene.covered_area / CLOSE_PACKING / scene.box.size[1 - piston.axis], 2 * scene.largest_radius)


def _forced_issues(scene: Document, piston: Piston) -> Iterator[Issue]:
    """Check pistons of given velocity, which nothing stops."""
    velocity = piston.velocity or 0.0
    if velocity == 0:
        return
    inward = velocity * piston.outward < 0
    keys: tuple[Key, ...] = (("piston", "velocity"), ("piston", "position"), ("run", "until"), ("box", "size"))
    if scene.run.until is None:
        what = "crushes the gas sooner or later" if inward else "leaves the box sooner or later"
        yield Issue(keys, what, "a run without until", "a run with until")
        return
    end = piston.start(scene.box.size) + velocity * scene.run.until
    if inward:
        depth, least = _depth(scene, piston, end), _least_depth(scene, piston)
        if depth < least:
            yield Issue(
                keys, "crushes the gas before the run ends", f"a depth of {depth:.6g} at the end", f">= {least:.6g}"
            )
    elif not 0 <= end <= scene.box.size[piston.axis]:
        allowed = f"0 <= position <= {scene.box.size[piston.axis]}"
        yield Issue(keys, "leaves the box before the run ends", f"a position of {end:.6g} at the end", allowed)


def _pressed_issues(scene: Document, piston: Piston) -> Iterator[Issue]:
    """Check that a piston with a mass is pressed on the gas."""
    acceleration = piston.acceleration(scene.box.size, scene.properties.acceleration)
    if acceleration * piston.outward >= 0:
        keys: tuple[Key, ...] = (("piston", "pressure"), ("piston", "mass"), ("gravity", "acceleration"))
        got = f"an acceleration of {acceleration}"
        yield Issue(keys, "nothing presses the piston on the gas", got, f"{'<' if piston.outward > 0 else '>'} 0")


def _walls_in_the_way(scene: Document, piston: Piston) -> Iterator[Issue]:
    """Check walls that the piston may reach."""
    position = piston.start(scene.box.size)
    if piston.mass is not None:
        depth = _least_depth(scene, piston)
    else:
        end = position + (piston.velocity or 0.0) * (scene.run.until or 0.0)
        depth = min(_depth(scene, piston, position), _depth(scene, piston, end))
    for i, wall in enumerate(scene.wall):
        reach = max(_depth(scene, piston, wall.start[piston.axis]), _depth(scene, piston, wall.end[piston.axis]))
        if reach > depth:
            keys: tuple[Key, ...] = (("wall", i), ("piston", "position"), ("piston", "velocity"), ("run", "until"))
            why = ", where it cannot come" if piston.mass is None else WAY
            allowed = f"no farther than {depth:.6g}{why}"
            yield Issue(keys, "wall in the way of the piston", f"{reach:.6g} from the {_facing(piston)} side", allowed)

"""Checks of the piston: its sides, position and motion, and walls in its range."""

from __future__ import annotations

import math
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

import numpy as np

from idealgas.columns import SIDES, opposite, sides_across
from idealgas.effects.periodic import PERIODIC
from idealgas.effects.schedule import description, steps_of
from idealgas.effects.vibration import reach
from idealgas.physics.arc_geometry import bounds
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
    if piston.inner and piston.side:
        got = f'side = "{piston.side}", inner = "{piston.inner}"'
        yield Issue((("piston", "inner"), ("piston", "side")), "at a side and inner", got, "one of them")
        return
    for name in sorted((SIDES[k] for k in sides_across(piston.axis)), key=lambda name: name != piston.wall):
        side, allowed = getattr(scene.box, name), "reflecting" if name == piston.wall else "reflecting or thermal"
        if side == PERIODIC or (name == piston.wall and side != "reflecting"):
            got = side if isinstance(side, str) else side.action.split(",")[0]
            keys: tuple[Key, ...] = (("piston", "inner" if piston.inner else "side"), ("box", name))
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
        found = list(_forced_issues(scene, piston) if piston.mass is None else _massive_issues(scene, piston))
        yield from found
    if not found:
        yield from _walls_in_the_way(scene, piston)


def _facing(piston: Piston) -> str:
    """Name of the side opposite the piston."""
    return SIDES[opposite(SIDES.index(piston.wall))]


def _motion_issues(piston: Piston) -> Iterator[Issue]:
    given = [key for key in ("velocity", "mass", "pressure") if getattr(piston, key) is not None]
    pressed = [] if piston.inner else ["pressure"]
    if given not in (["velocity"], ["mass", *pressed], ["velocity", "mass", *pressed]):
        keys: tuple[Key, ...] = (("piston",), *(("piston", key) for key in given))
        what = "not one motion" if given else "no motion"
        yield Issue(
            keys,
            what,
            ", ".join(given) or "nothing",
            "velocity, mass or both" if piston.inner else "velocity, mass and pressure, or all three",
        )
    elif piston.mass is not None and len(steps_of(piston.velocity)) > 1:
        key: Key = ("piston", "velocity")
        yield Issue((key,), "steps of a piston with a mass", description(piston.velocity), "its velocity at the start")


def _depth(scene: Document, piston: Piston, position: float) -> float:
    """Length of the gas at a piston position."""
    return position if piston.outward > 0 else scene.box.size[piston.axis] - position


def least_depth(scene: Document, axis: int) -> float:
    """Smallest distance of two sides, or of a piston and a side, with all discs in between."""
    heights = sum(reach(scene.box.sides[side]) for side in sides_across(axis))
    return heights + max(scene.covered_area / CLOSE_PACKING / scene.box.size[1 - axis], 2 * scene.largest_radius)


def _forced_issues(scene: Document, piston: Piston) -> Iterator[Issue]:
    """Check pistons of given velocity, which nothing stops; the gases of an inner one are not known yet."""
    velocities = [velocity for _, velocity in steps_of(piston.velocity) if velocity]
    if not velocities:
        return
    keys: tuple[Key, ...] = (("piston", "velocity"), ("piston", "position"), ("run", "until"), ("box", "size"))
    if scene.run.until is None:
        inward = velocities[-1] * piston.outward < 0 or piston.inner
        what = "crushes the gas sooner or later" if inward else "leaves the box sooner or later"
        yield Issue(keys, what, "a run without until", "a run with until")
        return
    places, length, least = track(scene, piston), scene.box.size[piston.axis], least_depth(scene, piston.axis)
    depth, when = min((_depth(scene, piston, place), when) for place, when in places)
    farthest = max(places, key=lambda place: abs(place[0] - length / 2))
    if depth < least and when and not piston.inner:
        got = f"a depth of {depth:.6g} {when}"
        yield Issue(keys, "crushes the gas before the run ends", got, f">= {least:.6g}")
    elif not 0 <= farthest[0] <= length:
        got = f"a position of {farthest[0]:.6g} {farthest[1]}"
        yield Issue(keys, "leaves the box before the run ends", got, f"0 <= position <= {length}")


def track(scene: Document, piston: Piston) -> list[tuple[float, str]]:
    """Positions of a piston of given velocity at the start, at changes of its velocity and at the end, and when."""
    until, place = scene.run.until or 0.0, piston.start(scene.box.size)
    steps = [(time, velocity) for time, velocity in steps_of(piston.velocity) if time < until]
    found = [(place, "")]
    for (time, velocity), later in zip(steps, [*(time for time, _ in steps[1:]), until], strict=True):
        place += velocity * (later - time)
        found.append((place, "at the end" if later == until else f"at t = {later:g}"))
    return found


def _massive_issues(scene: Document, piston: Piston) -> Iterator[Issue]:
    """Check that a piston with a mass is under one gravity and, unless it is inner, pressed on the gas."""
    if scene.properties.later_accelerations:
        both: tuple[Key, ...] = (("gravity", "acceleration"), ("piston", "mass"))
        yield Issue(both, "gravity in steps beside a piston with a mass", "steps", "one acceleration")
    if piston.inner:
        yield from _resting_issues(scene, piston)
        return
    times = [time for time, _ in steps_of(piston.pressure)]
    accelerations = (piston.acceleration(scene.box.size, scene.properties.acceleration, time) for time in times)
    acceleration = max(accelerations, key=lambda a: a * piston.outward)
    if acceleration * piston.outward >= 0:
        keys: tuple[Key, ...] = (("piston", "pressure"), ("piston", "mass"), ("gravity", "acceleration"))
        got = f"an acceleration of {acceleration}"
        yield Issue(keys, "nothing presses the piston on the gas", got, f"{'<' if piston.outward > 0 else '>'} 0")


def _resting_issues(scene: Document, piston: Piston) -> Iterator[Issue]:
    """Check that gravity does not press an inner piston at rest on a side of the box."""
    size, start = scene.box.size, piston.start(scene.box.size)
    pull = piston.acceleration(size, scene.properties.acceleration)
    if not piston.velocity and ((start == 0 and pull < 0) or (start == size[piston.axis] and pull > 0)):
        keys: tuple[Key, ...] = (("piston", "position"), ("gravity", "acceleration"))
        yield Issue(keys, "a piston at rest on a side", f"{start:g}", f"0 < position < {size[piston.axis]}")


def _walls_in_the_way(scene: Document, piston: Piston) -> Iterator[Issue]:
    """Check walls that the piston may reach."""
    if piston.inner:
        yield from _walls_of_inner(scene, piston)
        return
    if piston.mass is not None:
        depth = least_depth(scene, piston.axis)
    else:
        depth = min(_depth(scene, piston, place) for place, _ in track(scene, piston))
    for i, wall in enumerate(scene.segments):
        reach = wall.radius + max(
            _depth(scene, piston, end[piston.axis]) for end in bounds(wall.start, wall.end, wall.arc)
        )
        if reach > depth:
            place: Key = getattr(wall, "place", ("wall", i))
            keys: tuple[Key, ...] = (place, ("piston", "position"), ("piston", "velocity"), ("run", "until"))
            why = ", where it cannot come" if piston.mass is None else WAY
            allowed = f"no farther than {depth:.6g}{why}"
            yield Issue(keys, "wall in the way of the piston", f"{reach:.6g} from the {_facing(piston)} side", allowed)


def _walls_of_inner(scene: Document, piston: Piston) -> Iterator[Issue]:
    """Check walls that an inner piston may reach: one with a mass comes everywhere."""
    places = [0.0, scene.box.size[piston.axis]]
    if piston.mass is None:
        places = [place for place, _ in track(scene, piston)]
    for i, wall in enumerate(scene.segments):
        low, high = (end[piston.axis] for end in bounds(wall.start, wall.end, wall.arc))
        if low - wall.radius < max(places) and high + wall.radius > min(places):
            place: Key = getattr(wall, "place", ("wall", i))
            keys: tuple[Key, ...] = (place, ("piston", "position"), ("piston", "velocity"), ("run", "until"))
            allowed = f"none from {min(places):.6g} to {max(places):.6g} along {piston.inner}, where it may come"
            yield Issue(keys, "wall in the way of the piston", f"from {low:.6g} to {high:.6g}", allowed)


def crushed_issues(scene: Document, position: np.ndarray, radii: np.ndarray) -> Iterator[Issue]:
    """One issue for each gas to which an inner piston of given velocity leaves too little room.

    position: (N, 2), of all discs at the start, length. radii: (N,), length.
    """
    piston = scene.piston
    if piston is None or not piston.inner or piston.mass is not None:
        return
    outward, axis = piston.outward_from(position, scene.box.size), piston.axis
    for side, sign in zip(sides_across(axis), (1.0, -1.0), strict=True):
        radius = radii[outward == sign]
        if not len(radius):
            continue
        covered = math.pi * float(radius @ radius) / CLOSE_PACKING / scene.box.size[1 - axis]
        least = reach(scene.box.sides[side]) + max(covered, 2 * float(radius.max()))
        rooms = ((place if sign > 0 else scene.box.size[axis] - place, when) for place, when in track(scene, piston))
        room, when = min(rooms)
        if room < least:
            keys: tuple[Key, ...] = (("piston", "velocity"), ("piston", "position"), ("run", "until"), ("box", "size"))
            got = f"a distance of {room:.6g} from the {SIDES[side]} side {when or 'at the start'}"
            yield Issue(keys, "crushes the gas before the run ends", got, f">= {least:.6g}")

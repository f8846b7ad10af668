"""Checks of pistons: their sides, positions and motion, walls within their reach, and room for the gases."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from idealgas.columns import SIDES, opposite, sides_across
from idealgas.effects.periodic import PERIODIC
from idealgas.effects.schedule import description, steps_of
from idealgas.effects.vibration import reach
from idealgas.physics.arc_geometry import bounds
from idealgas.toml.issues import Issue, Key

if TYPE_CHECKING:
    from idealgas.effects.piston import PistonTable
    from idealgas.scene.document import Document

WAY = ", because a piston of finite mass may compress the gas until the discs are close-packed"

CLOSE_PACKING = math.pi / math.sqrt(12)
"""Largest packing fraction of equal discs."""


def piston_names(pistons: Sequence[PistonTable]) -> list[str]:
    """Return the names of the pistons in messages: 'the piston' if there is only one, else 'piston' and its name."""
    return ["the piston"] if len(pistons) == 1 else [f"piston {p.name or k}" for k, p in enumerate(pistons)]


def issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Check the pistons of a scene if all of its tables are valid."""
    if invalid or not scene.piston:
        return
    single = [issue for k in range(len(scene.piston)) for issue in _own_issues(scene, k)]
    errors = [*single, *_gravity_issues(scene)] or list(_row_issues(scene))
    yield from errors
    if not errors:
        yield from _holes_between(scene)
        for k in range(len(scene.piston)):
            yield from _walls_in_the_way(scene, k)


def closed_issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Check that the pistons leave room for the gas at the start."""
    left, bottom, right, top = scene.room
    if left < right and bottom < top:
        return
    if errors := list(issues(scene, invalid)):
        yield from errors
        return
    keys = tuple(("piston", k, "position") for k, piston in enumerate(scene.piston) if not piston.inner)
    got = " and ".join(f"{scene.piston[k].wall} at {scene.piston[k].start(scene.box.size):g}" for _, k, _ in keys)
    yield Issue((*keys, ("box", "size")), "no room for the gas", got, "a piston with the gas on its inner side")


def _own_issues(scene: Document, k: int) -> Iterator[Issue]:
    """Check a piston on its own."""
    piston = scene.piston[k]
    if piston.inner and piston.side:
        got = f'side = "{piston.side}", inner = "{piston.inner}"'
        yield Issue((("piston", k, "inner"), ("piston", k, "side")), "both at a side and inner", got, "only one")
        return
    for name in sorted((SIDES[side] for side in sides_across(piston.axis)), key=lambda name: name != piston.wall):
        side, allowed = getattr(scene.box, name), "reflecting" if name == piston.wall else "reflecting or thermal"
        if side == PERIODIC or (name == piston.wall and side != "reflecting"):
            got = side if isinstance(side, str) else side.action.split(",")[0]
            keys: tuple[Key, ...] = (_place_key(scene, k), ("box", name))
            yield Issue(keys, f"a piston moves towards or away from a {got} side", f"{name} {got}", f"{name} {allowed}")
    length = scene.box.size[piston.axis]
    start = piston.start(scene.box.size)
    if not 0 <= start <= length:
        keys = (("piston", k, "position"), ("box", "size"))
        yield Issue(keys, "piston not in the box", f"{start}", f"0 <= position <= {length}")
        return
    errors = list(_motion_issues(piston, k))
    yield from errors
    if not errors:
        yield from _forced_issues(scene, k) if piston.mass is None else _massive_issues(scene, k)


def _gravity_issues(scene: Document) -> Iterator[Issue]:
    """Check that gravity is constant if there are pistons of finite mass."""
    masses: list[Key] = [("piston", k, "mass") for k, piston in enumerate(scene.piston) if piston.mass is not None]
    if masses and scene.properties.later_accelerations:
        keys: tuple[Key, ...] = (("gravity", "acceleration"), *masses)
        yield Issue(keys, "gravity changes in steps, but a piston has a mass", "steps", "a constant acceleration")


def _place_key(scene: Document, k: int) -> Key:
    """Return the key that determines the side of a piston or the axis along which it moves."""
    return ("piston", k, "inner" if scene.piston[k].inner else "side")


def _row_issues(scene: Document) -> Iterator[Issue]:
    """Check that all pistons move along one axis and are in order along it, with at most one piston at each side."""
    for k in range(1, len(scene.piston)):
        before, piston = scene.piston[k - 1 : k + 1]
        starts = [table.start(scene.box.size) for table in (before, piston)]
        if piston.axis != before.axis:
            keys: tuple[Key, ...] = (_place_key(scene, k), _place_key(scene, k - 1))
            got = f"{'xy'[before.axis]} and {'xy'[piston.axis]}"
            yield Issue(keys, "pistons along two axes", got, "the same axis for all")
            return
        if piston.outward and piston.outward == before.outward:
            keys = (_place_key(scene, k), _place_key(scene, k - 1))
            yield Issue(keys, "two pistons at one side", piston.wall, "one at each side")
        elif piston.outward < before.outward or starts[0] >= starts[1]:
            keys = (("piston", k, "position"), ("piston", k), ("piston", k - 1, "position"))
            texts = (f"{table.wall} at {start:g}" for table, start in zip((before, piston), starts, strict=True))
            allowed = "in order of position, pistons at sides outermost"
            yield Issue(keys, "pistons not in order", ", then ".join(texts), allowed)


def _facing(piston: PistonTable) -> str:
    """Return the name of the side opposite the piston."""
    return SIDES[opposite(SIDES.index(piston.wall))]


def _motion_issues(piston: PistonTable, k: int) -> Iterator[Issue]:
    given = [key for key in ("velocity", "mass", "pressure") if getattr(piston, key) is not None]
    pressed = [] if piston.inner else ["pressure"]
    if given not in (["velocity"], ["mass", *pressed], ["velocity", "mass", *pressed]):
        keys: tuple[Key, ...] = (("piston", k), *(("piston", k, key) for key in given))
        what = "ill-defined motion" if given else "no motion"
        yield Issue(
            keys,
            what,
            ", ".join(given) or "nothing",
            "velocity, mass or both" if piston.inner else "velocity, mass and pressure, or all three",
        )
    elif piston.mass is not None and len(steps_of(piston.velocity)) > 1:
        key: Key = ("piston", k, "velocity")
        yield Issue((key,), "velocity steps of a piston with a mass", description(piston.velocity), "a single velocity")


def _depth(scene: Document, piston: PistonTable, position: float) -> float:
    """Return the length of the gas in front of a piston at a position, along the piston's axis."""
    return position if piston.outward > 0 else scene.box.size[piston.axis] - position


def least_depth(scene: Document, axis: int) -> float:
    """Return the smallest possible distance between two sides, or a piston and a side, with all discs in between."""
    heights = sum(reach(scene.box.sides[side]) for side in sides_across(axis))
    return heights + max(scene.covered_area / CLOSE_PACKING / scene.box.size[1 - axis], 2 * scene.largest_radius)


def _moving_keys(*numbers: int) -> tuple[Key, ...]:
    """Return the keys that determine how far pistons with prescribed velocities move."""
    pairs = ((("piston", k, "velocity"), ("piston", k, "position")) for k in numbers)
    return (*(key for keys in pairs for key in keys), ("run", "until"), ("box", "size"))


def _forced_issues(scene: Document, k: int) -> Iterator[Issue]:
    """Check a piston with prescribed velocity, which nothing stops; `chamber_issues` checks the gases beside it."""
    piston, keys = scene.piston[k], _moving_keys(k)
    velocities = [velocity for _, velocity in piston.velocity_steps if velocity]
    if not velocities:
        return
    if scene.run.until is None:
        inward = velocities[-1] * piston.outward < 0 or piston.inner
        what = "eventually crushes the gas" if inward else "eventually leaves the box"
        yield Issue(keys, what, "a run without until", "a run with until")
        return
    places, length, least = track(scene, piston), scene.box.size[piston.axis], least_depth(scene, piston.axis)
    depth, time = min((_depth(scene, piston, place), time) for time, place in places)
    farthest = max(places, key=lambda place: abs(place[1] - length / 2))
    if depth < least and time and not piston.inner and len(scene.piston) == 1:
        got = f"a depth of {depth:.6g} {_when(scene, time)}"
        yield Issue(keys, "crushes the gas before the run ends", got, f">= {least:.6g}")
    elif not 0 <= farthest[1] <= length:
        got = f"a position of {farthest[1]:.6g} {_when(scene, farthest[0])}"
        yield Issue(keys, "leaves the box before the run ends", got, f"0 <= position <= {length}")


def track(scene: Document, piston: PistonTable) -> list[tuple[float, float]]:
    """Return (time, position) of a piston with prescribed velocity: at the start, at velocity changes, at the end."""
    until, place = scene.run.until, piston.start(scene.box.size)
    if until is None:  # the piston is then at rest
        return [(0.0, place)]
    steps = [(time, velocity) for time, velocity in piston.velocity_steps if time < until]
    points = [(0.0, place)]
    for (time, velocity), later in zip(steps, [*(time for time, _ in steps[1:]), until], strict=True):
        place += velocity * (later - time)
        points.append((later, place))
    return points


def _when(scene: Document, time: float) -> str:
    """Describe a time on a piston's track in words."""
    return "at the start" if not time else "at the end" if time == scene.run.until else f"at t = {time:g}"


def _massive_issues(scene: Document, k: int) -> Iterator[Issue]:
    """Check that a piston of finite mass is pressed against the gas or, if it is inner, is not held against a side."""
    piston = scene.piston[k]
    if piston.inner:
        yield from _resting_issues(scene, k)
        return
    times = [time for time, _ in steps_of(piston.pressure)]
    accelerations = (piston.acceleration(scene.box.size, scene.properties.acceleration, time) for time in times)
    acceleration = max(accelerations, key=lambda a: a * piston.outward)
    if acceleration * piston.outward >= 0:
        keys: tuple[Key, ...] = (("piston", k, "pressure"), ("piston", k, "mass"), ("gravity", "acceleration"))
        got = f"an acceleration of {acceleration}"
        yield Issue(keys, "nothing presses the piston against the gas", got, f"{'<' if piston.outward > 0 else '>'} 0")


def _resting_issues(scene: Document, k: int) -> Iterator[Issue]:
    """Check that gravity does not press an inner piston that starts at rest against a side of the box."""
    piston, size = scene.piston[k], scene.box.size
    start, pull = piston.start(size), piston.acceleration(size, scene.properties.acceleration)
    if not piston.velocity and ((start == 0 and pull < 0) or (start == size[piston.axis] and pull > 0)):
        keys: tuple[Key, ...] = (("piston", k, "position"), ("gravity", "acceleration"))
        yield Issue(keys, "a piston pressed against a side", f"{start:g}", f"0 < position < {size[piston.axis]}")


def _walls_in_the_way(scene: Document, k: int) -> Iterator[Issue]:
    """Check for walls that the piston may run into."""
    piston = scene.piston[k]
    if piston.inner or len(scene.piston) > 1:
        yield from _walls_in_range(scene, k)
        return
    if piston.mass is not None:
        depth = least_depth(scene, piston.axis)
    else:
        depth = min(_depth(scene, piston, place) for _, place in track(scene, piston))
    for wall in scene.segments:
        reach = wall.radius + max(
            _depth(scene, piston, end[piston.axis]) for end in bounds(wall.start, wall.end, wall.arc)
        )
        if reach > depth:
            why = ", beyond the reach of the piston" if piston.mass is None else WAY
            allowed = f"no farther than {depth:.6g}{why}"
            got = f"{reach:.6g} from the {_facing(piston)} side"
            yield Issue(_in_the_way(wall, k), "wall in the way of the piston", got, allowed)


def _in_the_way(wall: Any, k: int) -> tuple[Key, ...]:
    """Return the keys involved if a wall is in the way of piston k."""
    return (wall.place, ("piston", k, "position"), ("piston", k, "velocity"), ("run", "until"))


def _range(scene: Document, k: int) -> tuple[float, float]:
    """Return the range of positions of a piston along its axis; for an outer piston, including the space behind it.

    A piston of finite mass may move as far as the sides or the nearest pistons with prescribed velocities.
    """
    piston, size = scene.piston[k], scene.box.size
    ways = [[place for _, place in track(scene, p)] if p.mass is None else [] for p in scene.piston]
    places = ways[k] or [
        max((max(way) for way in ways[:k] if way), default=0.0),
        min((min(way) for way in ways[k + 1 :] if way), default=size[piston.axis]),
    ]
    reached = [*places, *([] if piston.inner else [piston.stop(size)])]
    return min(reached), max(reached)


def _walls_in_range(scene: Document, k: int) -> Iterator[Issue]:
    """Check for walls within the range of a piston."""
    axis, (least, most) = scene.piston[k].axis, _range(scene, k)
    for wall in scene.segments:
        low, high = (end[axis] for end in bounds(wall.start, wall.end, wall.arc))
        if low - wall.radius < most and high + wall.radius > least:
            allowed = f"none from {least:.6g} to {most:.6g} along {'xy'[axis]}, within the reach of the piston"
            got = f"from {low:.6g} to {high:.6g}"
            yield Issue(_in_the_way(wall, k), f"wall in the way of {piston_names(scene.piston)[k]}", got, allowed)


def _holes_between(scene: Document) -> Iterator[Issue]:
    """Check that gas between two pistons cannot escape, because pistons with no disc between them could meet."""
    axis, starts = scene.piston[0].axis, [piston.start(scene.box.size) for piston in scene.piston]
    for wall in scene.pieces:
        low, high = (end[axis] for end in bounds(wall.start, wall.end, wall.arc))
        if wall.absorbing and starts[0] <= low and high <= starts[-1]:
            got, allowed = f"from {low:.6g} to {high:.6g}", f"none from {starts[0]:.6g} to {starts[-1]:.6g}"
            keys: tuple[Key, ...] = (wall.key("absorbing"), ("piston", 0), ("piston", len(starts) - 1))
            yield Issue(keys, "a hole between two pistons", got, f"{allowed} along {'xy'[axis]}")


def chamber_issues(scene: Document, position: np.ndarray, radii: np.ndarray) -> Iterator[Issue]:
    """Check that there is a disc between neighbouring pistons, and that every gas always has enough room.

    position: (N, 2), initial positions of all discs, length. radii: (N,), length.
    """
    if not scene.piston:
        return
    axis, size = scene.piston[0].axis, scene.box.size
    chamber = np.searchsorted([piston.start(size) for piston in scene.piston], position[:, axis])
    gases = [radii[chamber == c] for c in range(len(scene.piston) + 1)]
    names = piston_names(scene.piston)
    for k in range(1, len(scene.piston)):
        if not len(gases[k]):
            keys: tuple[Key, ...] = (("piston", k, "position"), ("piston", k - 1, "position"))
            what = f"no disc between {names[k - 1]} and {names[k]}"
            yield Issue(keys, what, "nothing", "at least one disc, as pistons do not collide")
    yield from _crushed_issues(scene, gases)


def _crushed_issues(scene: Document, gases: list[np.ndarray]) -> Iterator[Issue]:
    """Check that neighbouring obstacles, as defined in `_given_places`, leave enough room for the gases between them.

    gases: radii (n,) of the discs in each chamber: before, between and after the pistons, length.
    """
    last, axis, across = len(scene.piston), scene.piston[0].axis, scene.box.size[1 - scene.piston[0].axis]
    sides = dict(zip((-1, last), sides_across(axis), strict=True))
    for (a, low), (b, high) in pairwise(_given_places(scene)):
        least = sum(_least_room(radius, across) for radius in gases[a + 1 : b + 1] if len(radius))
        moving = [k for k in (b, a) if k not in sides]
        if not least or not moving:
            continue
        least += sum(reach(scene.box.sides[sides[k]]) for k in (a, b) if k in sides)
        times = sorted({time for time, _ in (*low, *high)})
        rooms = np.interp(times, *np.array(high).T) - np.interp(times, *np.array(low).T)
        room, time = min(zip(rooms.tolist(), times, strict=True))
        if room < least:
            neighbour = next(
                (f"the {SIDES[sides[k]]} side" for k in (a, b) if k in sides), piston_names(scene.piston)[max(a, 0)]
            )
            got = f"a distance of {room:.6g} from {neighbour} {_when(scene, time)}"
            yield Issue(_moving_keys(*moving), "crushes the gas before the run ends", got, f">= {least:.6g}")


def _given_places(scene: Document) -> list[tuple[int, list[tuple[float, float]]]]:
    """Return numbers and tracks of the obstacles that never yield: sides and pistons with prescribed velocities.

    The sides have the numbers -1 and K, where K is the number of pistons. Such a piston at a side replaces that side.
    """
    tables, length = scene.piston, scene.box.size[scene.piston[0].axis]
    tracks = [(k, track(scene, piston)) for k, piston in enumerate(tables) if piston.mass is None]
    replaced = {piston.outward for piston in tables if piston.mass is None}
    low = [] if -1.0 in replaced else [(-1, [(0.0, 0.0)])]
    return [*low, *tracks, *([] if 1.0 in replaced else [(len(tables), [(0.0, length)])])]


def _least_room(radius: np.ndarray, across: float) -> float:
    """Return the smallest length of a chamber of width `across` that holds discs with radii (n,), length."""
    return max(math.pi * float(radius @ radius) / CLOSE_PACKING / across, 2 * float(radius.max()))

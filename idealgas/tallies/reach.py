"""Area that the centres of discs can reach, the perimeter along which they touch walls, and slits between chambers."""

import math
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from idealgas.columns import FIRST_SEGMENT, Point
from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.physics.arc_geometry import bounds, nearest_points
from idealgas.scene.walls import NumberedWall, number_walls, walls_inside

NEAR = 1e-9
"""Distance from a wall, relative to the larger side of the box, at which its two sides are distinguished."""

FEWEST_PLACES, MOST_PLACES, ALL_PLACES = 8, 256, 2**14
"""Smallest and largest numbers of positions at which contact is tested along a wall, and their total for all walls."""

NONE = np.empty(0)

HALVINGS = 40
"""Number of bisections between two neighbouring positions if discs touch the wall at only one of them."""


Fit = Callable[[np.ndarray], np.ndarray]
"""Function that returns, for centres (M, 2), whether a disc at each of them overlaps no wall."""

Curve = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Function of fractions (M,) of the length of a wall that returns positions and normals there, broadcast to (M, 2)."""


class Reach(NamedTuple):
    """Area that the centres of discs of one radius can reach, and its perimeter.

    Attributes:
        area: area of all possible positions of the centre, length².
        perimeter: perimeter of this area, along which discs touch walls, length. A wall with gas on both sides counts
            twice, and its free end adds a half circle.
        holes: part of the perimeter along walls that absorb discs, length. It includes half of each arc around an end
            at which an absorbing wall meets a wall that reflects.
        shared: the other half of these arcs, length. On these arcs, the order of the walls and rounding decide which
            wall a disc hits.
    """

    area: float
    perimeter: float
    holes: float
    shared: float


def reach_of(log: Log, radius: float) -> Reach:
    """Return the area and perimeter that the centres of discs of a radius can reach among the walls of a log.

    Gates are treated as closed and pistons as being at rest.
    """
    faces = list(_faces(log, radius))
    area = log.discs.area - radius * math.fsum(half for _, (_, half) in faces)
    holes = math.fsum(hole * length for hole, (length, _) in faces)
    shared = math.fsum(length / 2 for hole, (length, _) in faces if 0 < hole < 1)
    return Reach(area, math.fsum(length for _, (length, _) in faces), holes, shared)


def _faces(log: Log, radius: float) -> Iterator[tuple[float, list[float]]]:
    """Yield, for each face or end of a wall, the fraction that is a hole and the lengths of the line of contact.

    The fraction is 1 for absorbing walls, 0 for other walls, and ½ for an end at which both kinds meet.

    The line of contact consists of the positions of centres of discs that touch the face. Its two lengths are those for
    discs of the given radius and of half this radius. As the length is linear in the radius, the second is the mean
    over all radii from 0 to the given one, which determines the area.
    """
    scene, size = log.scene, np.array(log.box)
    near = NEAR * float(size.max())
    walls = {k: wall for k, wall in enumerate(number_walls(scene)) if wall.action != "periodic"}
    number = min(max(ALL_PLACES // max(len(walls), 1), FEWEST_PLACES), MOST_PLACES)
    even = (np.arange(number) + 0.5) / number
    points = np.unique([end for wall in walls.values() for end in (wall.start, wall.end)], axis=0)
    fits = [(r, _fitting(log, list(walls.values()), r, near)) for r in (radius, radius / 2)] if walls else []

    def lengths(along: Curve, whole: float, bend: float, extra: np.ndarray = NONE) -> list[float]:
        """Return the lengths of the line of contact for both radii: whole + bend · r, if discs reach all of it."""
        reached, places = [], np.unique(np.clip(np.concatenate((even, extra)), 0.0, 1.0))
        for r, fit in fits:

            def touches(share: np.ndarray, r: float = r, fit: Fit = fit) -> np.ndarray:
                places, normal = along(share)
                gas = ~scene.solids.contain(places + near * normal)
                return gas & fit(places + max(r, 2 * near) * normal)

            reached.append(_share(touches, places) * (whole + bend * r))
        return reached

    ends: dict[Point, list[tuple[float, bool]]] = defaultdict(list)
    for k, wall in walls.items():
        hole = k >= FIRST_SEGMENT and scene.walls[k - FIRST_SEGMENT].absorbing
        start, chord = np.array(wall.start), np.subtract(wall.end, wall.start)
        if wall.radius:
            yield hole, lengths(_arc(start, wall.radius, 0.0, 2 * math.pi), 2 * math.pi * wall.radius, 2 * math.pi)
            continue
        beside = _shares_beside(wall, points, 2 * radius)
        if arc := wall.arc:
            centre, begin = start + np.array((arc.x, arc.y)), math.atan2(arc.my, arc.mx) - arc.angle / 2
            for side in (-1.0, 1.0):
                yield (
                    hole,
                    lengths(_arc(centre, arc.radius, begin, arc.angle, side), arc.length, side * arc.angle, beside),
                )
        else:
            for side in (-1.0, 1.0):
                yield hole, lengths(_straight(start, chord, side), float(np.hypot(*chord)), 0.0, beside)
        if k >= FIRST_SEGMENT and wall.start != wall.end:
            for end, direction in zip((wall.start, wall.end), _tangents(wall), strict=True):
                ends[end].append((direction, hole))
    for end, meeting in ends.items():
        begin, free = _free_angle([direction for direction, _ in meeting])
        holes = {hole for _, hole in meeting}
        if free > 0:
            yield sum(holes) / len(holes), lengths(_arc(np.array(end), 0.0, begin, free), 0.0, free)


def _shares_beside(wall: NumberedWall, points: np.ndarray, distance: float) -> np.ndarray:
    """Return where along a wall (fractions of its length) it is nearest to points (M, 2) within a distance of it."""
    nearest = nearest_points(points, wall.start, wall.end, wall.arc)
    from_start = nearest[np.hypot(*(points - nearest).T) <= distance] - wall.start
    if not wall.arc:
        chord = np.subtract(wall.end, wall.start)
        return from_start @ chord / (chord @ chord)
    (x, y), arc = from_start.T, wall.arc
    angle = np.arctan2(y - arc.y, x - arc.x) - math.atan2(arc.my, arc.mx)
    return np.remainder(angle + math.pi, 2 * math.pi) / arc.angle + 0.5 - math.pi / arc.angle


def _share(touches: Callable[[np.ndarray], np.ndarray], places: np.ndarray) -> float:
    """Return the fraction of a line on which a condition holds, given a function of positions from 0 to 1."""
    holds = touches(places)
    last = np.flatnonzero(holds[1:] != holds[:-1])
    low, high = places[last], places[last + 1]
    for _ in range(HALVINGS if len(last) else 0):
        middle = (low + high) / 2
        before = touches(middle) == holds[last]
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    edges = np.concatenate(([0.0], low, [1.0]))
    return float(np.diff(edges) @ np.append(holds[last], holds[-1]))


def _straight(start: np.ndarray, chord: np.ndarray, side: float) -> Curve:
    """Return the curve of one side of a straight wall."""
    normal = side * np.array([-chord[1], chord[0]]) / np.hypot(*chord)
    return lambda share: (start + share[:, None] * chord, normal)


def _arc(centre: np.ndarray, radius: float, begin: float, angle: float, side: float = 1.0) -> Curve:
    """Return the curve of an arc that starts at the angle `begin` and spans the angle `angle`, in radians.

    The normals point outwards for side 1 and inwards for side -1.
    """

    def along(share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        outwards = np.column_stack((np.cos(begin + angle * share), np.sin(begin + angle * share)))
        return centre + radius * outwards, side * outwards

    return along


def _tangents(wall: NumberedWall) -> tuple[float, float]:
    """Return the angles of the directions in which a wall leaves its start and its end, in radians."""
    (x, y), chord = np.subtract(wall.end, wall.start), 0.0
    if wall.arc:
        chord = wall.arc.turn * wall.arc.angle / 2
    forwards = math.atan2(y, x)
    return forwards - chord, forwards + math.pi + chord


def _free_angle(directions: list[float]) -> tuple[float, float]:
    """Return the start and the size of the range of angles, in radians, in which discs can touch an end.

    directions: angles at which walls leave the end.
    """
    sorted_directions = np.sort(np.mod(directions, 2 * math.pi))
    gaps = np.diff(sorted_directions, append=sorted_directions[0] + 2 * math.pi)
    widest = int(gaps.argmax())
    return float(sorted_directions[widest]) + math.pi / 2, max(float(gaps[widest]) - math.pi, 0.0)


def _fitting(log: Log, walls: list[NumberedWall], radius: float, near: float) -> Fit:
    """Return a function of centres (M, 2): whether discs of a radius there overlap no wall by more than `near`."""
    solid = [wall for wall in walls if not (wall.absences or wall.is_permeable)]
    low, high = (np.array(ends) for ends in zip(*(bounds(w.start, w.end, w.arc) for w in solid), strict=True))
    reach = radius + max(wall.radius for wall in solid)
    margin = np.where(log.periodic, -math.inf, radius - near)

    def fit(centres: np.ndarray) -> np.ndarray:
        fits = ((centres > margin) & (centres < log.box - margin)).all(axis=1)
        close = (low < centres.max(axis=0) + reach) & (high > centres.min(axis=0) - reach)
        for k in np.flatnonzero(close.all(axis=1)).tolist():
            wall = solid[k]
            away = centres - nearest_points(centres, wall.start, wall.end, wall.arc)
            fits &= np.hypot(*away.T) - wall.radius > radius - near
        return np.asarray(fits)

    return fit


# ── slit ──


class Slit(NamedTuple):
    """Slit between two chambers: a gate in a wall that divides the box.

    Attributes:
        opens: time at which the gate opens.
        closes: time at which the gate closes.
        across: axis normal to the wall (0 or 1).
        place: coordinate of the wall on this axis, length.
        width: width of the slit, length.
        others: names of the other walls in the chambers.
    """

    opens: float
    closes: float
    across: int
    place: float
    width: float
    others: tuple[str, ...]


def slit_of(log: Log) -> Slit:
    """Return the slit of a log; raise UserError unless it has events and one gate that forms a slit."""
    inside = walls_inside(log.scene)
    gates = [wall for wall in inside if wall.absences and wall.absences[0][0] > 0]
    if len(gates) != 1 or not log.has_events:
        raise UserError(f"{log.path}: effusion requires one gate and events")
    (gate,) = gates
    across = int(gate.start[0] != gate.end[0])
    in_line = _in_line(log, gate, across)
    if why := _obstacle(log, gate, in_line, across):
        raise UserError(f"{log.path}: effusion requires a slit in a wall, but {why}")
    low, high = _extent(gate, across)
    obstacles = tuple(wall.name for wall in inside if wall not in (gate, *in_line))
    opens, closes = gate.absences[0]
    return Slit(max(opens, log.start_time), closes, across, gate.start[across], high - low, obstacles)


def _obstacle(log: Log, gate: NumberedWall, in_line: Sequence[NumberedWall], across: int) -> str:
    """Return why a gate is not a slit in a wall, as part of a sentence; empty if it is a slit."""
    if gate.start[across] != gate.end[across] or not gate.is_straight:
        return "the gate is not along an axis"
    (low, high), radius, size = _extent(gate, across), float(log.discs.radius.min()), log.box[1 - across]
    if high - low + 2 * radius >= size:  # what remains of the wall is shorter than a disc
        return "the gate opens the box from side to side, so that the gas expands freely; use `idealgas evolution`"
    if log.periodic[across]:
        return "discs also pass through the periodic sides"
    beside = [_extent(wall, across) for wall in in_line]
    if any(min(end, high) - max(start, low) > radius for start, end in beside):
        return "a wall stands in the gate"
    reached, gap = 0.0, 0.0
    for start, end in [*sorted([*beside, (low, high)]), (size, math.inf)]:
        gap, reached = max(gap, start - reached), max(reached, end)
    return (
        f"the wall of the gate does not divide the box: there is a gap of {gap:.4g} beside the gate"
        if gap >= 2 * radius
        else ""
    )


def _in_line(log: Log, gate: NumberedWall, across: int) -> list[NumberedWall]:
    """Return the walls that are in line with an open gate, displaced by so little that no disc passes between them."""
    opens, closes = gate.absences[0][0], min(gate.absences[0][1], log.end_time)
    place, near = gate.start[across], log.discs.radius.min() / 2
    return [
        wall
        for wall in walls_inside(log.scene)
        if wall != gate
        and wall.arc is None
        and not wall.is_permeable
        and all(start >= closes or end <= opens for start, end in wall.absences)
        and max(abs(wall.start[across] - place), abs(wall.end[across] - place)) <= near
    ]


def _extent(wall: NumberedWall, across: int) -> tuple[float, float]:
    """Return the lowest and highest coordinate of a wall along the axis other than `across`, length."""
    ends = float(wall.start[1 - across]), float(wall.end[1 - across])
    return min(ends), max(ends)

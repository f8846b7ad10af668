"""Geometry of arcs: arcs through three points, nearest points, and the polygonal lines with which arcs are drawn."""

import math
from typing import Any, NamedTuple

import numpy as np

Point = tuple[float, float]

CIRCLE = -2.0
"""Value of `cosine` for a whole circle; it is less than the cosine of any angle."""

DRAWN = 64
"""Number of line segments with which a circle is drawn."""


class Arc(NamedTuple):
    """An arc of a circle, or a whole circle.

    Attributes:
        x, y: centre relative to the start, length.
        radius: length.
        mx, my: unit vector from the centre to the middle of the arc.
        cosine: cosine of the angle from the middle of the arc to an end; CIRCLE for a circle.
        turn: 1 if the arc runs counterclockwise from its start to its end, otherwise -1.
    """

    x: float
    y: float
    radius: float
    mx: float
    my: float
    cosine: float
    turn: float

    @property
    def angle(self) -> float:
        """Angle subtended by the arc, in radians."""
        return 2 * math.pi if self.cosine == CIRCLE else 2 * math.acos(max(min(self.cosine, 1.0), -1.0))

    @property
    def length(self) -> float:
        """Length of the arc."""
        return self.radius * self.angle


NO_ARC = Arc(*(0.0,) * 7)
"""Placeholder for the arc of a straight wall, for functions that require numbers."""


def arc_through(start: Point, via: Point, end: Point) -> Arc | None:
    """Return the arc from start through `via` to end, or None if the three points are on a line.

    If start and end coincide, return the circle that has the line from start to `via` as a diameter.
    """
    ax, ay, bx, by = via[0] - start[0], via[1] - start[1], end[0] - start[0], end[1] - start[1]
    if start == end:
        across = math.hypot(ax, ay)
        return Arc(ax / 2, ay / 2, across / 2, ax / across, ay / across, CIRCLE, 1.0) if across else None
    cross = ax * by - ay * bx
    if cross == 0.0:
        return None
    a, b, chord = ax * ax + ay * ay, bx * bx + by * by, math.hypot(bx, by)
    x, y = 0.5 * (by * a - ay * b) / cross, 0.5 * (ax * b - bx * a) / cross
    turn, radius = math.copysign(1.0, cross), math.hypot(x, y)
    mx, my = turn * by / chord, -turn * bx / chord
    return Arc(x, y, radius, mx, my, -(x * mx + y * my) / radius, turn)


def nearest_on_arc(points: np.ndarray, end: np.ndarray, arc: Any) -> np.ndarray:
    """Points (M, 2) on an arc, including its ends, that are nearest to the given points (M, 2), length.

    All coordinates are relative to the start of the arc.
    """
    centre, middle = np.array((arc.x, arc.y)), np.array((arc.mx, arc.my))
    away = points - centre
    distance = np.hypot(*away.T)[:, None]
    on_circle = centre + arc.radius * np.where(distance > 0, away / np.where(distance > 0, distance, 1.0), middle)
    at_start = (points**2).sum(axis=1) <= ((points - end) ** 2).sum(axis=1)
    at_end = np.where(at_start[:, None], 0.0, end)
    return np.where((away @ middle)[:, None] > distance * arc.cosine, on_circle, at_end)


def nearest_points(points: np.ndarray, start: Any, end: Any, arc: Arc | None) -> np.ndarray:
    """Points (M, 2) on the wall from start to end that are nearest to the given points (M, 2), length."""
    along = np.subtract(end, start)
    if arc is not None:
        return np.add(start, nearest_on_arc(points - start, along, arc))
    share = np.clip((points - start) @ along / (along @ along or 1.0), 0.0, 1.0)
    return np.add(start, share[:, None] * along)


def bounds(start: Any, end: Any, arc: Any) -> tuple[Point, Point]:
    """Lower left and upper right corners of the smallest rectangle around a wall from start to end, length."""
    points = [start, end]
    if arc is not None:
        extremes = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
        directions = [(x, y) for x, y in extremes if x * arc.mx + y * arc.my > arc.cosine]
        points += [(start[0] + arc.x + arc.radius * x, start[1] + arc.y + arc.radius * y) for x, y in directions]
    x, y = zip(*points, strict=True)
    return (min(x), min(y)), (max(x), max(y))


def drawn_points(start: Point, end: Point, arc: Arc | None) -> list[Point]:
    """Vertices of the polygonal line with which a wall from start to end is drawn, length."""
    if arc is None:
        return [start, end]
    steps = max(math.ceil(DRAWN * arc.angle / (2 * math.pi)), 2)
    first = math.atan2(-arc.y, -arc.x)
    angles = (first + arc.turn * arc.angle * k / steps for k in range(1, steps))
    x, y = start[0] + arc.x, start[1] + arc.y
    return [start, *((x + arc.radius * math.cos(a), y + arc.radius * math.sin(a)) for a in angles), end]

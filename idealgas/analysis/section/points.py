"""Points of a Poincaré section: hits of walls, or crossings of a line."""

import math
from collections.abc import Iterator
from itertools import product

import numpy as np

from idealgas.columns import FIRST_SEGMENT, axis_of
from idealgas.errors import UserError, unknown
from idealgas.log import Log
from idealgas.log.flights import Flights
from idealgas.physics.arc_geometry import bounds, nearest_on_arc
from idealgas.physics.motion import position_after, velocity_after
from idealgas.scene.walls import NumberedWall, number_walls
from idealgas.tallies.impacts import is_wall_hit

POINT = np.dtype("f8, u4, u4, u4, u2, f8, f8, i1")
POINT.names = ("time", "disc", "log", "trajectory", "wall", "position", "sine", "side")
"""A point: its time, the numbers of its disc, log, trajectory, and wall in the section, its position along the wall
(length), the sine of its angle, and 1 if the disc moves to the left of the wall's direction, otherwise -1."""


def chosen_walls(log: Log, names: str | None) -> dict[int, NumberedWall]:
    """Return the walls or polygonal lines with these names, or else all walls that reflect discs, by number."""
    absent = {k for k, wall in enumerate(log.scene.walls, FIRST_SEGMENT) if wall.absorbing}
    absent |= {k for k in range(FIRST_SEGMENT) if log.periodic[axis_of(k)]}
    walls = {k: wall for k, wall in enumerate(number_walls(log.scene)) if k not in absent}
    if names is None:
        return walls
    lines, chosen = {k: wall.name for k, wall in enumerate(log.scene.walls, FIRST_SEGMENT)}, dict[int, NumberedWall]()
    for name in (name.strip() for name in names.split(",")):
        if not (named := {k: wall for k, wall in walls.items() if name in (wall.name, lines.get(k))}):
            raise unknown("reflecting wall", name, [wall.name for wall in walls.values()])
        chosen |= named
    return chosen


def hits(log: Log, walls: dict[int, NumberedWall], first: float, last: float) -> Iterator[tuple[np.ndarray, int]]:
    """Yield hits of walls between two times as POINT, with velocities after the hit, and the number of rows read."""
    box, wraps = np.array(log.box), np.array(log.wrapped_axes)
    columns = ("time", "disc", "partner", "kind", "position", "velocity")
    for rows in log.chunks(columns, log.row_at(first, "right"), log.row_at(last, "right")):
        struck = np.where(is_wall_hit(rows.kind), -1 - rows.partner, -1)
        kept = np.flatnonzero(np.isin(struck, list(walls)))
        points = np.zeros(len(kept), POINT)
        points["time"], points["disc"] = rows.time[kept], rows.disc[kept]
        for k, (number, wall) in enumerate(walls.items()):
            here = np.flatnonzero(struck[kept] == number)
            centres, middle = rows.position[kept[here]], np.mean(bounds(wall.start, wall.end, wall.arc), axis=0)
            centres = centres - wraps * box * np.rint((centres - middle) / box)
            points["wall"][here], (points["position"][here], tangent) = k, place_on(wall, centres)
            points["sine"][here], points["side"][here] = direction(tangent, rows.velocity[kept[here]])
        yield points, len(rows.time)


def place_on(wall: NumberedWall, centres: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the positions (n,) along a wall, length, and its unit tangents (n, 2) where discs at (n, 2) touch it."""
    away, end = centres - wall.start, np.subtract(wall.end, wall.start)
    if wall.radius:
        radial, turn = away, 1.0
        position = wall.radius * (np.arctan2(away[:, 1], away[:, 0]) % (2 * math.pi))
    elif arc := wall.arc:
        radial, turn = nearest_on_arc(away, end, arc) - (arc.x, arc.y), arc.turn
        angle = np.arctan2(arc.mx * radial[:, 1] - arc.my * radial[:, 0], radial @ (arc.mx, arc.my))
        position = np.clip(arc.radius * (arc.angle / 2 + turn * angle), 0.0, arc.length)
    else:
        tangent = end / wall.length
        return np.clip(away @ tangent, 0.0, wall.length), np.broadcast_to(tangent, away.shape)
    return position, turn * np.column_stack((-radial[:, 1], radial[:, 0])) / np.hypot(*radial.T)[:, None]


def direction(tangent: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the sine (n,) and the side (n,) of a point, see POINT, from unit tangents and velocities, (n, 2)."""
    (tx, ty), (vx, vy) = tangent.T, velocity.T
    return (tx * vx + ty * vy) / np.maximum(np.hypot(vx, vy), 1e-300), np.where(tx * vy - ty * vx > 0, 1, -1)


def line_ends(text: str) -> np.ndarray:
    """Return the ends (2, 2) of a line, given as "x0,y0,x1,y1"; raise UserError if the text is not a line."""
    try:
        ends = np.array(text.split(","), float).reshape(2, 2)
    except ValueError:
        ends = np.zeros((2, 2))
    if not np.isfinite(ends).all() or (ends[0] == ends[1]).all():
        raise UserError(f"line: not a line (got {text}; allowed x0,y0,x1,y1 with two different ends)")
    return ends


def crossings(log: Log, ends: np.ndarray, first: float, last: float) -> Iterator[tuple[np.ndarray, int]]:
    """Yield crossings of a line between two times as POINT, in any order, and the number of flights read."""
    columns = ("disc", "start", "end", "velocity", "position", "end_position")
    for flights in log.flights([first, last], columns=columns):
        yield np.concatenate([*_crossings(log, flights, ends)]), len(flights.disc)


def _crossings(log: Log, flights: Flights, ends: np.ndarray) -> Iterator[np.ndarray]:
    """Yield the crossings of a line and of its periodic images by flights.

    The signed distance c of a disc from the line is a parabola in time. Each part of a flight, before and after its
    turning point, crosses the line if the sign of c differs between the ends of the part.
    """
    start, velocity, duration = np.asarray(flights.position), flights.velocity, flights.end - flights.start
    pull = np.broadcast_to(log.gravity_at(flights.start) if log.has_gravity else 0.0, velocity.shape)
    path = position_after(0.0, velocity, pull, duration[:, None])
    box, wraps = np.array(log.box), np.array(log.wrapped_axes)
    boxes = np.rint((start + path - flights.end_position) / box) * wraps
    tangent = (ends[1] - ends[0]) / math.dist(*ends)
    slope, bend = (vectors @ (-tangent[1], tangent[0]) for vectors in (velocity, pull))
    curve = np.where(bend != 0, bend, 1.0)
    turns = (slope * bend < 0) & (np.abs(slope) < np.abs(bend) * duration)
    low, high = boxes.min(axis=0, initial=0), boxes.max(axis=0, initial=0)
    for image in product(*(np.arange(a, b + 1) for a, b in zip(low, high, strict=True))):
        corner = ends[0] + box * image
        ahead = start - corner, flights.end_position + boxes * box - corner
        here, there = (vectors @ (-tangent[1], tangent[0]) for vectors in ahead)
        square = slope**2 - 2 * bend * here  # of the slope at a crossing
        middle = np.where(turns, -square / (2 * curve), there)
        for before, after in ((here, middle), (middle, there)):
            k = np.flatnonzero((before < 0) != (after < 0))
            final = np.where(after[k] < 0, -1.0, 1.0) * np.sqrt(np.maximum(square[k], 0.0))
            alike = slope[k] * final > 0  # either formula loses digits in the other case
            sums = np.where(alike, slope[k] + final, 1.0)
            delay = np.clip(np.where(alike, -2 * here[k] / sums, (final - slope[k]) / curve[k]), 0.0, duration[k])
            points = np.zeros(len(k), POINT)
            points["time"], points["disc"] = flights.start[k] + delay, flights.disc[k]
            place = position_after(start[k], velocity[k], pull[k], delay[:, None])
            points["position"], points["side"] = (place - corner) @ tangent, np.where(after[k] < 0, -1, 1)
            points["sine"], _ = direction(tangent[None], velocity_after(velocity[k], pull[k], delay[:, None]))
            yield points[(points["position"] >= 0) & (points["position"] <= math.dist(*ends))]

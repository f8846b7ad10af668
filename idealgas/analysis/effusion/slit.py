"""The slit between two chambers through which discs effuse: a gate that opens in a wall from side to side."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.scene.walls import NumberedWall, walls_inside


class Slit(NamedTuple):
    """Slit of a log.

    opens, closes: from when to when it is open, time. across: axis across it (0 or 1). place: its coordinate on this
    axis, length. width: length. others: names of the walls in the chambers beside the one with the slit.
    """

    opens: float
    closes: float
    across: int
    place: float
    width: float
    others: tuple[str, ...]


def slit_of(log: Log) -> Slit:
    """The slit of a log.

    Raises:
        UserError: unless there is one gate along an axis, in a wall from side to side, for discs of one species.
    """
    gates = [wall for wall in walls_inside(log.scene) if 0 < wall.absence[0] < math.inf]
    if len(gates) != 1 or len(log.discs.species_names) != 1 or not log.has_events:
        raise UserError(f"{log.path}: no effusion: it takes one gate, one species and the events")
    (gate,) = gates
    across = int(gate.start[0] != gate.end[0])
    if why := _why_not(log, gate, across):
        raise UserError(f"{log.path}: no effusion: {why}")
    low, high = _reach(gate, across)
    one_wall = (gate, *_in_line(log, gate, across))
    others = tuple(wall.name for wall in walls_inside(log.scene) if wall not in one_wall)
    opens, closes = gate.absence
    return Slit(max(opens, log.start_time), closes, across, gate.start[across], high - low, others)


def _why_not(log: Log, gate: NumberedWall, across: int) -> str:
    """Why a gate is no slit in a wall, as part of a sentence; empty if it is one."""
    if gate.start[across] != gate.end[across]:
        return "the gate is not along an axis"
    (low, high), radius, size = _reach(gate, across), float(log.discs.radius[0]), log.box[1 - across]
    if high - low + 2 * radius >= size:  # what remains of the wall is shorter than a disc
        return (
            "the gate opens the box from side to side, so that the gas expands freely; `idealgas evolution` follows it"
        )
    if log.periodic[across]:
        return "discs pass through the periodic sides, not by the gate alone"
    beside = [_reach(wall, across) for wall in _in_line(log, gate, across)]
    if any(min(end, high) - max(start, low) > radius for start, end in beside):
        return "a wall stands in the gate"
    if (gap := _widest_gap([*beside, (low, high)], size)) >= 2 * radius:
        return f"the gate is in no straight wall from side to side: beside it is a gap of {gap:.4g}"
    return ""


def _in_line(log: Log, gate: NumberedWall, across: int) -> list[NumberedWall]:
    """Walls in the line of a gate that are there for as long as it is open.

    Those that are off by less than half of a radius are in its line: no disc passes between.
    """
    opens, closes = gate.absence[0], min(gate.absence[1], log.end_time)
    place, near = gate.start[across], log.discs.radius[0] / 2
    return [
        wall
        for wall in walls_inside(log.scene)
        if wall != gate
        and (wall.absence[0] >= closes or wall.absence[1] <= opens)
        and max(abs(wall.start[across] - place), abs(wall.end[across] - place)) <= near
    ]


def _reach(wall: NumberedWall, across: int) -> tuple[float, float]:
    """From where to where a wall is along the other axis, length."""
    ends = float(wall.start[1 - across]), float(wall.end[1 - across])
    return min(ends), max(ends)


def _widest_gap(parts: Sequence[tuple[float, float]], size: float) -> float:
    """Widest gap that parts of a line leave between its ends, at 0 and at `size`, length."""
    reached, widest = 0.0, 0.0
    for low, high in [*sorted(parts), (size, math.inf)]:
        widest, reached = max(widest, low - reached), max(reached, high)
    return widest

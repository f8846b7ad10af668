"""Chambers into which walls from side to side divide a box, and whether they contain discs."""

from collections import defaultdict
from itertools import pairwise

import numpy as np

from idealgas.columns import SIDES, axis_of, sides_across
from idealgas.log import Log
from idealgas.scene import PistonTable, Scene
from idealgas.scene.walls import walls_inside


class Chambers:
    """Chambers of the box, divided by walls that are present from the start of a log to a given time.

    A row of walls from side to side along x or y divides the box if it has no gap and no disc can pass it. Walls do not
    count as dividing if the gas gets around them through a periodic boundary, or if the scene has a piston. Chambers
    that are empty at the start remain empty.

    Attributes:
        cuts: for x and for y, positions (K + 1,) of the dividing walls and of the sides, length.
        occupied: (Kx, Ky), whether the chambers contain discs.
    """

    def __init__(self, log: Log, until: float) -> None:
        """Find the chambers in a log while it is earlier than time `until`."""
        self.cuts = [_cuts(log, axis, until) for axis in range(2)]
        x, y = log.discs.position.T
        self.occupied = np.histogram2d(x, y, self.cuts)[0] > 0
        self._solid_area = log.discs.solid_area

    @property
    def area(self) -> float:
        """Area of the chambers with discs, length²; solids are subtracted only if all chambers contain discs."""
        x, y = map(np.diff, self.cuts)
        return float(x @ self.occupied @ y) - self._solid_area * bool(self.occupied.all())

    def along(self, side: int) -> np.ndarray:
        """Return whether each chamber along a side of the box contains discs."""
        return self.occupied.take(-(side % 2), axis=axis_of(side))

    def length(self, side: int) -> float:
        """Return the length of a side of the box along chambers with discs; its whole length if there are none."""
        lengths, there = np.diff(self.cuts[1 - axis_of(side)]), self.along(side)
        return float(lengths[there].sum() if there.any() else lengths.sum())

    def divided_gas(self, side: int, place: float) -> bool:
        """Return whether discs are, or may be, on both sides of a wall that meets a side of the box at a position."""
        cuts, there = self.cuts[1 - axis_of(side)], self.along(side)
        k = int(cuts.searchsorted(place))
        return not (0 < k < len(there) and cuts[k] == place) or bool(there[k - 1] and there[k])


def outward(log: Log, piston: PistonTable) -> float:
    """Return the direction from the gas to a piston along its axis, +1 or -1; 0 if there is gas on both sides."""
    directions = set(piston.outward_from(log.discs.position, log.box).tolist())
    return directions.pop() if len(directions) == 1 else 0.0


def piston_names(scene: Scene) -> list[str]:
    """Return unique names of the pistons for tables and figures: "piston" for one, otherwise with side or name."""
    walls = [piston.wall for piston in scene.piston]
    return ["piston"] if len(walls) == 1 else [wall if wall == "piston" else f"{wall} piston" for wall in walls]


def beside_pistons(log: Log) -> dict[str, np.ndarray]:
    """Return masks (N,) of the discs in each of the gases that inner pistons separate, by the name of the gas."""
    inner = [
        (piston, name) for piston, name in zip(log.scene.piston, piston_names(log.scene), strict=True) if piston.inner
    ]
    if not inner:
        return {}
    places = [piston.start(log.box) for piston, _ in inner]
    axis = inner[0][0].axis
    low, high = (SIDES[side] for side in sides_across(axis))
    names = [low, *(f"between {a} and {b}" for (_, a), (_, b) in pairwise(inner)), high]
    chamber = np.searchsorted(places, log.discs.position[:, axis])
    return {name: chamber == k for k, name in enumerate(names) if (chamber == k).any()}


def _cuts(log: Log, axis: int, until: float) -> np.ndarray:
    """Return the positions along an axis of the sides of the box and of the walls that divide it, length."""
    if log.scene.piston or log.periodic[axis]:
        return np.array([0.0, log.box[axis]])
    rows: dict[float, list[tuple[float, float]]] = defaultdict(list)
    for wall in walls_inside(log.scene):
        divides = wall.is_straight and wall.start[axis] == wall.end[axis] and not wall.is_permeable
        if divides and all(opens >= until for opens, _ in wall.absences):
            low, high = sorted((wall.start[1 - axis], wall.end[1 - axis]))
            rows[wall.start[axis]].append((low, high))
    cuts = {0.0, log.box[axis]}
    for place, parts in rows.items():
        reached = 0.0
        for low, high in sorted(parts):
            reached = max(reached, high) if low <= reached else reached
        if reached >= log.box[1 - axis]:
            cuts.add(place)
    return np.array(sorted(cuts))

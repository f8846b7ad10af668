"""Pressure on every wall and face in blocks of time: the momentum that discs give to it, per time and exposed length.

This is what a gauge in the wall would measure; neither equilibrium nor theory is required. Walls act on the centres of
the discs, one radius inside the box. The length is that of the wall itself or, for a side of the box, that of its part
along chambers with discs.
"""

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from idealgas.columns import FIRST_SEGMENT, SIDES, Kind, axis_of
from idealgas.errors import UserError
from idealgas.log import Flights, Log
from idealgas.scene.walls import NumberedWall, number_walls
from idealgas.state import Gas
from idealgas.tallies.chambers import Chambers, outward
from idealgas.tallies.contacts import WallNormals
from idealgas.tallies.impacts import is_wall_hit
from idealgas.tallies.samples import SampledImpacts, face_directions
from idealgas.tallies.stream import Tally, add_to


class WallImpulses:
    """Momentum given to each of W walls in each of B blocks of time, mass·length/time.

    For an arc, the normal at the position of the hit is used.

    Attributes:
        normals: (W, 2), unit normal of the first face of each wall; the normal of a side of the box points into the
            box.
        faces: (B, W, 2, 2), normal and tangential momentum given to the first and the second face by discs that touch
            the body of the wall. The tangential direction is the normal of the first face turned by -90°; for a
            segment it points from start to end.
        given: (B, W, 2), momentum along x and y, including that from discs that touch the ends of the wall.
        hits: (B, W), numbers of hits.
    """

    columns: tuple[str, ...] = ("disc", "block", "kind", "partner", "end_velocity", "new_velocity")
    cut = False

    def __init__(self, log: Log) -> None:
        """Set up the walls of a log."""
        self._geometry = WallNormals(log)
        self.normals = self._geometry.first
        if self._geometry.has_arcs:
            self.columns = (*self.columns, "end_position")

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        shape = (len(edges) - 1, len(self.normals))
        self.faces, self.given = np.zeros((*shape, 2, 2)), np.zeros((*shape, 2))
        self.hits = np.zeros(shape, np.int64)
        self._mass = gas.mass

    def add(self, flights: Flights) -> None:
        """Add the hits at the ends of a batch of flights."""
        wall_hits = np.flatnonzero(is_wall_hit(flights.kind))
        wall = -1 - flights.partner[wall_hits]
        place = flights.block[wall_hits] * len(self.normals) + wall
        given = self._mass[flights.disc[wall_hits], None] * (
            flights.end_velocity[wall_hits] - flights.new_velocity[wall_hits]
        )
        add_to(self.hits, place)
        for axis in range(2):
            add_to(self.given, place * 2 + axis, given[:, axis])
        body = np.flatnonzero(~np.isin(flights.kind[wall_hits], (Kind.WALL_END, Kind.FIXED_DISC)))
        (px, py), (nx, ny) = given[body].T, self._geometry.at(flights, wall_hits[body])[0].T
        across = px * nx + py * ny
        face = (across > 0.0).astype(np.intp)  # a disc on the side to which the normal points pushes against the normal
        add_to(self.faces, (place[body] * 2 + face) * 2, np.abs(across))
        add_to(self.faces, (place[body] * 2 + face) * 2 + 1, px * ny - py * nx)

    def finish(self) -> None:
        """Do nothing: the sums are complete."""


class SampledWalls:
    """Momentum given to W walls in B blocks of time, from sums in samples.

    The attributes are those of `WallImpulses`, except that the momentum given to the ends of a segment is attributed to
    its faces.
    """

    def __init__(self, log: Log, impacts: SampledImpacts) -> None:
        """Set the sums from those of a log in blocks of time."""
        into, along = face_directions(log)
        sides = np.arange(FIRST_SEGMENT)
        first = np.concatenate((sides, np.arange(FIRST_SEGMENT, len(into), 2)))
        self.normals = -into[first]
        turned = np.column_stack((self.normals[:, 1], -self.normals[:, 0]))
        way = np.sign((along[first] * turned).sum(axis=1))
        self.faces = np.zeros((len(impacts.edges) - 1, len(first), 2, 2))
        for c, given in enumerate((impacts.push, impacts.drag)):
            self.faces[:, :, 0, c] = given[:, first]
            self.faces[:, FIRST_SEGMENT:, 1, c] = given[:, FIRST_SEGMENT + 1 :: 2]
        self.faces[..., 1] *= way[:, None]
        self.given, self.hits = impacts.impulse, impacts.hits


@dataclass(frozen=True)
class Face:
    """One face of a wall that discs can hit, with the momentum given to it in each of B blocks of time.

    Attributes:
        name: name of the wall; for a wall segment, followed by the direction in which the face looks.
        wall: number of the wall.
        push: (B,), normal momentum given to the face, mass·length/time.
        along: (B,), tangential momentum given to the face, mass·length/time.
        exposed: (B,), length of the face times the time for which the wall was present, length·time.
        hits: number of hits of the wall.
    """

    name: str
    wall: int
    push: np.ndarray
    along: np.ndarray
    exposed: np.ndarray
    hits: int


def wall_name(wall: int, name: str) -> str:
    """Return the name of a wall in tables, in which, for example, the left side of the box is called "left wall"."""
    return f"{name} wall" if wall < FIRST_SEGMENT else name


class WallGauge:
    """Pressure on all walls of a log: the tallies that `stream` has to fill, and their results.

    Attributes:
        impulses: momentum given to the walls.
        moving: positions of the pistons as functions of time.
    """

    impulses: WallImpulses | SampledWalls

    def __init__(self, log: Log, sampled: SampledWalls | None = None) -> None:
        """Set up the walls of a log; sampled: the momentum given to the walls, if the log has no events."""
        self._log = log
        self.impulses = sampled or WallImpulses(log)
        self.moving = tuple(MovingWall(log, k) for k in range(len(log.scene.piston)))

    @property
    def tallies(self) -> list[Tally]:
        """Tallies that have to be filled from the events of the log."""
        impulses: list[Tally] = [self.impulses] if isinstance(self.impulses, WallImpulses) else []
        return [*impulses, *self.moving]

    @property
    def bounded(self) -> bool:
        """Whether any piston has gas on one side only."""
        return any(piston.outward for piston in self.moving)

    def _depth(self) -> np.ndarray:
        """Return the mean length of the gas along the axis of the pistons that bound it, in each block, (B,)."""
        low: Any = 0.0
        high: Any = self._log.box[self.moving[0].axis]
        for piston in self.moving:
            low = piston.place if piston.outward < 0 else low
        for piston in self.moving[::-1]:
            high = piston.place if piston.outward > 0 else high
        return np.asarray(high - low)

    def area(self, edges: np.ndarray) -> np.ndarray:
        """Return the area of the gas in each block of time, (B,), length².

        It is the area of the chambers with discs or, if a piston bounds the gas, the area on the gas side of pistons.
        """
        if not self.bounded:
            return np.full(len(edges) - 1, Chambers(self._log, float(edges[-1])).area)
        return self._depth() * self.moving[0].across

    def faces(self, edges: np.ndarray) -> list[Face]:
        """Return the faces of sides that are not periodic and of wall segments.

        edges: (B + 1,), boundaries of the blocks, time.
        """
        exposed_faces = []
        solids = any(self._log.scene.solids.walls.values())
        for k, wall in enumerate(number_walls(self._log.scene)):
            if wall.radius or (k < FIRST_SEGMENT and self._log.periodic[axis_of(k)]):
                continue
            exposed = self._exposed(k, wall, edges)
            if not exposed.any():
                continue
            names = [wall_name(k, wall.name)]
            if k >= FIRST_SEGMENT:
                names = [f"{wall.name}, {name}" for name in self._looks(k, wall)]
            for face, name in enumerate(names):
                push, along = self.impulses.faces[:, k, face].T
                if solids and not push.any():  # the face is inside a solid
                    continue
                exposed_faces.append(Face(name, k, push, along, exposed, int(self.impulses.hits[:, k].sum())))
        return exposed_faces

    def _looks(self, k: int, wall: NumberedWall) -> tuple[str, str]:
        """Return the directions in which the two faces of wall k look."""
        if wall.arc:
            return ("inside", "outside") if wall.arc.turn > 0 else ("outside", "inside")
        x, y = self.impulses.normals[k]
        names = ("right", "left") if abs(x) >= abs(y) else ("up", "down")
        return names if (x if abs(x) >= abs(y) else y) > 0 else (names[1], names[0])

    def _exposed(self, k: int, wall: NumberedWall, edges: np.ndarray) -> np.ndarray:
        """Return the length of wall k times the time for which it is present, in each block, (B,).

        For a side of the box, only the part along the gas counts.
        """
        width = np.diff(edges)
        if k < len(SIDES) and self.bounded and axis_of(k) != self.moving[0].axis:
            return self._depth() * width
        absent = np.zeros(len(width))
        for opens, closes in wall.absences:
            absent += np.clip(np.minimum(edges[1:], closes) - np.maximum(edges[:-1], opens), 0.0, None)
        length = wall.length
        if k < len(SIDES) and not self.bounded:
            length = Chambers(self._log, float(edges[-1])).length(k)
        return length * (width - absent)


class MovingWall:
    """Position of a piston in time, as a tally over the flights of a log.

    The position of the piston is known at the times of its samples and of every hit by a disc; between these times the
    piston moves along a parabola. A bounce from the end stop between two such times is not resolved.

    Attributes:
        wall: number of the piston among the walls.
        axis: axis along which the piston moves, 0 for x, 1 for y.
        across: length of the piston, length.
        outward: direction from the gas to the piston, +1 or -1; 0 if there is gas on both sides.
        place: (B,), mean coordinate of the piston in each block of time, length.
    """

    columns = ("disc", "end", "kind", "partner", "end_position")
    cut = False

    def __init__(self, log: Log, k: int) -> None:
        """Set up piston k of the scene of a log."""
        table = log.scene.piston[k]
        self.wall, self.axis = [wall.name for wall in log.walls].index(table.wall), table.axis
        self.across = log.box[1 - table.axis]
        self.outward, self._to_piston = outward(log, table), table.outward_from(log.discs.position, log.box)
        self._outward, self._stop = table.outward, table.stop(log.box)
        self._pull = partial(table.acceleration, log.box, log.scene.properties.acceleration)
        self._mass = None if table.inner else table.mass
        time, places = log.observables["piston_position"]
        if not len(time):
            raise UserError(f"{log.path}: has no sample of its piston")
        self._samples = time, places[:, k]
        self._speeds = log.observables["piston_velocity"][1][:, k]

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        self._edges, self._radius = edges, gas.radius
        self._sums = np.zeros(len(edges))  # integral of the position over time, from the first known time to each edge
        time, place = self._samples
        k = max(int(time.searchsorted(edges[0], "right")) - 1, 0)
        self._known = np.array([[time[k], place[k]]])
        self._total, self._done = 0.0, 0

    def add(self, flights: Flights) -> None:
        """Add a batch of flights."""
        assert flights.end_position is not None
        hits = (flights.kind == Kind.PISTON) & (flights.partner == -1 - self.wall)
        disc = flights.disc[hits]
        place = flights.end_position[hits, self.axis] + self._to_piston[disc] * self._radius[disc]
        self._follow(np.column_stack((flights.end[hits], place)), float(flights.end[-1]))

    def finish(self) -> None:
        """Continue to the last edge and convert the integrals to mean positions."""
        self._follow(np.empty((0, 2)), np.inf)
        self.place = np.diff(self._sums) / np.diff(self._edges)

    def _follow(self, hits: np.ndarray, until: float) -> None:
        """Integrate the position up to a time, or at infinity up to the last edge, from samples and hits (K, 2)."""
        time, place = self._samples
        in_step = (time > self._known[-1, 0]) & (time <= until)
        known = np.concatenate((self._known, np.column_stack((time[in_step], place[in_step])), hits))
        t, x = known[np.unique(known[:, 0], return_index=True)[1]].T
        step = np.diff(t)
        bends = self._pull(t[:-1]) * step**3 / 12
        total = self._total + np.append(0.0, np.cumsum(step * (x[1:] + x[:-1]) / 2 - bends))
        reached = len(self._edges) if until == np.inf else int(self._edges.searchsorted(t[-1], "right"))
        edges = self._edges[self._done : reached]
        k = np.clip(t.searchsorted(edges, "right") - 1, 0, max(len(t) - 2, 0))
        self._sums[self._done : reached] = total[k] + self._within(t, x, k, edges)
        self._known, self._total, self._done = np.array([[t[-1], x[-1]]]), total[-1], reached

    def _within(self, t: np.ndarray, x: np.ndarray, k: np.ndarray, edges: np.ndarray) -> np.ndarray:
        """Return the integrals of the position from the known times t[k] to edges, along the parabolas that follow."""
        since = edges - t[k]
        if len(t) == 1:
            return x[k] * since
        step = t[k + 1] - t[k]
        pull = self._pull(t[k])
        speed = (x[k + 1] - x[k]) / step - pull * step / 2
        return since * (x[k] + since * (speed / 2 + since * pull / 6))

    def balance(self, start: float, end: float) -> float | None:
        """Return the external pressure that holds the piston against the gas between two times, force per length.

        It is None for an inner or a driven piston, if the pressure changes between the two times, and if the piston
        came near its end stop, which would also hold it.
        """
        time, place = self._samples
        inside = (time >= start) & (time <= end)
        pulls = np.unique(self._pull(np.append(time[inside], start)))
        if not self._mass or not inside.any() or len(pulls) > 1:
            return None
        (pull,) = pulls
        reach = self._outward * place[inside] + self._speeds[inside] ** 2 / (2 * abs(pull))
        if (reach >= self._outward * self._stop).any():
            return None
        return -self._outward * pull * self._mass / self.across

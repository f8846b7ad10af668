"""The side of a box that moves, a piston: the room that it leaves to the gas in blocks of time, and what presses it."""

from typing import Any

import numpy as np

from idealgas.columns import SIDES, Kind
from idealgas.errors import UserError
from idealgas.log import Flights, Log
from idealgas.state import Gas


class MovingWall:
    """Depth of the room between a piston and the opposite side of the box, as a tally over the flights of a log.

    The piston position is known at its samples and at every hit of a disc, and lies on a parabola in between. A
    bounce at the piston's end stop between two such times is left out.

    wall: number of the side that the piston stands for. axis: along which it moves, 0 for x, 1 for y. across: its
    length. depth: (B,), mean depth of the room in each block of time, length.
    """

    columns = ("disc", "end", "kind", "end_position")
    cut = False

    def __init__(self, log: Log, table: Any) -> None:
        """Take a log and the table of the piston in its scene."""
        self.wall, self.axis = SIDES.index(table.side), table.axis
        self.across = log.box[1 - table.axis]
        self._outward, self._far = table.outward, log.box[table.axis] - table.stop(log.box)
        self._pull = table.acceleration(log.box, log.scene.properties.acceleration)
        self._mass, self._stop = table.mass, table.stop(log.box)
        self._samples = log.observables["piston_position"]
        if not len(self._samples[0]):
            raise UserError(f"{log.path}: has no sample of its piston")
        self._speeds = log.observables["piston_velocity"][1]

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start at time edges[0]; edges: (B + 1,), times between the blocks."""
        self._edges, self._radius = edges, gas.radius
        self._sums = np.zeros(len(edges))  # integral of the place from the first known time to each edge
        time, place = self._samples
        k = max(int(time.searchsorted(edges[0], "right")) - 1, 0)
        self._known = np.array([[time[k], place[k]]])
        self._total, self._done = 0.0, 0

    def add(self, flights: Flights) -> None:
        """Add the next flights."""
        assert flights.end_position is not None
        hits = flights.kind == Kind.PISTON
        place = flights.end_position[hits, self.axis] + self._outward * self._radius[flights.disc[hits]]
        self._follow(np.column_stack((flights.end[hits], place)), float(flights.end[-1]))

    def finish(self) -> None:
        """Go on to the last edge, and turn the integrals into mean depths."""
        self._follow(np.empty((0, 2)), np.inf)
        self.depth = np.abs(np.diff(self._sums) / np.diff(self._edges) - self._far)

    def _follow(self, hits: np.ndarray, until: float) -> None:
        """Integrate over the places (K, 2) at hits and those of the samples up to a time; at infinity to all edges."""
        time, place = self._samples
        some = (time > self._known[-1, 0]) & (time <= until)
        known = np.concatenate((self._known, np.column_stack((time[some], place[some])), hits))
        t, x = known[np.unique(known[:, 0], return_index=True)[1]].T
        step = np.diff(t)
        total = self._total + np.append(0.0, np.cumsum(step * (x[1:] + x[:-1]) / 2 - self._pull * step**3 / 12))
        reached = len(self._edges) if until == np.inf else int(self._edges.searchsorted(t[-1], "right"))
        edges = self._edges[self._done : reached]
        k = np.clip(t.searchsorted(edges, "right") - 1, 0, max(len(t) - 2, 0))
        self._sums[self._done : reached] = total[k] + self._within(t, x, k, edges)
        self._known, self._total, self._done = np.array([[t[-1], x[-1]]]), total[-1], reached

    def _within(self, t: np.ndarray, x: np.ndarray, k: np.ndarray, edges: np.ndarray) -> np.ndarray:
        """Integral of the place from the known times t[k] to edges, on the parabola to the next known time."""
        since = edges - t[k]
        if len(t) == 1:
            return x[k] * since
        step = t[k + 1] - t[k]
        speed = (x[k + 1] - x[k]) / step - self._pull * step / 2
        return since * (x[k] + since * (speed / 2 + since * self._pull / 6))

    def balance(self, start: float, end: float) -> float | None:
        """Pressure (force/length) that holds the piston against the gas between two times, beside its inertia.

        None for a piston of a given velocity, and if it came near its end stop, which holds it too.
        """
        time, place = self._samples
        inside = (time >= start) & (time <= end)
        if not self._mass or not inside.any():
            return None
        reach = self._outward * place[inside] + self._speeds[inside] ** 2 / (2 * abs(self._pull))
        if (reach >= self._outward * self._stop).any():
            return None
        return -self._outward * self._pull * self._mass / self.across


def moving_wall(log: Log) -> MovingWall | None:
    """Tally of the piston of a log; None without one."""
    return MovingWall(log, log.scene.piston) if log.scene.piston else None

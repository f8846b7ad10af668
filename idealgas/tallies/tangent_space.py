"""Small deviations of positions and velocities, propagated along the recorded motion by its exact tangent map."""

from collections.abc import Iterator

import numpy as np

from idealgas.columns import Kind
from idealgas.errors import NotApplicableError, UserError
from idealgas.jit import njit
from idealgas.log import Log
from idealgas.physics.tangent import collide_smooth, fly, reflect
from idealgas.tallies.stream import ReadProgress

COLUMNS = ("disc", "end", "kind", "partner", "end_velocity", "end_position")

MOST_NUMBERS = 2**26
"""Largest total number of components of all deviations, which take up half a gigabyte."""


class TangentVectors:
    """Deviations of a gas, propagated along its log.

    Attributes:
        values: (N, 4, K), K deviations δx, δy (length), δvx, δvy (length/time) of each disc at the time of its last
            event; `now` propagates those of all discs to a common time.
    """

    def __init__(self, log: Log, start: float, values: np.ndarray) -> None:
        """Start with deviations (N, 4, K) at time `start`."""
        self.values = np.ascontiguousarray(values)
        self._log, self._start = log, start
        self._since = np.full(len(values), start)

    def until(self, end: float, every: int, progress: ReadProgress | None = None) -> Iterator[tuple[float, int]]:
        """Follow the log to time `end`; after each `every` event rows, yield time and number of new collisions."""
        log, rows, waiting = self._log, 0, 0
        gas = (log.discs.mass, np.array(log.box), np.array(log.periodic), log.gravity)
        for flights in log.flights([self._start, end], columns=COLUMNS):
            columns, first = tuple(getattr(flights, name) for name in COLUMNS), 0
            while first < len(flights.disc):
                first, pairs, now = _advance(self.values, self._since, columns, first, every, gas)
                waiting += pairs
                if now >= 0:  # a negative time means that the batch has ended
                    yield now, waiting
                    waiting = 0
            rows += len(flights.disc)
            if progress is not None:
                progress(rows, max(rows, len(log)))

    def now(self, time: float) -> np.ndarray:
        """Return the deviations (N, 4, K) at a time after the last event."""
        _synchronise(self.values, self._since, time)
        return self.values


def sensitivity(
    log: Log, start: float | None = None, end: float | None = None, discs: list[int] | None = None
) -> np.ndarray:
    """Return the derivatives of the state of all discs with respect to the state of some discs at an earlier time.

    The derivatives are exact for the recorded motion. As the motion is chaotic, they become large within a few
    collisions per disc.

    Args:
        log: log with events, as for the analysis `lyapunov`.
        start: the earlier time; by default the start of the log.
        end: the later time; by default the end of the log.
        discs: ids of the discs whose initial states are varied; by default all discs.

    Returns:
        Array (N, 4, D, 4) with the derivative of each component (x, y, vx, vy) of each disc with respect to each
            component of each of the D varied discs.

    Raises:
        UserError: if the effects or the method have no known tangent map, if a disc does not exist, if a time lies
            outside the log, or if the array would have more than 2²⁶ elements.
    """
    must_have_tangent_map(log)
    number = len(log.discs)
    varied = list(range(number)) if discs is None else list(discs)
    if unknown := [disc for disc in varied if not 0 <= disc < number]:
        raise UserError(f"discs: no disc {unknown[0]} (allowed 0 to {number - 1})")
    if 16 * number * len(varied) > MOST_NUMBERS:
        raise UserError(f"discs: too many (got {len(varied)}; allowed <= {MOST_NUMBERS // (16 * number)})")
    first, last = log.start_time if start is None else start, log.end_time if end is None else end
    values = np.zeros((number, 4, len(varied), 4))
    values[varied, :, range(len(varied))] = np.eye(4)
    followed = TangentVectors(log, first, values.reshape(number, 4, -1))
    for _ in followed.until(last, len(log) + 1):
        pass
    return followed.now(last).reshape(values.shape)


def must_have_tangent_map(log: Log) -> None:
    """Raise NotApplicableError unless the tangent map is known for all events in a log."""
    gas = log.scene.properties
    plain = gas.collisions_conserve_energy and gas.elastic and gas.fixed_walls and gas.isolated and gas.empty
    if not plain or gas.spins or gas.varies or log.scene.run.method not in ("event_driven", "brute_force"):
        needs = "smooth elastic discs between plain sides, and the method event_driven or brute_force"
        raise NotApplicableError(f"{log.path}: the growth of deviations requires {needs}")


@njit
def _advance(deviations, since, columns, first, most, gas):
    """Propagate deviations through at most `most` event rows, starting with row `first`.

    The tuple `gas` consists of the masses, the box, whether x and y are periodic, and gravity. Return the next row, the
    number of collisions between discs, and the time of the last event, or -1 if there are no more rows.
    """
    masses, box, periodic, gravity = gas
    disc, end, kind, partner, velocity, position = columns
    row, pairs = first, 0
    while row < len(disc):
        if row - first >= most:
            return row, pairs, end[row - 1]
        i = disc[row]
        if kind[row] == Kind.DISC:
            j = disc[row + 1]
            for k in (i, j):
                fly(deviations, k, end[row] - since[k])
                since[k] = end[row]
            x, y = position[row, 0] - position[row + 1, 0], position[row, 1] - position[row + 1, 1]
            if periodic[0]:
                x -= box[0] * np.rint(x / box[0])
            if periodic[1]:
                y -= box[1] * np.rint(y / box[1])
            vx, vy = velocity[row, 0] - velocity[row + 1, 0], velocity[row, 1] - velocity[row + 1, 1]
            collide_smooth(deviations, i, j, masses, x, y, vx, vy)
            row += 2
            pairs += 1
        else:
            if kind[row] == Kind.WALL:
                fly(deviations, i, end[row] - since[i])
                since[i] = end[row]
                axis = 0 if partner[row] >= -2 else 1
                reflect(deviations, i, axis, velocity[row, axis], gravity[axis])
            row += 1
    return row, pairs, -1.0


@njit
def _synchronise(deviations, since, now):
    """Propagate the deviations of all discs to a common time."""
    for i in range(len(since)):
        fly(deviations, i, now - since[i])
        since[i] = now

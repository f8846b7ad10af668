"""Small deviations of positions and velocities, propagated along the recorded motion by its exact tangent map."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from idealgas.columns import Kind
from idealgas.errors import NotApplicableError, UserError
from idealgas.jit import njit
from idealgas.log import Flights, Log
from idealgas.log.flights import NO_EVENT
from idealgas.physics.tangent import collide, fly
from idealgas.scene.walls import number_walls
from idealgas.tallies.contacts import WallNormals
from idealgas.tallies.impacts import is_wall_hit
from idealgas.tallies.stream import ReadProgress

COLUMNS = ("disc", "start", "end", "kind", "partner", "end_velocity", "new_velocity", "end_position")

MOST_NUMBERS = 2**26
"""Largest total number of components of all deviations, which take up half a gigabyte."""

SAME = 1e-6
"""Largest relative difference between two velocities of a piston that is attributed to rounding."""


class Contacts(NamedTuple):
    """Collisions of disc i with disc, piston or wall j in order of time, as arguments of `tangent.collide`.

    Attributes:
        i: (n,), id of the disc.
        j: (n,), number of the other body.
        time: (n,), time.
        share_i, share_j: (n,), see `tangent.collide`.
        normal: (n, 2), unit normal.
        curvature: (n,), 1/length.
        velocity: (n, 2), velocity of i relative to j before the collision, length/time.
        pull: (n,), acceleration of i relative to j along the normal, length/time².
    """

    i: np.ndarray
    j: np.ndarray
    time: np.ndarray
    share_i: np.ndarray
    share_j: np.ndarray
    normal: np.ndarray
    curvature: np.ndarray
    velocity: np.ndarray
    pull: np.ndarray


class Bodies:
    """Bodies with which discs collide, and the geometry of their collisions: N discs, P pistons of finite mass, walls.

    Attributes:
        mass: (N + P + 1,), masses of discs and pistons; infinite for the last body, which stands for all other walls.
        last_contact: (N,), time of the last collision of each disc; -inf if it has not collided.
        systems: number of independent systems: N if the discs do not interact, and otherwise 1.
        free: (D,), indices of the D free components of a deviation of one system among its flattened components: all
            positions, followed by all velocities in the same order. A piston has only the two along its axis.
    """

    def __init__(self, log: Log) -> None:
        """Set up the bodies of a log."""
        self._log, self._normals = log, WallNormals(log)
        number = len(log.discs)
        walls = [wall.name for wall in number_walls(log.scene)]
        pistons = [(walls.index(piston.wall), piston) for piston in log.scene.piston]
        heavy = [(wall, piston) for wall, piston in pistons if piston.mass is not None]
        self.mass = np.array([*log.discs.mass, *(piston.mass for _, piston in heavy), math.inf])
        self._body_of_wall = np.full(len(walls), len(self.mass) - 1)
        self._body_of_wall[[wall for wall, _ in heavy]] = range(number, number + len(heavy))
        self.systems = 1 if log.scene.properties.interacting or heavy else number
        positions = [4 * i + axis for i in range(number // self.systems) for axis in (0, 1)]
        positions += [4 * (number + k) + piston.axis for k, (_, piston) in enumerate(heavy)]
        self.free = np.array([*positions, *(each + 2 for each in positions)])
        self._acceleration = np.zeros((len(walls), 2))
        for wall, piston in heavy:
            self._acceleration[wall, piston.axis] = piston.acceleration(log.box, log.scene.properties.acceleration)
        self._vibrating = [(k, side) for k, side in enumerate(log.scene.box.sides) if hasattr(side, "vibrating")]
        restitution = log.scene.restitution
        self._factors = (2.0, 2.0) if restitution is None else (1.0 + restitution.normal, 1.0 + restitution.wall)
        self.last_contact = np.full(number, -math.inf)
        self._last: dict[int, tuple[float, float]] = {}  # time of the last hit and velocity after it, by piston

    def contacts(self, flights: Flights) -> Contacts:
        """Return the collisions at the ends of flights.

        Raises:
            NotApplicableError: if the motion of a disc or a piston does not follow from the events.
        """
        assert flights.end_position is not None
        changed = (flights.kind == Kind.STEERED) & (flights.new_velocity != flights.end_velocity).any(axis=1)
        if changed.any():
            raise _refusal(self._log, f"a program changes velocities at t = {flights.end[changed][0]:g}")
        pairs = np.flatnonzero(flights.kind == Kind.DISC)[::2]
        hits = np.flatnonzero(is_wall_hit(flights.kind))
        duration, recent = self._log.scene.contact_duration, np.empty(len(flights.disc), bool)
        _find_recent(recent, self.last_contact, flights.disc, flights.end, flights.kind, duration)
        parts = zip(self._collisions(flights, pairs, recent), self._hits(flights, hits, recent), strict=True)
        order = np.concatenate((pairs, hits)).argsort()
        contacts = Contacts(*(np.concatenate(part)[order] for part in parts))
        if (grazing := (contacts.normal * contacts.velocity).sum(axis=1) == 0.0).any():
            k = int(grazing.argmax())
            raise _refusal(
                self._log, f"disc {contacts.i[k]} touches another body at t = {contacts.time[k]:g} at speed 0"
            )
        return contacts

    def _collisions(self, flights: Flights, first: np.ndarray, recent: np.ndarray) -> Contacts:
        """Return the collisions of two discs, whose flights are `first` and the next ones."""
        assert flights.end_position is not None
        i, j, mass = flights.disc[first], flights.disc[first + 1], self.mass
        apart, box = flights.end_position[first] - flights.end_position[first + 1], np.array(self._log.box)
        apart -= np.where(self._log.periodic, box, 0.0) * np.rint(apart / box)
        curvature = 1.0 / np.hypot(*apart.T)
        factor = np.where(recent[first] | recent[first + 1], 2.0, self._factors[0])
        share_i, share_j = (factor * mass[other] / (mass[i] + mass[j]) for other in (j, i))
        velocity, normal = flights.end_velocity[first] - flights.end_velocity[first + 1], apart * curvature[:, None]
        return Contacts(i, j, flights.end[first], share_i, share_j, normal, curvature, velocity, np.zeros(len(first)))

    def _hits(self, flights: Flights, hits: np.ndarray, recent: np.ndarray) -> Contacts:
        """Return the collisions with walls and pistons, whose velocities follow from the velocity changes of discs."""
        i, wall, time = flights.disc[hits], -1 - flights.partner[hits], flights.end[hits]
        normal, curvature = self._normals.at(flights, hits)
        j = self._body_of_wall[wall]
        ratio = self.mass[i] / self.mass[j]
        share_i = np.where(recent[hits], 2.0, self._factors[1]) / (1.0 + ratio)
        before, change = flights.end_velocity[hits], flights.new_velocity[hits] - flights.end_velocity[hits]
        approach = -(change * normal).sum(axis=1) / share_i
        velocity = before + (approach - (before * normal).sum(axis=1))[:, None] * normal
        acceleration = self._log.gravity_at(flights.start[hits]) - self._acceleration[wall]
        for k, side in self._vibrating:
            at = np.flatnonzero(wall == k)
            acceleration[at] -= side.motion_at(time[at])[2, :, None] * normal[at]
        pull = (acceleration * normal).sum(axis=1)
        contacts = Contacts(i, j, time, share_i, ratio * share_i, normal, curvature, velocity, pull)
        for k in np.unique(j[ratio > 0]):
            self._must_fly(contacts, before, int(k), np.flatnonzero(j == k))
        return contacts

    def _must_fly(self, contacts: Contacts, before: np.ndarray, body: int, hits: np.ndarray) -> None:
        """Raise NotApplicableError if a piston of finite mass did not move freely between its hits by discs."""
        wall = int(np.flatnonzero(self._body_of_wall == body)[0])
        axis = int(np.abs(self._normals.first[wall]).argmax())
        start = (before - contacts.velocity)[hits, axis]
        gained = contacts.share_j * (contacts.velocity * contacts.normal).sum(axis=1) * contacts.normal[:, axis]
        times, ends = contacts.time[hits], start + gained[hits]
        last = self._last.get(body, (times[0], start[0]))
        expected = np.append(last[1], ends[:-1])
        expected += self._acceleration[wall, axis] * np.diff(np.append(last[0], times))
        stray = np.abs(start - expected) > SAME * (np.abs(start) + np.abs(expected) + np.abs(before[hits, axis]))
        if stray.any():
            raise _refusal(self._log, f"a piston hits a side before t = {times[stray][0]:g}, which is not logged")
        self._last[body] = times[-1], ends[-1]


class TangentVectors:
    """Deviations of a gas, propagated along its log.

    Attributes:
        bodies: the bodies of the log.
        values: (N + P + 1, 4, K), K deviations δx, δy (length), δvx, δvy (length/time) of each body at the time of its
            last event; `now` propagates those of all bodies to a common time.
        collisions: (N + P + 1,), number of collisions of each body.
    """

    def __init__(self, log: Log, start: float, bodies: Bodies, values: np.ndarray) -> None:
        """Start with deviations (N + P + 1, 4, K) at time `start`."""
        self.bodies, self.values = bodies, np.ascontiguousarray(values)
        self.collisions = np.zeros(len(values), np.int64)
        self._log, self._start, self._since = log, start, np.full(len(values), start)
        duration = log.scene.contact_duration
        for rows in log.chunks(("disc", "time", "kind"), log.row_at(start - duration), log.row_at(start, "right")):
            _find_recent(np.empty(len(rows.disc), bool), bodies.last_contact, *rows, duration)

    def until(self, end: float, every: int, progress: ReadProgress | None = None) -> Iterator[float]:
        """Follow the log to time `end`; yield the time after each batch of `every` collisions of a disc, and `end`."""
        log, rows, missing = self._log, 0, every
        for flights in log.flights([self._start, end], columns=COLUMNS):
            contacts, k = self.bodies.contacts(flights), 0
            while k < len(contacts.i):
                k, missing = _advance(self.values, self._since, self.collisions, contacts, k, missing, len(log.discs))
                if missing <= 0:
                    missing = every
                    yield contacts.time[k - 1]
            rows += len(flights.disc)
            if progress is not None:
                progress(rows, max(rows, len(log)))
        self._start = end
        yield end

    def now(self, time: float) -> np.ndarray:
        """Return the deviations (N + P + 1, 4, K) at a time after the last event."""
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
    bodies = Bodies(log)
    values = np.zeros((len(bodies.mass), 4, len(varied), 4))
    values[varied, :, range(len(varied))] = np.eye(4)
    followed = TangentVectors(log, first, bodies, values.reshape(len(values), 4, -1))
    for _ in followed.until(last, len(log) + 1):
        pass
    return followed.now(last)[:number].reshape(number, 4, len(varied), 4)


def must_have_tangent_map(log: Log) -> None:
    """Raise NotApplicableError unless the tangent map is known for all events that a scene can have."""
    scene, gas = log.scene, log.scene.properties
    closing = any(closes < math.inf for wall in number_walls(scene) for _, closes in wall.absences)
    reasons = {
        "the method does not follow the exact motion": scene.run.method not in ("event_driven", "brute_force"),
        "discs spin": gas.spins,
        "discs receive random velocities from walls or a heat bath": not gas.isolated,
        "restitution is not constant": gas.collisions_give_energy or not gas.constant_restitution,
        "sides are sheared": gas.shear > 0,
        "discs leave the gas": log.escapes,
        "a gate may close on a disc": closing,
        "the pressure on a piston changes": any(p.mass is not None and p.times for p in scene.piston),
    }
    if reason := next((reason for reason, applies in reasons.items() if applies), ""):
        raise _refusal(log, reason)


def _refusal(log: Log, reason: str) -> NotApplicableError:
    return NotApplicableError(f"{log.path}: the tangent map is not available, because {reason}")


@njit
def _find_recent(recent, last, discs, times, kinds, duration):
    """Find out which events follow less than `duration` after a collision of the disc; update the times in `last`."""
    for k in range(len(discs)):
        recent[k] = times[k] - last[discs[k]] < duration
        if kinds[k] != Kind.STEERED and kinds[k] != NO_EVENT:
            last[discs[k]] = times[k]


@njit
def _advance(deviations, since, collisions, contacts, k, missing, number):
    """Propagate deviations through collisions, starting with collision k, until discs have collided `missing` times.

    A collision of two of the `number` discs counts for both. Return the index of the next collision, and how many
    collisions of a disc are still missing.
    """
    while k < len(contacts.i) and missing > 0:
        i, j = np.int64(contacts.i[k]), np.int64(contacts.j[k])
        for body in (i, j):
            fly(deviations, body, contacts.time[k] - since[body])
            since[body] = contacts.time[k]
            collisions[body] += 1
            missing -= body < number
        shares, normal, velocity = (contacts.share_i[k], contacts.share_j[k]), contacts.normal[k], contacts.velocity[k]
        collide(deviations, i, j, shares[0], shares[1], normal, contacts.curvature[k], velocity, contacts.pull[k])
        k += 1
    return k, missing


@njit
def _synchronise(deviations, since, now):
    """Propagate the deviations of all bodies to a common time."""
    for i in range(len(since)):
        fly(deviations, i, now - since[i])
        since[i] = now

"""Paths of discs as they follow from the rows of a log alone, and that they keep clear of discs, walls and sides."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from helpers.random_walls import crossings, distances
from idealgas.effects.bundle import Effects
from idealgas.physics.arc_geometry import nearest_points
from idealgas.physics.permeable import FROM_LEFT, FROM_RIGHT, SOLID
from idealgas.physics.piston import piston_motion
from idealgas.run.energy import energy_of
from idealgas.scene import Scene
from idealgas.state import Gas

U = 2.0**-53
FEW = 16.0
SAMPLES = 33  # of a parabola
MOST_IMAGES = 400  # of walls along a flight


@dataclass
class MaxErrors:
    """The largest errors seen: contact and place in units of the resolution, energy relative. events: looked at."""

    contact: float = 0.0
    place: float = 0.0
    energy: float = 0.0
    events: int = 0


class Paths:
    """Paths of the discs of one run. Every method raises AssertionError where something does not hold."""

    def __init__(self, scene: Scene, gas: Gas, effects: Effects, max_errors: MaxErrors) -> None:
        n = len(gas)
        self.gas, self.max_errors = gas, max_errors
        self.pull = np.array(scene.properties.acceleration)
        self.size, self.periodic = np.array(gas.box), np.array(scene.box.periodic)
        self.walls = np.array([(w.start, w.end) for w in scene.pieces]).reshape(-1, 2, 2)
        along = self.walls[:, 1] - self.walls[:, 0]
        along = along / np.where(along.any(axis=1), np.hypot(*along.T), 1.0)[:, None]
        self.left = np.column_stack((-along[:, 1], along[:, 0]))
        passage = np.zeros((len(scene.walls), len(gas.species_names)), int)
        if any(wall.is_permeable for wall in scene.wall):
            passage = effects.permeable.passage
        self.passage = np.asarray(passage)[:, gas.species]
        self.straight = np.array([w.arc is None for w in scene.pieces], bool)
        self.gates = scene.pieces
        self.fixed = [wall for wall in scene.walls[len(scene.pieces) :] if wall.radius]  # not an inner piston
        self.pistons = scene.piston
        self.outward = [piston.outward_from(gas.position, gas.box) for piston in scene.piston]
        pushes = [
            max(abs(p.acceleration(gas.box, scene.properties.acceleration, time)) for time in (0.0, *p.times))
            for p in scene.piston
        ]
        self.push = max(pushes, default=0.0)
        self.force = sum(push * (piston.mass or 0.0) for push, piston in zip(pushes, scene.piston, strict=True))
        self.rotation, self.restitution = effects.rotation, effects.restitution
        self.since, self.last = np.zeros(n), np.full(n, -math.inf)
        self.hit, self.sunk, self.gone = np.zeros(n, int), np.zeros(n), np.zeros(n, bool)
        self.position, self.velocity = gas.position.copy(), gas.velocity.copy()  # unwrapped
        self.omega = np.zeros(n) if effects.rotation is None else effects.rotation.omega.copy()
        self.inertia = np.zeros(n) if effects.rotation is None else effects.rotation.inertia
        self.first, self.second = np.triu_indices(n, 1)
        self.reach = gas.radius[self.first] + gas.radius[self.second]
        across, along = ((-1, 0, 1) if periodic else (0,) for periodic in self.periodic)
        self.shifts = np.array([(x, y) for x in across for y in along]) * self.size
        self.now, self.known, self.epochs, self.events, self.fastest = 0.0, 0.0, 0, 0, 0.0
        self.weight = 0.0  # the largest so far
        self.pace = self.fastest_piston(effects, 0.0)
        self.start = energy_of(gas, effects)
        self.lowest, self.scale = self.start.balance, self.start.scale

    def fastest_piston(self, effects: Effects, local_time: float) -> float:
        """Largest speed of a piston; 0 without one."""
        both = zip(self.pistons, effects.piston, strict=False)
        return max((abs(piston_motion(record, local_time)[1]) for _, record in both), default=0.0)

    def at(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Unwrapped positions and velocities of all discs; those that have left the gas stay where they left it."""
        dt = ((time - self.since) * ~self.gone)[:, None]
        return self.position + self.velocity * dt + 0.5 * self.pull * dt**2, self.velocity + self.pull * dt

    def resolution(self, duration: float) -> float:
        """How well a place is known after clocks ran for so long."""
        fall = (np.hypot(*self.pull) + self.push) * duration
        return U * (1 + self.epochs) * (self.size.max() + (self.fastest + fall) * duration)

    def wrapped(self, difference: np.ndarray) -> np.ndarray:
        """Through joined sides where that is shorter."""
        return difference - np.where(self.periodic, self.size * np.round(difference / self.size), 0.0)

    def note(self, what: str, error: float, bound: float) -> None:
        """Assert a bound and remember how close it came."""
        assert error <= bound, f"{what}: {error:.3g} > {bound:.3g}"
        share = FEW * float(error / bound) if bound else 0.0
        setattr(self.max_errors, what, max(getattr(self.max_errors, what), share))

    def keep_apart(self, time: float) -> None:
        """No two discs meet from the last event to this time: relative motion is straight, also under gravity."""
        place, velocity = self.at(self.now)
        duration = time - self.now
        apart = self.wrapped(place[self.first] - place[self.second])
        closing = velocity[self.first] - velocity[self.second]
        across = np.ceil(np.abs(closing).max(axis=0, initial=0) * duration / self.size) + 1
        crossed = np.where(self.periodic, np.minimum(across, 4), 0).astype(int)
        squared = (closing**2).sum(axis=1)
        for x in range(-crossed[0], crossed[0] + 1):
            for y in range(-crossed[1], crossed[1] + 1):
                shifted = apart + np.array([x, y]) * self.size
                nearest = np.divide(-(shifted * closing).sum(axis=1), squared, out=0 * squared, where=squared > 0)
                path = shifted + closing * np.clip(nearest, 0, duration)[:, None]
                assert (np.hypot(*path.T) >= self.reach - self.known).all(), "discs pass through each other"

    def fly(self, disc: int, time: float) -> None:
        """The way of a disc since its last event keeps clear of the walls and inside the box."""
        if self.gone[disc]:
            return
        velocity, duration = self.velocity[disc], time - self.since[disc]
        radius = self.gas.radius[disc]
        times = np.linspace(0, duration, SAMPLES)
        with np.errstate(divide="ignore", invalid="ignore"):
            tops = -velocity / self.pull
        path = self.path(disc, np.concatenate((times, tops[(tops > 0) & (tops < duration)])))
        inside = (path >= radius - self.known) & (path <= self.size - radius + self.known)
        assert (inside | self.periodic).all(), "out of the box"
        for wall in self.fixed:
            away = np.hypot(*self.wrapped(path - wall.start).T)
            assert (away >= radius + wall.radius - self.known - self.sunk[disc]).all(), "in a fixed disc"
        self.clear_of_arcs(disc, path, time)
        if not self.straight.any():
            return
        low, high = (np.floor(edge / self.size) for edge in (path.min(axis=0) - radius, path.max(axis=0) + radius))
        low, high = np.where(self.periodic, low, 0).astype(int), np.where(self.periodic, high, 0).astype(int)
        if (high - low + 1).prod() * len(self.walls) > MOST_IMAGES:
            return
        shifts = [(x, y) for x in range(low[0], high[0] + 1) for y in range(low[1], high[1] + 1)]
        passage = self.passage[: len(self.gates), disc]
        there = np.array([all(opens >= time for opens, _ in wall.absences) for wall in self.gates])
        there &= self.straight & (passage == SOLID)
        walls = np.concatenate([self.walls[there] + np.array(shift) * self.size for shift in shifts])
        since = self.since[disc]
        gates = np.array([all(o >= time or c <= since for o, c in wall.absences) for wall in self.gates])
        gates &= self.straight & (passage == SOLID)
        closed = np.concatenate([self.walls[gates] + np.array(shift) * self.size for shift in shifts])
        path = self.path(disc, np.sort(np.concatenate((times, *self.nearest(disc, walls, duration)))))
        if len(walls):
            assert distances(path, walls).min() >= radius - self.known - self.sunk[disc], "in a wall"
        if radius > self.known and len(closed):
            assert not crossings(path[:-1], path[1:], closed).any(), "through a wall"
        for k in np.flatnonzero((passage == FROM_LEFT) | (passage == FROM_RIGHT)):
            for shift in shifts:
                self.pass_one_way(disc, k, np.array(shift) * self.size, duration)

    def pass_one_way(self, disc: int, k: int, shift: np.ndarray, duration: float) -> None:
        """The way of a disc keeps clear of the ends of a wall that it passes in one direction, and goes not back."""
        start, end = self.walls[k] + shift
        times = self.nearest(disc, (self.walls[k] + shift)[None], duration)
        path = self.path(disc, np.sort(np.concatenate((np.linspace(0, duration, SAMPLES), *times))))
        away = np.minimum(np.hypot(*(path - start).T), np.hypot(*(path - end).T))
        assert away.min() >= self.gas.radius[disc] - self.known - self.sunk[disc], "in the end of a wall"
        height = (path - start) @ self.closed_normal(disc, k)
        share = (path - start) @ (end - start) / ((end - start) @ (end - start))
        beyond = np.flatnonzero(np.abs(height) > self.known)
        for pair in pairwise(beyond):
            inside = (share[[*pair]] > 0).all() and (share[[*pair]] < 1).all()
            assert not (inside and height[pair[0]] > 0 > height[pair[1]]), "back through a wall"

    def closed_normal(self, disc: int, k: int) -> np.ndarray:
        """Normal of the closed face of a wall that a disc passes in one direction."""
        return self.left[k] * (-1.0 if self.passage[k, disc] == FROM_LEFT else 1.0)

    def clear_of_arcs(self, disc: int, path: np.ndarray, time: float) -> None:
        """The way of a disc until a time keeps clear of the arcs that have been there since the start."""
        inside = self.wrapped(path - self.size / 2) + self.size / 2
        images = (inside[:, None] + self.shifts).reshape(-1, 2)
        for wall, passage in zip(self.gates, self.passage[:, disc], strict=False):
            if wall.arc and passage == SOLID and all(opens >= time for opens, _ in wall.absences):
                away = images - nearest_points(images, wall.start, wall.end, wall.arc)
                assert np.hypot(*away.T).min() >= self.gas.radius[disc] - self.known - self.sunk[disc], "in an arc"

    def path(self, disc: int, times: np.ndarray) -> np.ndarray:
        """Unwrapped positions (T, 2) of a disc at times after its last event."""
        times = times[:, None]
        return self.position[disc] + self.velocity[disc] * times + 0.5 * self.pull * times**2

    def nearest(self, disc: int, walls: np.ndarray, duration: float) -> list[np.ndarray]:
        """Times at which a disc is nearest to the ends and lines of walls, if that is on its way."""
        velocity, times = self.velocity[disc], np.linspace(0, duration, SAMPLES)
        ends = walls.reshape(-1, 2)
        places = self.path(disc, times)
        best = times[np.hypot(*np.moveaxis(places[:, None] - ends, -1, 0)).argmin(axis=0)]
        with np.errstate(all="ignore"):
            for _ in range(4):  # Newton's method for the derivative of the distance squared
                away = self.path(disc, best) - ends
                speed = velocity + self.pull * best[:, None]
                best = best - (away * speed).sum(axis=1) / ((speed**2).sum(axis=1) + away @ self.pull)
            along = walls[:, 1] - walls[:, 0]
            normal = np.column_stack((-along[:, 1], along[:, 0]))
            tops = -(normal @ velocity) / (normal @ self.pull)
        return [result[(result > 0) & (result < duration)] for result in (best, tops)]

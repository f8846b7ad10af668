"""An invariant checker: an account of the motion of its own, held against the engine after every event.

Paths follow from the rows of the log alone. Between two events no two discs may come closer than their radii, and no
disc to a wall, a side or the piston; at each event the discs must touch and part as the law says; energies must add up.

Bounds are of rounding. A coordinate is known to a few u = 2⁻⁵³ of the box and of the way that the fastest disc can have
gone since clocks started (the epoch's for what the engine computes, the run's for what is computed from the log).
Velocities are known to a few u of the speeds, and directions to the error of a place over the distance of the centres.
A disc that gravity presses on a wall, with bounces lower than what a place is known to, does not come out of it again:
each bounce rounds both coordinates twice, and the roundings may add up.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from helpers.random_walls import crossings, distances
from idealgas.columns import BATH, OUTSIDE, SIDES, EventBatch, Kind
from idealgas.effects.bundle import Effects
from idealgas.engine.simulation import Simulation
from idealgas.physics.arc_geometry import nearest_points
from idealgas.physics.permeable import FROM_LEFT, FROM_RIGHT, OPEN, SOLID
from idealgas.physics.piston import piston_motion
from idealgas.physics.vibration import height_on, parabola_at
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


class InvariantChecker:
    """Follows one run. Every method raises AssertionError where something does not hold."""

    def __init__(self, scene: Scene, gas: Gas, effects: Effects, max_errors: MaxErrors) -> None:
        n = len(gas)
        self.gas, self.max_errors = gas, max_errors
        self.pull = np.array(scene.properties.acceleration)
        self.size, self.periodic = np.array(gas.box), np.array(scene.box.periodic)
        self.walls = np.array([(w.start, w.end) for w in scene.wall]).reshape(-1, 2, 2)
        along = self.walls[:, 1] - self.walls[:, 0]
        along = along / np.where(along.any(axis=1), np.hypot(*along.T), 1.0)[:, None]
        self.left = np.column_stack((-along[:, 1], along[:, 0]))
        passage = np.zeros((len(scene.walls), len(gas.species_names)), int)
        if scene.wall and any(wall.is_permeable for wall in scene.wall):
            passage = effects.permeable.passage
        self.passage = np.asarray(passage)[:, gas.species]
        self.straight = np.array([w.arc is None for w in scene.wall], bool)
        self.gates, self.fixed = scene.wall, scene.walls[len(scene.wall) :]
        self.piston = scene.piston
        self.outward = scene.piston.outward_from(gas.position, gas.box) if scene.piston else np.zeros(n)
        self.push = abs(scene.piston.acceleration(gas.box, scene.properties.acceleration)) if scene.piston else 0.0
        self.force = self.push * (scene.piston.mass or 0.0) if scene.piston else 0.0
        self.rotation, self.restitution = effects.rotation, effects.restitution
        self.since, self.last = np.zeros(n), np.full(n, -math.inf)
        self.hit, self.sunk = np.zeros(n, int), np.zeros(n)
        self.position, self.velocity = gas.position.copy(), gas.velocity.copy()  # unwrapped
        self.omega = np.zeros(n) if effects.rotation is None else effects.rotation.omega.copy()
        self.inertia = np.zeros(n) if effects.rotation is None else effects.rotation.inertia
        self.first, self.second = np.triu_indices(n, 1)
        self.reach = gas.radius[self.first] + gas.radius[self.second]
        across, along = ((-1, 0, 1) if periodic else (0,) for periodic in self.periodic)
        self.shifts = np.array([(x, y) for x in across for y in along]) * self.size
        self.now, self.known, self.epochs, self.events, self.fastest = 0.0, 0.0, 0, 0, 0.0
        self.pace = 0.0 if self.piston is None else abs(piston_motion(effects.piston[0], 0.0)[1])
        self.start = energy_of(gas, effects)
        self.lowest, self.scale = self.start.balance, self.start.scale

    # ── what is known, and how well ──

    def at(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Unwrapped positions and velocities of all discs."""
        dt = (time - self.since)[:, None]
        return self.position + self.velocity * dt + 0.5 * self.pull * dt**2, self.velocity + self.pull * dt

    def resolution(self, duration: float) -> float:
        """How well a place is known after clocks ran for so long."""
        fall = (np.hypot(*self.pull) + self.push) * duration
        return U * (1 + self.epochs) * (self.size.max() + (self.fastest + fall) * duration)

    def wrapped(self, difference: np.ndarray) -> np.ndarray:
        """Through joined sides where that is shorter."""
        return difference - np.where(self.periodic, self.size * np.round(difference / self.size), 0.0)

    # ── one event ──

    def see(self, rows: EventBatch, simulation: Simulation) -> None:
        """The rows of one event, and the simulation as the event left it."""
        time = float(rows.time[0])
        assert all(np.isfinite(column).all() for column in rows if column is not None)
        assert (rows.time == time).all()
        assert time >= self.now
        place, velocity = self.at(time)
        self.look(time, simulation)
        discs = rows.disc.astype(int)
        image = 0 if rows.image is None else rows.image
        after = rows.position + image * self.size
        self.note("place", np.abs(after - place[discs]).max(), self.known)
        for disc in discs:
            self.fly(disc, time)
        if rows.kind[0] == Kind.DISC:
            self.meet(rows, velocity[discs], time)
        elif rows.kind[0] == Kind.THERMOSTAT:
            assert rows.partner[0] == BATH
        else:
            self.bounce(int(rows.kind[0]), int(rows.partner[0]), rows, velocity[discs[0]], simulation, time)
        self.position[discs], self.velocity[discs] = after, rows.velocity
        self.hit[discs] = rows.partner
        self.since[discs] = self.now = time
        if rows.kind[0] != Kind.THERMOSTAT:
            self.last[discs] = time
        if rows.angular_velocity is not None:
            self.omega[discs] = rows.angular_velocity
        self.events += 1
        self.max_errors.events += 1
        self.compare(time, simulation)

    def steer(self, simulation: Simulation) -> None:
        """Velocities or gravity changed at the start of this epoch: a row for each disc, which only the log has."""
        time, gas, effects = simulation.time, simulation.gas, simulation.effects
        place, _ = self.at(time)
        self.look(time, simulation)
        for disc in range(len(gas)):
            self.fly(disc, time)
        after = gas.position + effects.periodic.image * self.size
        self.note("place", np.abs(after - place).max(), self.known)
        self.position, self.velocity = after, gas.velocity.copy()
        self.pull = np.zeros(2) if effects.gravity is None else np.array(effects.gravity)
        self.omega = effects.rotation.omega.copy()
        self.hit[:], self.since[:], self.now = OUTSIDE, time, time

    def note(self, what: str, error: float, bound: float) -> None:
        """Assert a bound and remember how close it came."""
        assert error <= bound, f"{what}: {error:.3g} > {bound:.3g}"
        share = FEW * float(error / bound) if bound else 0.0
        setattr(self.max_errors, what, max(getattr(self.max_errors, what), share))

    def finish(self, time: float, simulation: Simulation) -> None:
        """The end of the run, at its end time."""
        self.look(time, simulation)
        for disc in range(len(self.gas)):
            self.fly(disc, time)
        self.compare(time, simulation)

    def look(self, time: float, simulation: Simulation) -> None:
        """How well all is known now; what happened since the last event."""
        earlier = self.fastest if self.epochs == simulation.epoch else 0.0  # what was fast left its errors behind
        self.epochs = simulation.epoch
        self.fastest = max(np.hypot(*self.at(t)[1].T).max() for t in (self.now, time))
        if self.piston is not None:
            before = self.pace  # after the last event: a light piston may give all of it to the disc that it meets
            self.pace = abs(piston_motion(simulation.effects.piston[0], time - simulation.time)[1])
            self.fastest += max(before, self.pace) + self.push * (time - self.now)
        self.fastest = max(self.fastest, earlier)
        self.known = max(self.known, FEW * self.resolution(time))  # a place keeps its error
        self.touches = FEW * self.resolution(time - simulation.time)
        self.keep_apart(time)

    # ── flights ──

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

    def at_points(self, away: np.ndarray, reach: float, before, after, rebounds) -> tuple[np.ndarray, float]:
        """Normal of the point that a disc touches, of several at `away` (M, 2), and by how much it misses contact."""
        distances = np.hypot(*away.T)
        misses = np.abs(distances - reach)
        touching = (misses <= self.touches) | (misses == misses.min())
        return self.fitting((away / distances[:, None])[touching], before, after, rebounds), float(misses.min())

    def at_one_way(self, kind, disc: int, k: int, place, before, after, rebounds) -> tuple[np.ndarray, float]:
        """Normal of such a wall for a disc that bounces off it, and by how much the disc misses its place there."""
        (start, end), radius = self.walls[k], self.gas.radius[disc]
        images = place + self.shifts
        if kind == Kind.WALL:
            normal = self.closed_normal(disc, k)
            height = (images - start) @ normal
            share = (images - start) @ (end - start) / ((end - start) @ (end - start))
            margin = self.known / np.hypot(*(end - start))
            misses = np.where((share > -margin) & (share < 1 + margin), 0.0, np.inf)
            return normal, float((misses + np.minimum(np.abs(height - radius), np.abs(height))).min())
        return self.at_points(np.concatenate((images - start, images - end)), radius, before, after, rebounds)

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
        return [found[(found > 0) & (found < duration)] for found in (best, tops)]

    # ── collisions ──

    def energy(self, disc: int, velocity: np.ndarray, omega: float) -> float:
        """Of motion and spin."""
        return float(0.5 * self.gas.mass[disc] * velocity @ velocity + 0.5 * self.inertia[disc] * omega**2)

    def rebounds(self, discs, coefficient: float, time: float) -> tuple[float, ...]:
        """The coefficients that are right; two if the last collision was about a contact duration ago."""
        if self.restitution is None:
            return (1.0,)
        duration, ago = self.restitution.contact_duration, time - max(self.last[discs])
        either = abs(ago - duration) <= 1e-6 * duration + FEW * U * time
        return (1.0, coefficient) if either else (1.0 if ago < duration else coefficient,)

    def fitting(self, normals: np.ndarray, before: np.ndarray, after: np.ndarray, rebounds) -> np.ndarray:
        """The one of several normals (M, 2) along which a rebound fits best."""
        misfits = [np.abs(normals @ after + e * (normals @ before)) for e in rebounds]
        return normals[(np.min(misfits, axis=0) + np.maximum(normals @ before, 0.0)).argmin()]  # towards each other

    def parts(self, before: float, after: float, rebounds, bound: float, grazing: float, what: str) -> None:
        """Normal speeds, away from each other, before and after. grazing: what a graze may turn out to be."""
        assert before <= bound + grazing, f"{what}: no approach"
        assert min(abs(after + e * before) for e in rebounds) <= bound, f"{what}: rebound from {before} to {after}"

    def meet(self, rows: EventBatch, before: np.ndarray, time: float) -> None:
        """Two discs touch, and part by the law."""
        i, j = (int(k) for k in rows.disc)
        assert rows.partner.tolist() == [j, i]
        reach, mass = self.gas.radius[[i, j]].sum(), self.gas.mass[[i, j]]
        images = rows.position[0] - rows.position[1] + self.shifts
        error = np.abs(np.hypot(*images.T) - reach)
        self.note("contact", error.min(), self.touches)
        touching = images[error <= self.touches]  # in two images at once, if the box has room for no more
        normals = touching / np.hypot(*touching.T)[:, None]
        coefficient = 1.0 if self.restitution is None else self.restitution.normal
        rebounds = self.rebounds([i, j], coefficient, time)
        normal = self.fitting(normals, before[0] - before[1], rows.velocity[0] - rows.velocity[1], rebounds)
        speeds = np.hypot(*before.T).sum() + np.hypot(*rows.velocity.T).sum() + np.hypot(*self.pull) * time
        bound = speeds * (FEW * U * (1 + self.epochs) + 4 * self.touches / reach)
        closing, parting = ((v[0] - v[1]) @ normal for v in (before, rows.velocity))
        grazing = np.hypot(*(before[0] - before[1])) * math.sqrt(2 * self.touches / reach)
        self.parts(closing, parting, rebounds, bound, grazing, "discs")
        gained = (mass[:, None] * (rows.velocity - before)).sum(axis=0)
        assert np.abs(gained).max() <= FEW * U * (1 + self.epochs) * mass @ (
            np.hypot(*before.T) + np.hypot(*rows.velocity.T) + np.hypot(*self.pull) * time
        ), "momentum"
        omegas = self.omega[[i, j]] if rows.angular_velocity is None else rows.angular_velocity
        old = sum(self.energy(k, v, self.omega[k]) for k, v in zip((i, j), before, strict=True))
        new = sum(self.energy(k, v, w) for k, v, w in zip((i, j), rows.velocity, omegas, strict=True))
        slack = 4 * FEW * U * (1 + self.epochs) * (old + mass.max() * speeds * np.hypot(*self.pull) * time)
        assert new <= old + slack, "energy gained"
        elastic = self.restitution is None or self.restitution.normal == 1
        if elastic and (self.rotation is None or abs(self.rotation.roughness) == 1):
            assert new >= old - slack, "energy lost"

    def bounce(self, kind, partner, rows: EventBatch, before, simulation: Simulation, time: float) -> None:
        """A disc touches a wall or the piston, and leaves it by the law."""
        disc, wall = int(rows.disc[0]), -1 - partner
        place, after, radius = rows.position[0], rows.velocity[0], self.gas.radius[disc]
        stand, normal = 0.0, np.zeros(2)
        height = np.hypot(*self.pull) * (time - self.since[disc]) ** 2 / 8
        if kind != Kind.PISTON and self.hit[disc] == partner and height <= self.known:
            self.sunk[disc] += 2 * U * self.size.sum()
        coefficient = 1.0 if self.restitution is None else self.restitution.wall
        rebounds = self.rebounds([disc], coefficient, time)
        if kind == Kind.PISTON:
            axis, piston = self.piston.axis, simulation.effects.piston[0]
            normal[axis], edge, stand = -self.outward[disc], piston.x, piston.v
            assert self.piston.wall == (SIDES[wall] if wall < 4 else "piston")
            distance = abs(place[axis] - edge)
        elif wall < 4:
            axis, upper = divmod(wall, 2)
            normal[axis] = -1.0 if upper else 1.0
            edge = self.size[axis] * upper
            assert self.piston is None or self.piston.wall != SIDES[wall]
            vibration = simulation.effects.vibration
            if vibration is not None and vibration[wall].amplitude > 0:
                own, inward = vibration[wall], -1.0 if upper else 1.0
                local = time - simulation.time
                height, speed, _ = height_on(own, parabola_at(own, local), local)
                edge, stand = edge + inward * height, inward * speed
            distance = abs(place[axis] - edge)
        elif wall - 4 >= len(self.gates):
            fixed = self.fixed[wall - 4 - len(self.gates)]
            away = place + self.shifts - np.array(fixed.start)
            normal, miss = self.at_points(away, fixed.radius + radius, before, after, rebounds)
            distance = radius + miss
            assert kind == Kind.WALL_END
        elif self.passage[wall - 4, disc] != SOLID:
            assert self.passage[wall - 4, disc] != OPEN
            normal, miss = self.at_one_way(kind, disc, wall - 4, place, before, after, rebounds)
            distance = radius + miss
        else:
            gate = self.gates[wall - 4]
            assert gate.is_there(time), "an open gate"
            closed = any(closes <= time for _, closes in gate.absences)  # perhaps over a disc
            start, end = self.walls[wall - 4]
            share, away = self.near(place, gate)
            distances = np.hypot(*away.T)
            if closed and distances.min() <= self.touches:
                return  # it closed on the very centre: neither side is that of the disc
            normals = away / distances[:, None]
            if closed:
                distances = np.maximum(distances, radius)
            nearest = np.abs(distances - radius).argmin()
            touching = (np.abs(distances - radius) <= self.touches) | (np.arange(len(away)) == nearest)
            normal = self.fitting(normals[touching], before, after, rebounds)
            share, distance = share[touching], distances[nearest]
            along = self.known / (np.hypot(*(end - start)) or 1.0)
            inside = (share > along) & (share < 1 - along)
            beyond = (share < -along) | (share > 1 + along)
            assert not (beyond if kind == Kind.WALL else inside).all(), "foot"
        self.note("contact", abs(distance - radius), self.touches + self.sunk[disc])
        if kind == Kind.PISTON and self.piston.mass is not None:
            return  # its own change is in the balance of energy
        speeds = np.hypot(*before) + np.hypot(*after) + abs(stand) + np.hypot(*self.pull) * time
        bound = speeds * (FEW * U * (1 + self.epochs) + 4 * self.touches / radius)
        motion = stand * np.abs(normal)
        incoming, outgoing = (before - motion) @ normal, (after - motion) @ normal
        grazing = math.sqrt(2 * self.touches * (np.hypot(*self.pull) + self.push + before @ before / radius))
        thermal = simulation.effects.thermal
        if thermal is not None and thermal.temperature[wall] >= 0:
            assert incoming <= bound + grazing, "thermal wall: no approach"
            assert outgoing >= -bound, "thermal wall: into it"
        else:
            self.parts(incoming, outgoing, rebounds, bound, grazing, "wall")

    def near(self, place, wall) -> tuple[np.ndarray, np.ndarray]:
        """For each image of a place: where along a wall its foot is, as a share, and how it stands from there.

        On an arc the share is 1/2, or 0 next to an end.
        """
        start, end = np.array(wall.start), np.array(wall.end)
        along, images = end - start, place + self.shifts
        if wall.arc:
            foot = nearest_points(images, start, end, wall.arc)
            ends = np.minimum(np.hypot(*(foot - start).T), np.hypot(*(foot - end).T))
            return np.where((ends < 1e-6 * wall.arc.radius) & (wall.start != wall.end), 0.0, 0.5), images - foot
        share = (images - start) @ along / (along @ along)
        return share, images - start - np.clip(share, 0, 1)[:, None] * along

    # ── the whole gas ──

    def compare(self, time: float, simulation: Simulation) -> None:
        """The engine's state is the one that follows from the log, the piston is beyond all discs, energies add up."""
        gas, effects = simulation.state()
        place, velocity = self.at(time)
        speed = self.fastest + np.hypot(*self.pull) * time
        assert np.abs(self.wrapped(gas.position - place)).max() <= self.known, "state"
        assert np.abs(gas.velocity - velocity).max() <= FEW * U * (1 + self.epochs) * speed, "state"
        if self.piston is not None:
            self.behind_piston(place, effects.piston, time - simulation.time)
        energy = energy_of(gas, effects, time - simulation.time)
        self.scale = max(self.scale, energy.scale)
        weight = self.gas.mass.sum() * np.hypot(*self.pull) + self.force
        bound = FEW * U * (10 + self.events + self.epochs) * (self.scale + weight * self.size.max())
        sums = [entry for entry in (effects.wall_energy, effects.dissipated, effects.bath_energy) if entry is not None]
        bound += sum(self.events / entry.per_unit.min() for entry in sums)  # each event adds a rounded term to each
        kept = energy.balance - energy.lost
        assert kept <= self.lowest + bound, "energy gained"
        self.lowest = min(self.lowest, kept)
        drift = abs(energy.balance - self.start.balance)
        assert drift <= bound, f"energy drifts by {drift}"
        self.max_errors.energy = max(self.max_errors.energy, drift / self.scale if self.scale else 0.0)

    def behind_piston(self, place: np.ndarray, piston: np.ndarray, local_time: float) -> None:
        """No disc is beyond the piston, which is in the box."""
        edge, _ = piston_motion(piston[0], local_time)
        axis = self.piston.axis
        assert (self.outward * (edge - place[:, axis]) >= self.gas.radius - self.known).all(), "beyond the piston"
        assert -self.known <= edge <= self.size[axis] + self.known, "piston beyond its stop"

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

import numpy as np

from helpers.paths import FEW, Paths, U
from idealgas.columns import BATH, OUTSIDE, SIDES, EventBatch, Kind
from idealgas.engine.simulation import Simulation
from idealgas.physics.arc_geometry import nearest_points
from idealgas.physics.permeable import OPEN, SOLID, TOUCHING
from idealgas.physics.piston import piston_motion
from idealgas.physics.vibration import motion_at
from idealgas.run.energy import energy_of


class InvariantChecker(Paths):
    """Follows one run. Every method raises AssertionError where something does not hold."""

    # ── one event ──

    def see(self, rows: EventBatch, simulation: Simulation) -> None:
        """The rows of one event, and the simulation as the event left it."""
        time = float(rows.time[0])
        assert not self.gone[rows.disc].any(), "a disc that has left"
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
        elif rows.kind[0] == Kind.ESCAPED:
            self.escape(rows, velocity[discs[0]], time)
        else:
            self.bounce(int(rows.kind[0]), int(rows.partner[0]), rows, velocity[discs[0]], simulation, time)
        self.position[discs], self.velocity[discs] = after, rows.velocity
        self.hit[discs] = rows.partner
        self.since[discs] = self.now = time
        if rows.kind[0] != Kind.THERMOSTAT:
            self.last[discs] = time
        if rows.angular_velocity is not None:
            self.omega[discs] = rows.angular_velocity
        if rows.kind[0] == Kind.ESCAPED:
            self.gone[discs] = True
            self.velocity[discs] = self.omega[discs] = 0.0
            self.reach[self.gone[self.first] | self.gone[self.second]] = -math.inf
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
        after = np.where(self.gone[:, None], self.position, gas.position + effects.periodic.image * self.size)
        self.note("place", np.abs(after - place).max(), self.known)
        self.position, self.velocity = after, gas.velocity.copy()
        self.pull = np.zeros(2) if effects.gravity is None else np.array(effects.gravity)
        self.omega = effects.rotation.omega.copy()
        self.hit[:], self.since[:], self.now = OUTSIDE, time, time

    def finish(self, time: float, simulation: Simulation) -> None:
        """The end of the run, at its end time."""
        self.look(time, simulation)
        for disc in range(len(self.gas)):
            self.fly(disc, time)
        self.compare(time, simulation)

    def look(self, time: float, simulation: Simulation) -> None:
        """How well all is known now; what happened since the last event."""
        self.weight = max(self.weight, self.gas.mass.sum() * np.hypot(*self.pull))
        earlier = self.fastest if self.epochs == simulation.epoch else 0.0  # what was fast left its errors behind
        self.epochs = simulation.epoch
        self.fastest = max(np.hypot(*self.at(t)[1].T).max() for t in (self.now, time))
        if self.pistons:
            before = self.pace  # after the last event: a light piston may give all of it to the disc that it meets
            self.pace = self.fastest_piston(simulation.effects, time - simulation.time)
            self.fastest += max(before, self.pace) + self.push * (time - self.now)
        self.fastest = max(self.fastest, earlier)
        self.known = max(self.known, FEW * self.resolution(time))  # a place keeps its error
        self.touches = FEW * self.resolution(time - simulation.time)
        self.keep_apart(time)

    def at_points(self, away: np.ndarray, reach: float, before, after, rebounds) -> tuple[np.ndarray, float]:
        """Normal of the point that a disc touches, of several at `away` (M, 2), and by how much it misses contact."""
        distances = np.hypot(*away.T)
        misses = np.abs(distances - reach)
        touching = (misses <= self.touches) | (misses == misses.min())
        return self.fitting((away / distances[:, None])[touching], before, after, rebounds), float(misses.min())

    def at_one_way(self, kind, disc: int, k: int, turned, place, before, after, rebounds) -> tuple[np.ndarray, float]:
        """Normal of such a wall for a disc that bounces off it, and by how much the disc misses its place there.

        turned: whether something else turned the disc at this instant, perhaps when it had all but come out.
        """
        (start, end), radius = self.walls[k], self.gas.radius[disc]
        images = place + self.shifts
        if kind == Kind.WALL:
            normal = self.closed_normal(disc, k)
            height = (images - start) @ normal
            share = (images - start) @ (end - start) / ((end - start) @ (end - start))
            margin = self.known / np.hypot(*(end - start))
            misses = np.where((share > -margin) & (share < 1 + margin), 0.0, np.inf)
            off = np.where(turned & (height > TOUCHING * radius) & (height < radius), 0.0, np.abs(height - radius))
            return normal, float((misses + np.minimum(off, np.abs(height))).min())
        return self.at_points(np.concatenate((images - start, images - end)), radius, before, after, rebounds)

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
        stand, turn, normal = 0.0, 0.0, np.zeros(2)
        height = np.hypot(*self.pull) * (time - self.since[disc]) ** 2 / 8
        if kind != Kind.PISTON and self.hit[disc] == partner and height <= self.known:
            self.sunk[disc] += 2 * U * self.size.sum()
        coefficient = 1.0 if self.restitution is None else self.restitution.wall
        rebounds = self.rebounds([disc], coefficient, time)
        if kind == Kind.PISTON:
            names = [*SIDES, *(w.name for w in self.gates), *self.fixed, *(p.wall for p in self.pistons if p.inner)]
            k = [piston.wall for piston in self.pistons].index(names[wall])
            axis, piston = self.pistons[k].axis, simulation.effects.piston[k]
            normal[axis], edge, stand = -self.outward[k][disc], piston.x, piston.v
            distance = abs(place[axis] - edge)
        elif wall < 4:
            axis, upper = divmod(wall, 2)
            normal[axis] = -1.0 if upper else 1.0
            edge = self.size[axis] * upper
            assert SIDES[wall] not in [piston.wall for piston in self.pistons]
            vibration = simulation.effects.vibration
            if vibration is not None and vibration[wall].amplitude > 0:
                own, inward = vibration[wall], -1.0 if upper else 1.0
                local = time - simulation.time
                height, speed, turn = motion_at(own, local)
                edge, stand = edge + inward * height, inward * speed
            distance = abs(place[axis] - edge)
        elif wall - 4 >= len(self.gates):
            fixed = self.fixed[wall - 4 - len(self.gates)]
            away = place + self.shifts - np.array(fixed.start)
            normal, miss = self.at_points(away, fixed.radius + radius, before, after, rebounds)
            distance = radius + miss
            assert kind == Kind.FIXED_DISC
        elif self.passage[wall - 4, disc] != SOLID:
            assert self.passage[wall - 4, disc] != OPEN
            normal, miss = self.at_one_way(
                kind, disc, wall - 4, self.since[disc] == time, place, before, after, rebounds
            )
            distance = radius + miss
        else:
            gate = self.gates[wall - 4]
            assert gate.is_present(time), "an open gate"
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
        clock = U * time * abs(stand)  # a wall that moves is where it is at a rounded time
        self.note("contact", abs(distance - radius), self.touches + self.sunk[disc] + clock)
        if kind == Kind.PISTON and self.pistons[k].mass is not None:
            return  # its own change is in the balance of energy
        speeds = np.hypot(*before) + np.hypot(*after) + abs(stand) + np.hypot(*self.pull) * time
        bound = speeds * (FEW * U * (1 + self.epochs) + 4 * self.touches / radius) + 2 * U * time * abs(turn)
        motion = stand * np.abs(normal)
        incoming, outgoing = (before - motion) @ normal, (after - motion) @ normal
        grazing = math.sqrt(2 * self.touches * (np.hypot(*self.pull) + self.push + before @ before / radius))
        thermal = simulation.effects.thermal
        if thermal is not None and thermal.temperature[wall] >= 0:
            assert incoming <= bound + grazing, "thermal wall: no approach"
            assert outgoing >= -bound, "thermal wall: into it"
        else:
            self.parts(incoming, outgoing, rebounds, bound, grazing, "wall")

    def escape(self, rows: EventBatch, before: np.ndarray, time: float) -> None:
        """A disc touches an absorbing wall, and leaves the gas as it is.

        Over one that has closed on it, or that it has passed from the other side, it leaves where it comes back.
        """
        disc, wall = int(rows.disc[0]), -5 - int(rows.partner[0])
        gate, radius = self.gates[wall], self.gas.radius[disc]
        assert gate.absorbing
        assert gate.is_present(time)
        assert self.passage[wall, disc] != OPEN
        _, away = self.near(rows.position[0], gate)
        distance = np.hypot(*away.T).min()
        deep = self.passage[wall, disc] != SOLID or any(closes <= time for _, closes in gate.absences)
        error = max(distance - radius, 0.0) if deep else abs(distance - radius)
        self.note("contact", error, self.touches + self.sunk[disc])
        speed = np.hypot(*before) + np.hypot(*self.pull) * time
        assert np.abs(rows.velocity[0] - before).max() <= FEW * U * (1 + self.epochs) * speed, "velocity"

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
        """The engine's state is the one that follows from the log, no disc is beyond a piston, energies add up."""
        gas, effects = simulation.state()
        place, velocity = self.at(time)
        speed = self.fastest + np.hypot(*self.pull) * time
        assert (np.isnan(gas.position).all(axis=1) == self.gone).all(), "left"
        apart = self.wrapped(gas.position - place)[~self.gone]
        assert np.abs(apart).max(initial=0.0) <= self.known, "state"
        assert np.abs(gas.velocity - velocity).max() <= FEW * U * (1 + self.epochs) * speed, "state"
        for k in range(len(self.pistons)):
            self.behind_piston(place, k, effects.piston[k], time - simulation.time)
        energy = energy_of(gas, effects, time - simulation.time)
        self.scale = max(self.scale, energy.scale)
        work = (self.weight + self.force) * self.size.max()
        bound = FEW * U * (10 + self.events + self.epochs) * (self.scale + work)
        sums = [entry for entry in (effects.wall_energy, effects.dissipated, effects.bath_energy) if entry is not None]
        bound += sum(self.events / entry.per_unit.min() for entry in sums)  # each event adds a rounded term to each
        kept = energy.balance - energy.lost
        assert kept <= self.lowest + bound, "energy gained"
        self.lowest = min(self.lowest, kept)
        drift = abs(energy.balance - self.start.balance)
        assert drift <= bound, f"energy drifts by {drift}"
        self.max_errors.energy = max(self.max_errors.energy, drift / self.scale if self.scale else 0.0)

    def behind_piston(self, place: np.ndarray, k: int, piston: np.record, local_time: float) -> None:
        """No disc is beyond piston k, which is in the box."""
        edge, _ = piston_motion(piston, local_time)
        axis = self.pistons[k].axis
        behind = self.outward[k] * (edge - place[:, axis]) >= self.gas.radius - self.known
        assert (behind | self.gone).all(), "beyond the piston"
        assert -self.known <= edge <= self.size[axis] + self.known, "piston beyond its stop"

"""Resolution of events: the discs involved are moved to the time of the event and collide, and the event is counted."""

import numpy as np

from idealgas.columns import FIRST_SEGMENT, SIDES
from idealgas.engine.event_writer import ESCAPED, FIXED_DISC, WALL, WALL_END
from idealgas.jit import inline
from idealgas.physics.arc import wall_frame
from idealgas.physics.disc_disc import collide
from idealgas.physics.disc_wall import collide_with_wall, inward_normal
from idealgas.physics.exact_sum import add
from idealgas.physics.gravity import potential_energy
from idealgas.physics.motion import advance
from idealgas.physics.periodic import enter_opposite_side, place_in_space, wrap
from idealgas.physics.permeable import passage_of
from idealgas.physics.piston import advance_piston, collide_with_piston, energy_at_piston, normal_of_piston
from idealgas.physics.restitution import record_collision
from idealgas.physics.shear import add_flow, cross, enter_common_frame, leave_common_frame
from idealgas.physics.stress import record_collision_stress, record_flight, record_hit
from idealgas.physics.thermal import is_thermal
from idealgas.physics.thermostat import andersen_collision
from idealgas.physics.vibration import side_velocity

U = np.uintp
TOP = SIDES.index("top")


@inline
def energy_of(disc, disc_id, rotation):
    """Kinetic energy of a disc, spin included, mass length²/time²."""
    energy = 0.5 * disc.m * (disc.vx * disc.vx + disc.vy * disc.vy)
    if rotation is not None:
        omega = rotation.omega[U(disc_id)]
        energy += 0.5 * rotation.inertia[U(disc_id)] * (omega * omega)
    return energy


@inline
def add_energy(sums, k, energy):
    """Add an energy (mass length²/time²) to sum k, if these energies are recorded."""
    if sums is not None:
        add(sums[U(k)], energy)


@inline
def record_wall_energy(wall, received, lost, wall_energy, dissipated, thermal):
    """Record the energy that a wall gave to a disc, and the energy dissipated; a thermal wall dissipates none."""
    if wall_energy is not None:
        add(wall_energy[U(wall)], received)
    if dissipated is not None and not is_thermal(thermal, wall):
        add(dissipated[U(1 + wall)], lost)


@inline
def finish(disc, disc_id, time, restitution, periodic):
    """Finish an event of a disc: wrap its position, store the time of the collision, and count the event."""
    if periodic is not None:
        wrap(disc, disc_id, periodic)
    if restitution is not None:
        record_collision(restitution, disc_id, time)
    disc.count += np.uint32(1)


@inline
def resolve_pair(a, b, a_id, b_id, time, images, effects):
    """Collide two discs at a local time."""
    delays, start = (time - a.t, time - b.t), (a.vx, a.vy, b.vx, b.vy)
    advance(a, time, effects.gravity)
    advance(b, time, effects.gravity)
    end = collide_and_record(a, b, a_id, b_id, images, effects.shear, effects.dissipated, effects)
    record_collision_stress(effects.flow, a, b, a_id, b_id, (delays, start, end), images, effects)
    finish(a, a_id, time, effects.restitution, effects.periodic)
    finish(b, b_id, time, effects.restitution, effects.periodic)


@inline
def collide_and_record(a, b, a_id, b_id, images, shear, dissipated, effects):
    """Collide two discs that are at the time of contact, and record the energy dissipated.

    Across sheared sides, the discs collide in the frame half-way between their two frames. The image of a partner
    beyond the top moves at speed u and does work equal to u times the momentum transferred through the top; this work
    is also recorded. Returns the velocities (a_vx, a_vy, b_vx, b_vy) before the collision, length/time.
    """
    before = a.vx, a.vy, b.vx, b.vy
    if shear is not None:
        enter_common_frame(a, b, shear, images)
    energy = 0.0
    if dissipated is not None:
        energy = energy_of(a, a_id, effects.rotation) + energy_of(b, b_id, effects.rotation)
    collide(a, b, a_id, b_id, images, effects.rotation, effects.periodic, effects)
    if dissipated is not None:
        energy -= energy_of(a, a_id, effects.rotation) + energy_of(b, b_id, effects.rotation)
        add(dissipated[U(0)], energy)
    if shear is not None:
        leave_common_frame(a, b, shear, images)
        if images[1] != 0:
            to_a, to_b = a.m * (a.vx - before[0]), b.m * (b.vx - before[2])
            add_energy(effects.wall_energy, TOP, 0.5 * shear.speed * images[1] * (to_a - to_b))
    return before


@inline
def arrive(disc, time, flow, gravity):
    """Move a disc to the local time at which it meets a wall or the heat bath, and record the flight."""
    if flow is not None:
        record_flight(flow, disc, time, gravity)
    advance(disc, time, gravity)


@inline
def bounce(disc, disc_id, nx, ny, wall, time, effects):
    """Reflect a disc at a wall at rest, or emit it from a thermal wall, and record the energies.

    The disc must be at the time of contact. wall: number of the wall. Returns the momentum (px, py) that the disc
    received, mass length/time.
    """
    energy = energy_of(disc, disc_id, effects.rotation)
    vx = disc.vx
    vy = disc.vy
    collide_with_wall(disc, disc_id, nx, ny, wall, effects.restitution, effects.rotation, effects.thermal)
    energy -= energy_of(disc, disc_id, effects.rotation)
    record_wall_energy(wall, -energy, energy, effects.wall_energy, effects.dissipated, effects.thermal)
    finish(disc, disc_id, time, effects.restitution, effects.periodic)
    return disc.m * (disc.vx - vx), disc.m * (disc.vy - vy)


@inline
def absorb(disc, disc_id, wall, time, effects):
    """Absorb a disc at a wall, which takes up all its energy and momentum.

    The disc must be at the time of contact. Returns the momentum (px, py) that it received, mass length/time.
    """
    finish(disc, disc_id, time, effects.restitution, effects.periodic)
    place = place_in_space(disc, disc_id, effects.periodic)
    energy = energy_of(disc, disc_id, effects.rotation) + potential_energy(disc.m, place, effects.gravity)
    record_wall_energy(wall, -energy, 0.0, effects.wall_energy, effects.dissipated, effects.thermal)
    return -(disc.m * disc.vx), -(disc.m * disc.vy)


@inline
def meet_segment(disc, disc_id, nx, ny, segment, time, absorbing, effects):
    """Reflect, emit or absorb a disc at a wall inside the box.

    Returns the momentum (px, py) that the disc received, mass length/time, and whether it was absorbed.
    """
    if absorbing is not None and absorbing[U(segment)]:
        return absorb(disc, disc_id, FIRST_SEGMENT + segment, time, effects), True
    return bounce(disc, disc_id, nx, ny, FIRST_SEGMENT + segment, time, effects), False


@inline
def bounce_off_vibrating(disc, disc_id, nx, ny, side, time, vibration, effects):
    """Do the work of `bounce` at a side of the box that may vibrate."""
    speed = side_velocity(vibration, side, time)
    before = energy_of(disc, disc_id, effects.rotation)
    vx = disc.vx
    vy = disc.vy
    disc.vx -= speed * nx
    disc.vy -= speed * ny
    lost = energy_of(disc, disc_id, effects.rotation)
    collide_with_wall(disc, disc_id, nx, ny, side, effects.restitution, effects.rotation, effects.thermal)
    lost -= energy_of(disc, disc_id, effects.rotation)
    disc.vx += speed * nx
    disc.vy += speed * ny
    received = energy_of(disc, disc_id, effects.rotation) - before
    record_wall_energy(side, received, lost, effects.wall_energy, effects.dissipated, effects.thermal)
    finish(disc, disc_id, time, effects.restitution, effects.periodic)
    return disc.m * (disc.vx - vx), disc.m * (disc.vy - vy)


@inline
def resolve_side(disc, disc_id, side, time, effects):
    """Collide a disc with a side of the box at a local time, or let it cross a sheared side."""
    arrive(disc, time, effects.flow, effects.gravity)
    meet_side(disc, disc_id, side, time, effects.shear, effects.vibration, effects.flow, effects)


@inline
def meet_side(disc, disc_id, side, time, shear, vibration, flow, effects):
    """Do the work of `resolve_side` for a disc that is at the time of contact."""
    if shear is not None:
        cross_side(disc, disc_id, side, shear, effects)
        return
    nx, ny = inward_normal(side)
    if vibration is not None:
        impulse = bounce_off_vibrating(disc, disc_id, nx, ny, side, time, vibration, effects)
    else:
        impulse = bounce(disc, disc_id, nx, ny, side, time, effects)
    if flow is not None:
        record_hit(flow, disc, side, (nx, ny), (abs(ny), abs(nx)), impulse)


@inline
def cross_side(disc, disc_id, side, shear, effects):
    """Move a disc that has reached a sheared side to the opposite side; this does not start a new contact duration."""
    vx = disc.vx
    rows = cross(disc, side, shear)
    add_energy(effects.wall_energy, side, 0.5 * disc.m * (disc.vx - vx) * (disc.vx + vx))
    enter_opposite_side(disc, disc_id, rows, effects.periodic)
    disc.count += np.uint32(1)


@inline
def face_of(wall, left):
    """Number of the left or the right face of a wall inside the box; a side of the box has a single face."""
    return 2 * wall - FIRST_SEGMENT + (0 if left else 1)


@inline
def resolve_segment(disc, disc_id, segment, time, images, segments, effects):
    """Collide a disc with a wall inside the box at a local time; return the kind of the event."""
    if segments is not None:
        arrive(disc, time, effects.flow, effects.gravity)
        passage = passage_of(effects.permeable, disc_id, segment)
        nx, ny, at_end, tx, ty, left = wall_frame(
            disc, segment, segments, effects.arcs, passage, effects.periodic, images
        )
        impulse, is_absorbed = meet_segment(disc, disc_id, nx, ny, segment, time, effects.absorbing, effects)
        face = face_of(FIRST_SEGMENT + segment, left > 0.0)
        record_hit(effects.flow, disc, face, (-left * ty, left * tx), (tx, ty), impulse)
        if is_absorbed:
            return ESCAPED
        if segments[U(segment)].radius > 0.0:
            return FIXED_DISC
        return WALL_END if at_end else WALL
    return WALL


@inline
def resolve_piston(disc, disc_id, k, time, piston, effects):
    """Collide a disc with piston k at a local time; return the wall number of the piston."""
    if piston is not None:
        p = piston[U(k)]
        arrive(disc, time, effects.flow, effects.gravity)
        advance_piston(p, time)
        energy = energy_of(disc, disc_id, effects.rotation)
        loss = energy_at_piston(disc, energy, p)
        nx, ny = normal_of_piston(disc, p)
        vx = disc.vx
        vy = disc.vy
        collide_with_piston(disc, disc_id, p, effects.restitution)
        after = energy_of(disc, disc_id, effects.rotation)
        loss -= energy_at_piston(disc, after, p)
        record_wall_energy(p.wall, after - energy, loss, effects.wall_energy, effects.dissipated, effects.thermal)
        finish(disc, disc_id, time, effects.restitution, effects.periodic)
        impulse = disc.m * (disc.vx - vx), disc.m * (disc.vy - vy)
        face = np.int64(p.wall)
        if p.outward == 0.0:
            face = face_of(face, nx + ny < 0.0)
        record_hit(effects.flow, disc, face, (nx, ny), (abs(ny), abs(nx)), impulse)
        return p.wall
    return 0


@inline
def resolve_stop(k, time, piston):
    """Reverse the velocity of piston k, which reaches a side of the box at a local time."""
    if piston is not None:
        p = piston[U(k)]
        advance_piston(p, time)
        p.v = -p.v
        p.count += np.uint32(1)


@inline
def resolve_thermostat_collision(disc, disc_id, time, thermostat, effects):
    """Give a disc a new velocity from the heat bath at a local time; this does not start a new contact duration."""
    if thermostat is not None:
        arrive(disc, time, effects.flow, effects.gravity)
        energy = energy_of(disc, disc_id, effects.rotation)
        andersen_collision(disc, disc_id, thermostat, effects.rotation)
        add_flow(disc, effects.shear)
        add_energy(effects.bath_energy, 0, energy_of(disc, disc_id, effects.rotation) - energy)
        wrap(disc, disc_id, effects.periodic)
        disc.count += np.uint32(1)

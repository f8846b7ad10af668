"""What an event does to the records: both discs, or disc and wall, are brought to its time, collide, and are noted."""

import numpy as np

from idealgas._jit import inline
from idealgas.physics.box_side import inward_normal
from idealgas.physics.disc_disc import collide
from idealgas.physics.motion import advance
from idealgas.physics.periodic import wrap
from idealgas.physics.piston import advance_piston, collide_with_piston
from idealgas.physics.restitution import record_collision
from idealgas.physics.wall import segment_normal
from idealgas.physics.wall_collision import collide_with_wall
from idealgas.sides import FIRST_SEGMENT

U = np.uintp


@inline
def energy_of(disc, own, rotation):
    """Kinetic energy of a disc."""
    energy = 0.5 * disc.m * (disc.vx * disc.vx + disc.vy * disc.vy)
    if rotation is not None:
        energy += 0.5 * rotation.inertia[U(own)] * rotation.omega[U(own)] ** 2
    return energy


@inline
def record_wall_energy(wall_energy, wall, energy):
    """Add to the energy that a wall gave."""
    if wall_energy is not None:
        wall_energy[U(wall)] += energy


@inline
def finish(disc, own, time, effects):
    """What follows every change of a record."""
    wrap(disc, own, effects.periodic)
    record_collision(effects.restitution, own, time)
    disc.count += np.uint32(1)


@inline
def resolve_pair(a, b, a_id, b_id, time, images, effects):
    """Two discs meet; images: box lengths between their records."""
    advance(a, time, effects.gravity)
    advance(b, time, effects.gravity)
    collide(a, b, a_id, b_id, effects.restitution, effects.rotation, effects.periodic, images)
    finish(a, a_id, time, effects)
    finish(b, b_id, time, effects)


@inline
def bounce(disc, own, nx, ny, wall, time, effects):
    """A disc that stands at the contact meets a wall at rest with unit normal (nx, ny)."""
    before = energy_of(disc, own, effects.rotation)
    collide_with_wall(disc, own, nx, ny, wall, effects.restitution, effects.rotation, effects.thermal)
    record_wall_energy(effects.wall_energy, wall, energy_of(disc, own, effects.rotation) - before)
    finish(disc, own, time, effects)


@inline
def resolve_side(disc, own, side, time, effects):
    """A disc meets a side of the box."""
    advance(disc, time, effects.gravity)
    nx, ny = inward_normal(side)
    bounce(disc, own, nx, ny, side, time, effects)


@inline
def resolve_segment(disc, own, segment, time, images, segments, effects):
    """A disc meets a wall segment, `images` box lengths away from its record; returns whether it met an end."""
    if segments is not None:
        advance(disc, time, effects.gravity)
        nx, ny, at_end = segment_normal(disc, segments[U(segment)], effects.periodic, images)
        bounce(disc, own, nx, ny, FIRST_SEGMENT + segment, time, effects)
        return at_end
    return False


@inline
def resolve_piston(disc, own, time, piston, effects):
    """A disc meets the piston."""
    if piston is not None:
        p = piston[0]
        advance(disc, time, effects.gravity)
        advance_piston(p, time)
        before = energy_of(disc, own, effects.rotation)
        collide_with_piston(disc, own, p, effects.restitution)
        record_wall_energy(effects.wall_energy, p.side, energy_of(disc, own, effects.rotation) - before)
        finish(disc, own, time, effects)


@inline
def resolve_stop(time, piston):
    """The piston meets its end stop and turns back."""
    if piston is not None:
        p = piston[0]
        advance_piston(p, time)
        p.v = -p.v
        p.count += np.uint32(1)

"""A vibrating side of the box: it moves on parabolas between the side and twice the amplitude inside the box.

Its acceleration has one size and changes sign at the mean height, so that contact times are those of a fall. The motion
is nearly harmonic: its Fourier amplitudes are 32 A/(π n)³ for odd n, 1.03 A and 0.04 A. At time 0 it rests at the side.
"""

import math

import numpy as np

from idealgas.jit import inline
from idealgas.physics.disc_wall import side_contact
from idealgas.physics.gravity import acceleration_along
from idealgas.physics.motion import NEVER, position_after, stays_above, time_to_plane, velocity_after

VIBRATION = np.dtype(
    [
        ("amplitude", "f8"),  # length; 0 for a side at rest
        ("acceleration", "f8"),  # its size, length/time²
        ("half", "f8"),  # half a period, time
        ("start", "f8"),  # local time, at most 0, at which the side was at its lowest
    ],
    align=True,
)  # fmt: skip

MOST_PARABOLAS = 64
"""Parabolas of a side, within whose reach a disc stays, after which it only grazes the side at its highest."""

U = np.uintp


def begin_epoch(vibration: np.recarray, time: float, _: float) -> None:
    """Let local times count from a time of the run; the phase is exact."""
    for side in vibration:
        if side.amplitude > 0.0:
            side.start = -math.fmod(time, 2.0 * side.half)


@inline
def parabola_at(side, time):
    """Number of the parabola on which a side is at a local time: even ones are about its lowest place."""
    return np.floor((time - side.start) / side.half + 0.5)


@inline
def height_on(side, parabola, time):
    """Height (length) of a side on a parabola at a local time, its velocity (length/time) and acceleration."""
    since = time - side.start - parabola * side.half
    if parabola % 2.0 == 0.0:
        return 0.5 * side.acceleration * since * since, side.acceleration * since, side.acceleration
    height = 2.0 * side.amplitude - 0.5 * side.acceleration * since * since
    return height, -side.acceleration * since, -side.acceleration


@inline
def edge_motion(disc, number, length, gravity):
    """Height (length) of a disc's edge over a side at its lowest, its velocity into the box and its acceleration."""
    pull = acceleration_along(gravity, number >= 2)
    position, velocity = (disc.x, disc.vx) if number < 2 else (disc.y, disc.vy)
    if number & 1:
        return length - disc.r - position, -velocity, -pull
    return position - disc.r, velocity, pull


@inline
def misses_side_until(disc, side, number, length, gravity, limit):
    """Whether a disc surely does not touch a vibrating side up to a local time; quicker than `vibrating_contact`.

    It is asked for a time a little after the limit, so that rounding does not matter.
    """
    height, velocity, pull = edge_motion(disc, number, length, gravity)
    return stays_above(height - 2.0 * side.amplitude, velocity, pull, limit * (1.0 + 1e-9) - disc.t)


@inline
def vibrating_contact(disc, side, number, length, gravity):
    """Local time at which a disc touches a vibrating side; NEVER if it does not.

    number: of the side, 0 to 3. length: distance of the opposite side.
    """
    height, velocity, pull = edge_motion(disc, number, length, gravity)
    time = disc.t
    parabola = parabola_at(side, time)
    for _ in range(MOST_PARABOLAS):
        above = position_after(height, velocity, pull, time - disc.t)
        upwards = velocity_after(velocity, pull, time - disc.t)
        if above > 2.0 * side.amplitude:
            delay = time_to_plane(above - 2.0 * side.amplitude, upwards, pull)
            if delay >= NEVER:
                return NEVER
            time += delay
            parabola = max(parabola, parabola_at(side, time))
            above = position_after(height, velocity, pull, time - disc.t)
            upwards = velocity_after(velocity, pull, time - disc.t)
        wall, speed, acceleration = height_on(side, parabola, time)
        delay = time_to_plane(above - wall, upwards - speed, pull - acceleration)
        end = side.start + (parabola + 0.5) * side.half
        if time + delay <= end:
            return time + delay
        parabola += 1.0
        time = max(end, time)
    return NEVER


@inline
def side_velocity(vibration, side, time):
    """Velocity of a side into the box at a local time, length/time; 0 for a side at rest."""
    if vibration is not None:
        own = vibration[U(side)]
        if own.amplitude > 0.0:
            return height_on(own, parabola_at(own, time), time)[1]
    return 0.0


@inline
def is_vibrating(vibration, side):
    """Whether a side of the box vibrates."""
    if vibration is not None:
        return vibration[U(side)].amplitude > 0.0
    return False


@inline
def contact_with_side(disc, side, length, gravity, vibration):
    """Local time at which a disc touches a side of the box, at rest or vibrating; NEVER if it does not."""
    if vibration is not None:
        own = vibration[U(side)]
        if own.amplitude > 0.0:
            return vibrating_contact(disc, own, side, length, gravity)
    return side_contact(disc, side, length, gravity)

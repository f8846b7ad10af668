"""A vibrating side of the box: its height inside the box follows parabolas between 0 and twice the amplitude A.

The acceleration has a constant magnitude and changes sign at the mean height, so contact times can be computed as for
free fall. The motion is nearly harmonic: its Fourier amplitudes are 32 A/(π n)³ for odd n, that is, 1.03 A, 0.04 A, …
At time 0 the side is at rest at its lowest point, height 0.
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
        ("acceleration", "f8"),  # magnitude of the acceleration, length/time²
        ("half", "f8"),  # half a period, time
        ("start", "f8"),  # local time, at most 0, at which the side was at its lowest point
    ],
    align=True,
)  # fmt: skip

MOST_PARABOLAS = 64
"""Number of parabolas after which a disc still within reach of the side only grazes the highest point of the side."""

U = np.uintp


def begin_epoch(vibration: np.recarray, time: float, _: float) -> None:
    """Measure local times from a given time in the run; its phase is computed without rounding error."""
    for side in vibration:
        if side.amplitude > 0.0:
            side.start = -math.fmod(time, 2.0 * side.half)


@inline
def parabola_at(side, time):
    """Index of the parabola that a side follows at a local time; even indices are parabolas around the lowest point."""
    return np.floor((time - side.start) / side.half + 0.5)


@inline
def height_on(side, parabola, time):
    """Height, velocity and acceleration of a side that follows the given parabola, at a local time.

    Returns (length, length/time, length/time²). parabola: index of the parabola.
    """
    since = time - side.start - parabola * side.half
    if parabola % 2.0 == 0.0:
        return 0.5 * side.acceleration * since * since, side.acceleration * since, side.acceleration
    height = 2.0 * side.amplitude - 0.5 * side.acceleration * since * since
    return height, -side.acceleration * since, -side.acceleration


@inline
def edge_motion(disc, number, length, gravity):
    """Height of a disc's edge above a side's lowest point, and the disc's velocity and acceleration into the box.

    number: number of the side, 0 to 3. length: distance to the opposite side, length. The results are in units of
    length, length/time and length/time².
    """
    pull = acceleration_along(gravity, number >= 2)
    position, velocity = (disc.x, disc.vx) if number < 2 else (disc.y, disc.vy)
    if number & 1:
        return length - disc.r - position, -velocity, -pull
    return position - disc.r, velocity, pull


@inline
def misses_side_until(disc, side, number, length, gravity, limit):
    """Whether it is certain that a disc does not touch a vibrating side up to a local time `limit`.

    This test is faster than `vibrating_contact`. It extends slightly beyond the limit, so that rounding does not
    matter.
    """
    height, velocity, pull = edge_motion(disc, number, length, gravity)
    return stays_above(height - 2.0 * side.amplitude, velocity, pull, limit * (1.0 + 1e-9) - disc.t)


@inline
def vibrating_contact(disc, side, number, length, gravity):
    """Local time at which a disc touches a vibrating side; NEVER if it does not.

    number: number of the side, 0 to 3. length: distance to the opposite side, length.
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
        motion = vibration[U(side)]
        if motion.amplitude > 0.0:
            return height_on(motion, parabola_at(motion, time), time)[1]
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
        motion = vibration[U(side)]
        if motion.amplitude > 0.0:
            return vibrating_contact(disc, motion, side, length, gravity)
    return side_contact(disc, side, length, gravity)

"""A vibrating side of the box: its height inside the box changes periodically between 0 and twice the amplitude A.

At time 0 the side is at rest at its lowest point, height 0. It follows parabolas or a sine:

- Parabolas: the acceleration has a constant magnitude and changes sign at the mean height, so contact times can be
  computed as for free fall. The motion is nearly harmonic: its Fourier amplitudes are 32 A/(π n)³ for odd n, that is,
  1.03 A, 0.04 A, …
- Sine: the height is A (1 - cos ω t), and contact times are computed by Newton's method.

The motion consists of pieces. Even pieces surround the lowest points, odd pieces the highest points. In each piece the
gap between the side and a disc is a parabola or, for a sine, either concave (even pieces) or convex (odd pieces).
"""

import math

import numpy as np

from idealgas.jit import inline, noinline
from idealgas.physics.disc_wall import side_contact
from idealgas.physics.elementary import cos_sin_turns
from idealgas.physics.gravity import acceleration_along
from idealgas.physics.motion import NEVER, position_after, stays_above, time_to_plane, velocity_after

VIBRATION = np.dtype(
    [
        ("amplitude", "f8"),  # length; 0 for a side at rest
        ("acceleration", "f8"),  # largest magnitude of the acceleration, length/time²
        ("half", "f8"),  # half a period, time
        ("start", "f8"),  # local time, at most 0, at which the side was at its lowest point
        ("omega", "f8"),  # angular frequency of a sine, 1/time; 0 for parabolas
    ],
    align=True,
)  # fmt: skip

MOST_PIECES = 64
"""Number of pieces after which a disc still within reach of the side can only graze it at its highest point."""

BISECTIONS = 200  # enough to halve any interval down to neighbouring floats

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
def sine_at(side, time):
    """Height, velocity and acceleration of a side that follows a sine, as in `height_on`.

    With φ = ω t/2 the height is 2A sin² φ, which loses no digits near the lowest point.
    """
    turns = 0.25 * ((time - side.start) / side.half)
    cos, sin = cos_sin_turns(turns - np.floor(turns))
    height, speed = 2.0 * side.amplitude * sin * sin, 2.0 * side.amplitude * side.omega * (sin * cos)
    return height, speed, side.acceleration * (cos * cos - sin * sin)


@inline
def motion_at(side, time):
    """Height, velocity and acceleration of a vibrating side, directed into the box, at a local time.

    Returns (length, length/time, length/time²).
    """
    if side.omega > 0.0:
        return sine_at(side, time)
    return height_on(side, parabola_at(side, time), time)


@inline
def concave_share(side, pull):
    """Half the length of an even piece, in half periods, for a disc with an acceleration into the box; ½ for parabolas.

    The gap to a sine is concave where cos ω t > pull/(A ω²). Hastings' arccosine (Abramowitz & Stegun 4.4.46) has an
    error δ below 3e-8, and a piece that is not concave in its last δ deviates from a concave one by less than A δ³.
    """
    if side.omega == 0.0:
        return 0.5
    x = min(abs(pull) / side.acceleration, 1.0)
    series = ((-0.0012624911 * x + 0.0066700901) * x - 0.0170881256) * x + 0.0308918810
    series = (((series * x - 0.0501743046) * x + 0.0889789874) * x - 0.2145988016) * x + 1.5707963050
    share = math.sqrt(1.0 - x) * series / math.pi
    return 1.0 - share if pull < 0.0 else share


@inline
def piece_at(side, time, share):
    """Index of the piece of a side's motion at a local time; share: see `concave_share`."""
    if side.omega == 0.0:
        return parabola_at(side, time)
    since = (time - side.start) / side.half
    even = 2.0 * np.floor(0.5 * (since + share))
    return even if since - even < share else even + 1.0


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
def gap_at(side, edge, time):
    """Gap between a disc and a side that follows a sine, and its rate of change, at a local time.

    edge: local time, and the results of `edge_motion` at this time.
    """
    since, height, velocity, pull = edge
    wall, speed, _ = sine_at(side, time)
    above = position_after(height, velocity, pull, time - since)
    return above - wall, velocity_after(velocity, pull, time - since) - speed


@noinline
def sine_contact(side, edge, time, end, is_convex):
    """First local time, from `time` to `end`, at which a disc touches a side that follows a sine; NEVER if none.

    edge: see `gap_at`. The gap g is convex or concave between these times. Newton's method approaches the falling zero
    of g from one side, without passing it, if it begins where g has the sign of its curvature:

        g                              g
        │╲ from the start              │  ╱─╲
        │ ╲                            │ ╱   ╲
        ┼──●─────╱──→ t                ┼╱─────●───→ t
        │   ╲__╱                       │       ╲ from the end

    A convex gap that rises has no falling zero. A concave gap has none if it is positive at the end. A gap that is
    negative because of rounding and rises is treated as in `time_to_plane`.
    """
    gap, slope = gap_at(side, edge, time)
    if slope < 0.0 and gap <= 0.0:
        return time
    if is_convex:
        while slope < 0.0:
            later = time - gap / slope
            if gap <= 0.0 or later <= time:
                return time
            if later >= end:
                return NEVER
            time = later
            gap, slope = gap_at(side, edge, time)
        return NEVER
    first, time, last = time, end, end
    gap, slope = gap_at(side, edge, time)
    if gap > 0.0 or slope >= 0.0:
        return NEVER
    while slope < 0.0:
        earlier = max(time - gap / slope, first)
        if gap > 0.0 or earlier >= time:
            return time
        time, last = earlier, time
        gap, slope = gap_at(side, edge, time)
    for _ in range(BISECTIONS):  # the gap does not rise to zero, and the contact is where it begins to fall
        middle = 0.5 * (time + last)
        if middle <= time or middle >= last:
            break
        if gap_at(side, edge, middle)[1] < 0.0:
            last = middle
        else:
            time = middle
    return last


@inline
def vibrating_contact(disc, side, number, length, gravity):
    """Local time at which a disc touches a vibrating side; NEVER if it does not.

    number: number of the side, 0 to 3. length: distance to the opposite side, length.
    """
    height, velocity, pull = edge_motion(disc, number, length, gravity)
    time = disc.t
    share = concave_share(side, pull)
    piece = piece_at(side, time, share)
    for _ in range(MOST_PIECES):
        above = position_after(height, velocity, pull, time - disc.t)
        upwards = velocity_after(velocity, pull, time - disc.t)
        if above > 2.0 * side.amplitude:
            delay = time_to_plane(above - 2.0 * side.amplitude, upwards, pull)
            if delay >= NEVER:
                return NEVER
            time += delay
            piece = max(piece, piece_at(side, time, share))
            above = position_after(height, velocity, pull, time - disc.t)
            upwards = velocity_after(velocity, pull, time - disc.t)
        is_odd = piece % 2.0 != 0.0
        end = side.start + (piece + (1.0 - share if is_odd else share)) * side.half
        if side.omega > 0.0:
            contact = sine_contact(side, (disc.t, height, velocity, pull), time, max(end, time), is_odd)
        else:
            wall, speed, acceleration = height_on(side, piece, time)
            contact = time + time_to_plane(above - wall, upwards - speed, pull - acceleration)
        if contact <= end:
            return contact
        piece += 1.0
        time = max(end, time)
    return NEVER


@inline
def side_velocity(vibration, side, time):
    """Velocity of a side into the box at a local time, length/time; 0 for a side at rest."""
    if vibration is not None:
        motion = vibration[U(side)]
        if motion.amplitude > 0.0:
            return motion_at(motion, time)[1]
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

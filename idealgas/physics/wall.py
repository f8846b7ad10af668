"""Contact of a disc with a straight wall segment: with its body or with one of its two end points.

A fixed disc is a segment of length 0 whose end points have a radius.

The motion (d, s, vn, vt, an, at) of a disc is given in coordinates of the segment: d and s are the normal and
tangential components of the position (length) of its centre relative to the start point, vn and vt those of its
velocity (length/time), an and at those of its acceleration (length/time²):

           ○ disc
           │
           │ d
    ●──────┴──────●        the foot of the perpendicular is on the body if 0 < s < length
    start  s      end
"""

import math

import numpy as np

from idealgas.jit import inline
from idealgas.physics.disc_disc import collision_delay, collision_discriminant
from idealgas.physics.disc_wall import reflected_velocity
from idealgas.physics.motion import NEVER, position_after, velocity_after
from idealgas.physics.periodic import shift_by_images
from idealgas.physics.permeable import (
    SOLID,
    closed_face_delay,
    closed_side,
    nearest_end,
    touches_face,
)
from idealgas.physics.polynomial import first_contact_root, parabola

SEGMENT = np.dtype(
    [
        ("x", "f8"), ("y", "f8"),  # start point, length
        ("tx", "f8"), ("ty", "f8"),  # unit tangent
        ("length", "f8"),  # distance between the two end points, length
        ("radius", "f8"),  # radius of the end points, length: the radius of a fixed disc, otherwise 0
        ("active", "?"),  # whether the segment is present in this epoch
    ],
    align=True,
)  # fmt: skip


@inline
def foot_inside(s, length):
    """Whether the foot of the perpendicular from a disc to a segment lies strictly between the ends of the segment.

    s: distance of the foot from the start, length. length: length of the segment.
    """
    return (s > 0.0) & (s < length)


@inline
def straight_body_delay(d, s, v_normal, v_tangent, r, length):
    """Time until a disc of radius r in straight flight touches a segment's body; NEVER if it does not.

    d, s: normal and tangential position, length. v_normal, v_tangent: velocity, length/time.
    """
    towards = -v_normal if d > 0.0 else v_normal
    if towards <= 0.0:
        return NEVER
    delay = max(abs(d) - r, 0.0) / towards
    return delay if foot_inside(s + v_tangent * delay, length) else NEVER


@inline
def accelerated_body_delay(motion, r, length):
    """Time until a disc of radius r on a parabola touches a segment's body; NEVER if it does not.

    The contact is the earliest approach to either face with the foot of the perpendicular on the body. If a gate has
    closed on a disc and gravity keeps the disc from leaving the gate, the disc bounces at its current depth.
    """
    d, s, vn, vt, an, at = motion
    best = NEVER
    for face in range(2):
        sign = 1.0 if face == 0 else -1.0
        height = sign * d - r
        speed = sign * vn
        pull = sign * an
        discriminant = speed * speed - 2.0 * pull * height
        root = math.sqrt(discriminant) if discriminant >= 0.0 else abs(speed)
        if height > 0.0:
            if speed < 0.0 and discriminant >= 0.0:
                delay = 2.0 * height / (root - speed)
            elif speed >= 0.0 and pull < 0.0:
                delay = (speed + root) / -pull
            else:
                delay = NEVER
        elif sign * d > 0.0:  # the disc touches this face, or overlaps it because of rounding
            if speed < 0.0:
                delay = 0.0 if foot_inside(s, length) else NEVER
            elif pull < 0.0:
                delay = (speed + root) / -pull
            else:
                delay = NEVER
        else:  # on the other side: the disc may pass an end and touch this face when it falls back
            delay = (speed + root) / -pull if speed > 0.0 and pull < 0.0 and discriminant >= 0.0 else NEVER
        if delay < best and foot_inside(position_after(s, vt, at, delay), length):
            best = delay
    return best


@inline
def straight_end_delay(x, y, disc, reach):
    """Time until a disc in straight flight is within `reach` of an end of a segment; NEVER if it never is.

    x, y: position of the disc relative to the end, length. reach: length.
    """
    meets, delay = collision_delay(x, y, disc.vx, disc.vy, reach)
    return delay if meets else NEVER


@inline
def moves_off(delay, far, motion, length):
    """Whether a disc that touches an end after `delay` moves away from the segment's nearest point.

    The nearest point may be on the body or at the other end. far: whether the end is at distance `length` from the
    start. This happens only if a gate has closed on the disc, which then reaches the end from within the wall.
    """
    d, s, vn, vt, an, at = motion
    foot = parabola(s, vt, at, delay)
    height = parabola(d, vn, an, delay)
    speed = velocity_after(vn, an, delay)
    along = velocity_after(vt, at, delay)
    if foot_inside(foot, length):
        return (speed >= 0.0) if height > 0.0 else (speed <= 0.0)
    if far:
        return (foot <= 0.0) & (foot * along + height * speed >= 0.0)
    return (foot >= length) & ((foot - length) * along + height * speed >= 0.0)


@inline
def point_delay(x, y, disc, reach, gravity, after):
    """Time until a disc, at (x, y) from a point, is within `reach` (length) of the point; NEVER if it never is.

    after: on a parabola, only an approach that begins after this time counts.
    """
    if gravity is not None:
        return first_contact_root(x, y, disc, gravity, reach, after)
    return straight_end_delay(x, y, disc, reach)


@inline
def end_delay(x, y, far, motion, length, disc, reach, gravity):
    """Time until a disc, at (x, y) from an end of a segment, touches that end; NEVER if it does not.

    far: whether the end is at distance `length` from the start. reach: distance from the end at which the disc touches
    it, length.
    """
    delay = -1.0
    for _ in range(2):  # on a parabola a disc approaches a point at most twice
        delay = point_delay(x, y, disc, reach, gravity, delay)
        if delay == NEVER or not moves_off(delay, far, motion, length):
            return delay
    return NEVER


@inline
def segment_normal(disc, segment, passage, periodic, images):
    """Unit normal (x, y) towards a disc that touches a segment, and whether the disc touches an end."""
    tx = segment.tx
    ty = segment.ty
    x, y = shift_by_images(disc.x - segment.x, disc.y - segment.y, periodic, images)
    s = tx * x + ty * y
    if passage is not None and passage != SOLID:
        side = closed_side(passage)
        end_x, end_y, distance = nearest_end(x, y, s, segment.length, tx, ty)
        if foot_inside(s, segment.length) and touches_face(side * (tx * y - ty * x), distance, disc.r):
            return -side * ty, side * tx, False
        return end_x / distance, end_y / distance, True
    if foot_inside(s, segment.length):
        return (-ty, tx, False) if tx * y - ty * x > 0.0 else (ty, -tx, False)
    if s > 0.0:
        x -= segment.length * tx
        y -= segment.length * ty
    distance = math.sqrt(x * x + y * y)
    return x / distance, y / distance, True


@inline
def reflection_changes(disc, disc_id, nx, ny, restitution):
    """Whether a reflection would change any digit of a disc's velocity; if not, the disc counts as reflected."""
    vx, vy = reflected_velocity(disc, disc_id, nx, ny, restitution)
    return (vx != disc.vx) | (vy != disc.vy)


@inline
def misses_segment(disc, segment, gravity, periodic, images):
    """Whether it is certain that a disc does not touch a segment, because it misses a circle around the segment.

    This test is faster than `segment_contact`, whose arguments have the same meaning. The circle is slightly enlarged,
    so that rounding does not matter. With gravity the path is not a straight line, and the result is always False.
    """
    if gravity is not None:
        return False
    half = 0.5 * segment.length
    reach = half + disc.r + segment.radius
    x, y = shift_by_images(disc.x - segment.x, disc.y - segment.y, periodic, images)
    meets, _, gap, _ = collision_discriminant(
        x - half * segment.tx, y - half * segment.ty, disc.vx, disc.vy, reach * (1.0 + 1e-6)
    )
    return (gap > 0.0) & (not meets)


@inline
def solid_delay(x, y, motion, disc, segment, gravity):
    """Time until a disc touches the body or an end of a solid segment; NEVER if it does not."""
    length = segment.length
    if gravity is not None:
        delay = accelerated_body_delay(motion, disc.r, length)
    else:
        d, s, vn, vt, _, _ = motion
        delay = straight_body_delay(d, s, vn, vt, disc.r, length)
    for far in range(2):
        end_x, end_y = x - far * length * segment.tx, y - far * length * segment.ty
        reach = disc.r + segment.radius
        delay = min(delay, end_delay(end_x, end_y, far, motion, length, disc, reach, gravity))
    return delay


@inline
def one_way_delay(x, y, motion, disc, segment, passage, gravity):
    """Time until a disc touches the closed face or an end of a one-way segment; NEVER if it does not."""
    side, length = closed_side(passage), segment.length
    d, s, vn, vt, an, at = motion
    delay = closed_face_delay(side * d, side * vn, side * an, disc.r)
    if delay < NEVER and not foot_inside(parabola(s, vt, at, delay), length):
        delay = NEVER
    for far in range(2):
        end_x, end_y = x - far * length * segment.tx, y - far * length * segment.ty
        delay = min(delay, point_delay(end_x, end_y, disc, disc.r, gravity, -1.0))
    return delay


@inline
def segment_delay(x, y, motion, disc, segment, passage, gravity):
    """Time until a disc touches a segment that does not let it pass from both sides; NEVER if it does not."""
    if passage is not None and passage != SOLID:
        return one_way_delay(x, y, motion, disc, segment, passage, gravity)
    return solid_delay(x, y, motion, disc, segment, gravity)


@inline
def segment_contact(disc, disc_id, segment, passage, gravity, restitution, periodic, images):
    """Local time at which a disc touches the body or an end of a segment; NEVER if it does not.

    passage: sides from which the segment lets the disc pass, see `permeable`; None if no wall is permeable.

    A touching disc whose reflection would not change any digit of its velocity counts as already reflected, unless
    gravity presses it against the wall.
    """
    tx = segment.tx
    ty = segment.ty
    x, y = shift_by_images(disc.x - segment.x, disc.y - segment.y, periodic, images)
    d = tx * y - ty * x
    s = tx * x + ty * y
    vn = tx * disc.vy - ty * disc.vx
    vt = tx * disc.vx + ty * disc.vy
    an = at = 0.0
    if gravity is not None:
        an = tx * gravity.y - ty * gravity.x
        at = tx * gravity.x + ty * gravity.y
    motion = d, s, vn, vt, an, at
    delay = segment_delay(x, y, motion, disc, segment, passage, gravity)
    if gravity is None and delay == 0.0:
        nx, ny, _ = segment_normal(disc, segment, passage, periodic, images)
        if not reflection_changes(disc, disc_id, nx, ny, restitution):
            return NEVER
    return disc.t + delay if delay < NEVER else NEVER

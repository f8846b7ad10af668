"""A disc and a straight wall segment with two solid ends."""

import math

import numpy as np

from idealgas._jit import inline
from idealgas.physics.constants import NEVER
from idealgas.physics.disc_disc import touch
from idealgas.physics.motion import position_after, velocity_after
from idealgas.physics.periodic import shift_by_images
from idealgas.physics.polynomial import first_descent, parabola
from idealgas.physics.wall_collision import reflection_factor

SEGMENT = np.dtype(
    [
        ("x", "f8"), ("y", "f8"),  # start point
        ("tx", "f8"), ("ty", "f8"),  # unit tangent
        ("length", "f8"),
        ("opens", "f8"), ("closes", "f8"),  # from when to when a gate is not there; infinite for a wall
        ("active", "?"),  # whether it is there in this epoch
    ],
    align=True,
)  # fmt: skip


def begin_epoch(segments: np.recarray, time: float) -> None:
    """Set the gates as they are from a time on."""
    segments.active[:] = ~((segments.opens <= time) & (time < segments.closes))


def next_change(segments: np.recarray, time: float) -> float:
    """When a gate next opens or closes after a time; infinite if none does."""
    switches = np.concatenate((segments.opens, segments.closes))
    return float(switches[switches > time].min(initial=math.inf))


@inline
def foot_inside(s, length):
    """Whether a foot point at arc length s lies strictly between the ends."""
    return (s > 0.0) & (s < length)


@inline
def straight_body_delay(d, s, v_normal, v_tangent, r, length):
    """Delay until a disc in straight flight meets the body: d, s are its normal and tangential coordinates."""
    towards = -v_normal if d > 0.0 else v_normal
    if towards <= 0.0:
        return NEVER
    delay = max(abs(d) - r, 0.0) / towards
    return delay if foot_inside(s + v_tangent * delay, length) else NEVER


@inline
def accelerated_body_delay(d, s, vn, vt, an, at, r, length):
    """The same on a parabola: the earliest approach to either face with the foot inside.

    A disc that a gate closed over, and that cannot rise out of it, bounces as deep in it as it is.
    """
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
        elif sign * d > 0.0:  # touching this face, or sunk into it by rounding
            if speed < 0.0:
                delay = 0.0 if foot_inside(s, length) else NEVER
            elif pull < 0.0:
                delay = (speed + root) / -pull
            else:
                delay = NEVER
        else:  # on the other side: may come round an end and meet this face on its way back
            delay = (speed + root) / -pull if speed > 0.0 and pull < 0.0 and discriminant >= 0.0 else NEVER
        if delay < best and foot_inside(position_after(s, vt, at, delay), length):
            best = delay
    return best


@inline
def straight_end_delay(x, y, disc):
    """Delay until a disc in straight flight, at (x, y) from an end of the wall, meets it."""
    meets, delay = touch(x, y, disc.vx, disc.vy, disc.r)
    return delay if meets else NEVER


@inline
def moves_off(delay, far, d, s, vn, vt, an, at, length):
    """Whether a disc that comes to an end then moves away from where the segment is nearest, its body or other end.

    Only a disc that a gate closed over comes to an end from within.
    """
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
def end_delay(x, y, far, d, s, vn, vt, an, at, length, disc, gravity):
    """Delay until a disc, at (x, y) from an end of the wall, meets it; d, s, vn, vt, an, at: normal and tangential."""
    delay = -1.0
    for _ in range(2):  # a parabola comes down to a point at most twice
        if gravity is not None:
            delay = first_descent(x, y, disc.vx, disc.vy, gravity.x, gravity.y, disc.r, delay)
        else:
            delay = straight_end_delay(x, y, disc)
        if delay == NEVER or not moves_off(delay, far, d, s, vn, vt, an, at, length):
            return delay
    return NEVER


@inline
def segment_normal(disc, segment, periodic, images):
    """Unit normal towards a disc that touches a segment, and whether it touches an end."""
    tx = segment.tx
    ty = segment.ty
    x, y = shift_by_images(disc.x - segment.x, disc.y - segment.y, periodic, images)
    s = tx * x + ty * y
    if foot_inside(s, segment.length):
        return (-ty, tx, False) if tx * y - ty * x > 0.0 else (ty, -tx, False)
    if s > 0.0:
        x -= segment.length * tx
        y -= segment.length * ty
    distance = math.sqrt(x * x + y * y)
    return x / distance, y / distance, True


@inline
def reflection_changes(disc, own, nx, ny, restitution):
    """Whether a reflection would change any digit; if not, it counts as done."""
    k = reflection_factor(disc, own, nx, ny, restitution)
    return (disc.vx - k * nx != disc.vx) | (disc.vy - k * ny != disc.vy)


@inline
def segment_contact(disc, own, segment, gravity, restitution, periodic, images):
    """Time at which a disc meets a segment, body or end; NEVER if it does not.

    images: box lengths between record and segment, where sides are periodic.
    A touching disc whose reflection would not change a digit of its velocity is done, unless gravity presses it on.
    """
    tx = segment.tx
    ty = segment.ty
    length = segment.length
    x, y = shift_by_images(disc.x - segment.x, disc.y - segment.y, periodic, images)
    d = tx * y - ty * x
    s = tx * x + ty * y
    vn = tx * disc.vy - ty * disc.vx
    vt = tx * disc.vx + ty * disc.vy
    an = at = 0.0
    if gravity is not None:
        an = tx * gravity.y - ty * gravity.x
        at = tx * gravity.x + ty * gravity.y
        delay = accelerated_body_delay(d, s, vn, vt, an, at, disc.r, length)
    else:
        delay = straight_body_delay(d, s, vn, vt, disc.r, length)
    for far in range(2):
        end_x, end_y = x - far * length * tx, y - far * length * ty
        delay = min(delay, end_delay(end_x, end_y, far, d, s, vn, vt, an, at, length, disc, gravity))
    if gravity is None and delay == 0.0:
        nx, ny, _ = segment_normal(disc, segment, periodic, images)
        if not reflection_changes(disc, own, nx, ny, restitution):
            return NEVER
    return disc.t + delay if delay < NEVER else NEVER

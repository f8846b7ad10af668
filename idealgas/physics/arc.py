"""Contact of a disc with the outer face, the inner face or an end of an arc of a circle.

An arc is stored as a wall segment, which is its chord, and an ARC record. Unless stated otherwise, x and y are the
position of the disc relative to the centre of the arc, length. A whole circle has no ends.
"""

import math

import numpy as np

from idealgas.jit import inline, noinline
from idealgas.physics.arc_geometry import CIRCLE
from idealgas.physics.disc_disc import collision_delay
from idealgas.physics.motion import NEVER, velocity_after
from idealgas.physics.periodic import shift_by_images
from idealgas.physics.permeable import OPEN
from idealgas.physics.polynomial import first_contact_root, first_exit_root, parabola
from idealgas.physics.wall import misses_segment, reflection_changes, segment_contact, segment_normal

ARC = np.dtype(
    [
        ("x", "f8"), ("y", "f8"),  # centre relative to the start of the segment, length
        ("radius", "f8"),  # length; 0 for a straight wall
        ("mx", "f8"), ("my", "f8"),  # unit vector from the centre to the middle of the arc
        ("cosine", "f8"),  # cosine of the angle from the middle of the arc to an end; CIRCLE for a circle
        ("turn", "f8"),  # 1 if the arc runs counterclockwise from its start to its end, otherwise -1
    ],
    align=True,
)  # fmt: skip

GLIDE = 2.0**-26
"""Shortest flight along the inner face of an arc, in units of the arc's radius.

The distance between a shorter chord and the arc is below the rounding error.
"""

U = np.uintp


@inline
def faces_arc(x, y, distance, arc):
    """Whether the point nearest to (x, y) on the whole circle lies on the arc.

    distance: distance between (x, y) and the centre, length.
    """
    return x * arc.mx + y * arc.my > distance * arc.cosine


@inline
def toggles(x, y, along_x, along_y, arc):
    """Whether a ray that runs to the right from a point crosses a wall an odd number of times; numbers or arrays.

    x, y: position of the point relative to the wall's start, length. along_x, along_y: position of the wall's end
    relative to its start, length. arc: NO_ARC for a straight wall. For an arc, the result for its chord is inverted in
    the region between the chord and the arc.
    """
    crosses = ((y < 0.0) != (along_y > y)) & ((x * along_y < y * along_x) == (along_y > 0.0))
    away_x, away_y = x - arc.x, y - arc.y
    within = away_x * away_x + away_y * away_y < arc.radius * arc.radius
    return crosses != (within & (away_x * arc.mx + away_y * arc.my > arc.radius * arc.cosine))


@inline
def straight_exit_delay(x, y, vx, vy, reach, inside):
    """Time until a point in straight flight leaves the circle of radius `reach` around the origin, or NEVER.

    x, y, reach: length. vx, vy: length/time. The delay is 0 for a point on or beyond the circle that moves outwards.
    inside: whether a point beyond the circle belongs inside and is outside only because of rounding. If the path of
    such a point misses the circle, the point leaves when it is again as far from the origin as it is now. For a point
    near the circle, the roots are computed without cancellation.
    """
    square = vx * vx + vy * vy
    if square == 0.0:
        return NEVER
    approach = x * vx + y * vy
    gap = x * x + y * y - reach * reach
    cross = vx * y - vy * x
    discriminant = square * (reach * reach) - cross * cross
    if gap <= 0.0:
        discriminant = max(discriminant, approach * approach - square * gap)  # same value, but never below 0
    if approach > 0.0:
        return max(-gap, 0.0) / (math.sqrt(max(discriminant, 0.0)) + approach)
    if discriminant < 0.0:
        if not inside:
            return NEVER
        discriminant = approach * approach
    return max((math.sqrt(discriminant) - approach) / square, GLIDE * reach / math.sqrt(square))


@inline
def crossing_delay(x, y, disc, reach, inner, inside, gravity, after):
    """Time until a disc's centre enters a circle of radius `reach` or, if inner, leaves it; NEVER if it does not.

    x, y: position of the disc relative to the centre of this circle, length. With gravity, only a crossing after the
    time `after` counts.
    """
    if gravity is not None:
        if inner:
            return first_exit_root(x, y, disc, gravity, reach, after)
        return first_contact_root(x, y, disc, gravity, reach, after)
    if inner:
        return straight_exit_delay(x, y, disc.vx, disc.vy, reach, inside)
    meets, delay = collision_delay(x, y, disc.vx, disc.vy, reach)
    return delay if meets else NEVER


@inline
def changes_nothing(x, y, disc, disc_id, restitution):
    """Whether a reflection along (x, y) would leave every digit of a disc's velocity unchanged."""
    distance = math.sqrt(x * x + y * y)
    return not reflection_changes(disc, disc_id, x / distance, y / distance, restitution)


@inline
def face_delay(x, y, disc, disc_id, arc, inner, gravity, restitution):
    """Time until a disc touches the inner or the outer face of an arc; NEVER if it does not.

    A disc touches the face that is on the side of its centre when its centre crosses a circle of radius `reach`:

        centre of
        the arc        inner face ║ outer face
           ●───────────────┼──────║──────┼──────────→ distance of the disc's centre
           0             R - r    R    R + r
                      leaves →         ← enters

    The crossing is a contact if the nearest point of the whole circle lies on the arc. If it does not, the disc may
    still touch the arc at a later crossing. The squared distance is a polynomial in time that crosses reach²
    alternately upwards and downwards. In straight flight its degree is 2, so there is at most one crossing in each
    direction and no later contact. On a parabola its degree is 4, so there are at most two crossings in each direction,
    and the second one must be tried too.

    A touching disc that moves along the outer face counts as already reflected; a touching disc that moves along the
    inner face touches that face again.
    """
    reach = arc.radius - disc.r if inner else arc.radius + disc.r
    if reach <= 0.0:
        return NEVER
    ax = ay = 0.0
    if gravity is not None:
        ax, ay = gravity.x, gravity.y
    inside = x * x + y * y < arc.radius * arc.radius
    delay = -1.0
    for _ in range(2):
        delay = crossing_delay(x, y, disc, reach, inner, inside, gravity, delay)
        if delay == NEVER:
            return NEVER
        then_x, then_y = parabola(x, disc.vx, ax, delay), parabola(y, disc.vy, ay, delay)
        distance = math.sqrt(then_x * then_x + then_y * then_y)
        if (distance < arc.radius) == inner and faces_arc(then_x, then_y, distance, arc):
            if gravity is None and delay == 0.0 and changes_nothing(x, y, disc, disc_id, restitution):
                return GLIDE * reach / math.sqrt(disc.vx * disc.vx + disc.vy * disc.vy) if inner else NEVER
            return delay
        if gravity is None:
            return NEVER
    return NEVER


@inline
def leaves_arc(delay, centre, end, other, disc, ax, ay, arc):
    """Whether, when a disc touches an end, another point of the arc is nearer and the disc moves away from that point.

    delay: time until the disc touches the end. centre, end, other: positions (x, y) of the disc relative to the centre
    of the arc, to this end and to the other end, length. ax, ay: acceleration, length/time².

    This happens only if a gate has closed on the disc:

             ·↗
        ───────────────●

    The centre · of the disc is less than r above the wall and moves away from the wall, but towards the end ●. When the
    centre comes within r of the end, the nearest point of the wall is still the point below the centre. Because the
    disc moves away from that point, it leaves the wall and does not bounce off the end.
    """
    x, y = parabola(centre[0], disc.vx, ax, delay), parabola(centre[1], disc.vy, ay, delay)
    vx, vy = velocity_after(disc.vx, ax, delay), velocity_after(disc.vy, ay, delay)
    distance = math.sqrt(x * x + y * y)
    if faces_arc(x, y, distance, arc):
        outwards = x * vx + y * vy
        return (outwards <= 0.0) if distance < arc.radius else (outwards >= 0.0)
    end_x, end_y = parabola(end[0], disc.vx, ax, delay), parabola(end[1], disc.vy, ay, delay)
    other_x, other_y = parabola(other[0], disc.vx, ax, delay), parabola(other[1], disc.vy, ay, delay)
    nearer = other_x * other_x + other_y * other_y < end_x * end_x + end_y * end_y
    return nearer & (other_x * vx + other_y * vy >= 0.0)


@inline
def arc_end_delay(centre, end, other, disc, disc_id, arc, gravity, restitution):
    """Time until a disc touches an end of an arc; NEVER if it does not.

    The arguments are as in `leaves_arc`. The disc touches the end when its centre comes within r of this point, unless
    the disc is leaving the arc at that moment. A second approach is possible only on a parabola, where it is tried too.
    """
    ax = ay = 0.0
    if gravity is not None:
        ax, ay = gravity.x, gravity.y
    delay = -1.0
    for _ in range(2):
        delay = crossing_delay(end[0], end[1], disc, disc.r, False, False, gravity, delay)
        if delay == NEVER:
            return NEVER
        if not leaves_arc(delay, centre, end, other, disc, ax, ay, arc):
            if gravity is None and delay == 0.0 and changes_nothing(end[0], end[1], disc, disc_id, restitution):
                return NEVER
            return delay
        if gravity is None:
            return NEVER
    return NEVER


@noinline
def arc_contact(disc, disc_id, segment, arc, gravity, restitution, periodic, images):
    """Local time at which a disc touches a face or an end of an arc; NEVER if it does not."""
    start = shift_by_images(disc.x - segment.x, disc.y - segment.y, periodic, images)
    centre = start[0] - arc.x, start[1] - arc.y
    delay = face_delay(centre[0], centre[1], disc, disc_id, arc, True, gravity, restitution)
    delay = min(delay, face_delay(centre[0], centre[1], disc, disc_id, arc, False, gravity, restitution))
    if arc.cosine != CIRCLE:
        end = start[0] - segment.length * segment.tx, start[1] - segment.length * segment.ty
        for far in range(2):
            here, there = (end, start) if far else (start, end)
            delay = min(delay, arc_end_delay(centre, here, there, disc, disc_id, arc, gravity, restitution))
    return disc.t + delay if delay < NEVER else NEVER


@inline
def arc_frame(disc, segment, arc, periodic, images):
    """Return the result of `wall_frame` for an arc."""
    start_x, start_y = shift_by_images(disc.x - segment.x, disc.y - segment.y, periodic, images)
    x, y = start_x - arc.x, start_y - arc.y
    distance = math.sqrt(x * x + y * y)
    inside = distance < arc.radius
    left = 1.0 if inside == (arc.turn > 0.0) else -1.0
    at_end = not faces_arc(x, y, distance, arc)
    if at_end:
        x, y = start_x - segment.length * segment.tx, start_y - segment.length * segment.ty
        if start_x * start_x + start_y * start_y < x * x + y * y:
            x, y = start_x, start_y
        distance = math.sqrt(x * x + y * y)
    elif inside:
        x, y = -x, -y
    nx, ny = x / distance, y / distance
    return nx, ny, at_end, left * ny, -left * nx, left


@inline
def wall_frame(disc, k, segments, arcs, passage, periodic, images):
    """Directions at the contact of a disc with wall k, a segment or an arc.

    Returns the unit normal (nx, ny) towards the disc; whether the disc touches an end; the unit tangent (tx, ty) of the
    face that the disc touches; and 1 if that face is on the left of the wall as seen from the wall's start, -1 if it is
    on the right.
    """
    segment = segments[U(k)]
    if arcs is not None and arcs[U(k)].radius > 0.0:
        return arc_frame(disc, segment, arcs[U(k)], periodic, images)
    nx, ny, at_end = segment_normal(disc, segment, passage, periodic, images)
    tx, ty = (ny, -nx) if segment.length == 0.0 else (segment.tx, segment.ty)  # a fixed disc has a single face
    left = 1.0 if tx * ny - ty * nx >= 0.0 else -1.0
    return nx, ny, at_end, tx, ty, left


@inline
def wall_contact(disc, disc_id, k, arcs, passage, images, effects):
    """Local time at which a disc touches wall k, a segment or an arc; NEVER if it does not.

    passage: sides from which the wall lets the disc pass, see `permeable`; for an arc, both sides or neither.
    """
    if passage is not None and passage == OPEN:
        return NEVER
    segment, periodic = effects.segments[U(k)], effects.periodic
    gravity, restitution = effects.gravity, effects.restitution
    if arcs is not None and arcs[U(k)].radius > 0.0:
        return arc_contact(disc, disc_id, segment, arcs[U(k)], gravity, restitution, periodic, images)
    return segment_contact(disc, disc_id, segment, passage, gravity, restitution, periodic, images)


@inline
def misses_wall(disc, k, segments, arcs, gravity, periodic, images):
    """Whether it is certain that a disc does not touch wall k; always False for an arc.

    This test is faster than `wall_contact`.
    """
    if arcs is not None and arcs[U(k)].radius > 0.0:
        return False
    return misses_segment(disc, segments[U(k)], gravity, periodic, images)

"""A disc and an arc, both faces and ends, beside 50 digits."""

import math
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from helpers.rounding import U, body, exact

from idealgas.physics.arc import GLIDE, arc_contact, arc_frame, straight_exit_delay
from idealgas.physics.arc_geometry import CIRCLE, arc_through, bounds, drawn_points, nearest_points
from idealgas.physics.disc_wall import collide_with_wall
from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import NEVER
from idealgas.physics.periodic import NO_IMAGES

pytestmark = [pytest.mark.interpreted, pytest.mark.filterwarnings("ignore:.*encountered")]

HALF = (2.0, 1.0), (0.0, 3.0), (-2.0, 1.0)  # about (0, 1), counterclockwise
SHALLOW = (-3.0, 0.5), (0.1, 1.0), (2.0, 0.25)
OPEN = (0.0, 0.0), (3.0, 0.5), (0.25, 0.75)  # most of a circle
ROUND = (-2.0, 0.0), (2.0, 0.5), (-2.0, 0.0)
ARCS = {"half": HALF, "shallow": SHALLOW, "open": OPEN, "round": ROUND}


def wall(points) -> tuple[SimpleNamespace, SimpleNamespace]:
    """Segment and arc of three points."""
    (x, y), _, end = points
    across = np.subtract(end, (x, y))
    length = math.hypot(*across)
    tx, ty = across / length if length else (1.0, 0.0)
    segment = SimpleNamespace(x=x, y=y, tx=tx, ty=ty, length=length, radius=0.0)
    return segment, SimpleNamespace(**arc_through(*points)._asdict())


def contacts(disc, points):
    """Exact times at which a point in straight flight is r from an arc and comes nearer, and S/√D of each."""
    segment, arc = wall(points)
    x, y = exact(disc.x) - exact(segment.x), exact(disc.y) - exact(segment.y)
    vx, vy, r, radius = map(exact, (disc.vx, disc.vy, disc.r, arc.radius))
    square = vx * vx + vy * vy
    ends = (
        []
        if arc.cosine == CIRCLE
        else [(0, 0), tuple(exact(b) - exact(a) for a, b in zip(points[0], points[2], strict=True))]
    )
    faces = [((arc.x, arc.y), radius + r, -1), ((arc.x, arc.y), radius - r, 1)]
    for centre, reach, sign in [*faces, *((end, r, -1) for end in ends)]:
        a, b = x - exact(centre[0]), y - exact(centre[1])
        approach, discriminant = a * vx + b * vy, square * reach * reach - (vx * b - vy * a) ** 2
        if reach <= 0 or discriminant <= 0:
            continue
        time = (-approach + sign * mpmath.sqrt(discriminant)) / square
        there = a + vx * time, b + vy * time
        on_arc = there[0] * exact(arc.mx) + there[1] * exact(arc.my) > reach * exact(arc.cosine)
        if time > 0 and (centre in ends or on_arc):
            yield time, reach / mpmath.sqrt(discriminant)


@pytest.mark.parametrize("name", ARCS)
def test_straight_flight_to_an_arc(name):
    """The exact first time, to the rounding of the position over the speed along the normal."""
    draw, points, met = np.random.default_rng(3), ARCS[name], 0
    with mpmath.workdps(50):
        for x, y, vx, vy in draw.normal(size=(300, 4)) * (2, 2, 1, 1):
            disc = body(x=x, y=y, vx=vx, vy=vy, r=0.3)
            away = nearest_points(np.array([[x, y]]), points[0], points[2], arc_through(*points)) - (x, y)
            if np.hypot(*away.T) < 0.3:
                continue
            result = arc_contact(disc, 0, *wall(points), None, None, None, NO_IMAGES)
            expected, condition = min(contacts(disc, points), default=(NEVER, 0))
            met += expected < NEVER
            assert abs(result - expected) <= 16 * U * (8 * condition + expected) or result == expected == NEVER
    assert met > (120 if name == "round" else 60)


@pytest.mark.parametrize("name", ARCS)
def test_flight_on_a_parabola_to_an_arc(name):
    """At the contact the disc is r from the arc and comes nearer; before, it is nowhere within r."""
    draw, points, gravity, met = np.random.default_rng(4), ARCS[name], Gravity(0.2, -0.7), 0
    place = points[0], points[2], arc_through(*points)
    for x, y, vx, vy in draw.normal(size=(200, 4)) * (2, 2, 1, 1):
        disc = body(x=x, y=y, vx=vx, vy=vy, r=0.3)

        def distance(times, x=x, y=y, vx=vx, vy=vy):
            path = np.column_stack((x + vx * times + 0.1 * times**2, y + vy * times - 0.35 * times**2))
            return np.hypot(*(path - nearest_points(path, *place)).T)

        if distance(np.zeros(1))[0] < 0.3:
            continue
        result = arc_contact(disc, 0, *wall(points), gravity, None, None, NO_IMAGES)
        times = np.linspace(0, min(result, 30), 400)
        assert distance(times).min() > 0.3 - 1e-12
        if result < NEVER:
            met += 1
            assert distance(np.array([result]))[0] == pytest.approx(0.3, abs=1e-12)
            assert distance(np.array([result + 1e-6]))[0] < 0.3
    assert met > (60 if name == "round" else 20)


def test_normals_and_faces():
    """Towards the disc; the left face of a counterclockwise arc is the inner one."""
    cases = ((0.0, 2.7, (0, -1), 1), (0.0, 3.3, (0, 1), -1), (-1.7, 1.0 + 1e-9, (1, 0), 1), (2.3, 1 + 1e-9, (1, 0), -1))
    for x, y, normal, left in cases:
        nx, ny, at_end, tx, ty, face = arc_frame(body(x=x, y=y), *wall(HALF), None, NO_IMAGES)
        assert ((nx, ny), at_end, face) == (pytest.approx(normal, abs=1e-8), False, left)
        assert (-face * ty, face * tx) == (nx, ny)
        backwards = arc_frame(body(x=x, y=y), *wall(HALF[::-1]), None, NO_IMAGES)
        assert backwards[-1] == -left
    nx, ny, at_end, *_ = arc_frame(body(x=2.18, y=0.76), *wall(HALF), None, NO_IMAGES)
    assert at_end
    assert (nx, ny) == pytest.approx((0.6, -0.8), abs=1e-14)


def test_a_disc_that_slides_along_the_inside_stays():
    """It flies in chords that are not deeper than rounding, even along the tangent."""
    segment, arc = wall(ROUND)
    reach = arc.radius - 0.5
    for towards in (0.0, 1e-17, -1e-17, 1e-9):
        disc = body(x=0.0 + reach, y=0.25, vx=towards, vy=1.0, r=0.5, m=1.0)
        for _ in range(300):
            time = arc_contact(disc, 0, segment, arc, None, None, None, NO_IMAGES)
            assert time >= disc.t
            disc.x, disc.y, disc.t = disc.x + disc.vx * (time - disc.t), disc.y + disc.vy * (time - disc.t), time
            assert math.hypot(disc.x, disc.y - 0.25) <= reach * (1 + 1e-15)
            nx, ny, *_ = arc_frame(disc, segment, arc, None, NO_IMAGES)
            collide_with_wall(disc, 0, nx, ny, 4, None, None, None)
        assert math.hypot(disc.vx, disc.vy) == pytest.approx(1.0, abs=300 * U)
        assert disc.t >= 299 * GLIDE * reach


def test_a_disc_that_overlaps_by_rounding():
    assert straight_exit_delay(1.0 + 4 * U, 0.0, 1.0, 0.0, 1.0, True) == 0.0
    assert straight_exit_delay(1.0 + 4 * U, 0.0, -1.0, 0.0, 1.0, True) == pytest.approx(2.0)
    assert straight_exit_delay(5.0, 0.0, -1.0, 0.5, 1.0, False) == NEVER  # passes by
    assert straight_exit_delay(1.0, 0.0, 0.0, 0.0, 1.0, True) == NEVER


def test_arcs_through_three_points():
    for points in ARCS.values():
        arc = arc_through(*points)
        centre = np.add(points[0], (arc.x, arc.y))
        assert np.hypot(*(np.array(points) - centre).T) == pytest.approx(arc.radius, rel=1e-14)
        drawn = np.array(drawn_points(points[0], points[2], arc))
        assert np.hypot(*(drawn - centre).T) == pytest.approx(arc.radius, rel=1e-14)
        assert np.hypot(*(drawn - nearest_points(drawn, points[0], points[2], arc)).T).max() < 1e-13
        low, high = bounds(points[0], points[2], arc)
        assert (drawn >= np.array(low) - 1e-14).all()
        assert (drawn <= np.array(high) + 1e-14).all()
        step = np.hypot(*np.diff(drawn, axis=0).T)
        assert step.max() == pytest.approx(step.min())
        assert np.hypot(*(drawn - points[1]).T).min() < step.max()
    assert bounds(HALF[0], HALF[2], arc_through(*HALF)) == ((-2.0, 1.0), (2.0, 3.0))
    assert arc_through((0, 0), (1, 1), (2, 2)) is None
    assert arc_through(*HALF).turn == -arc_through(*HALF[::-1]).turn == 1

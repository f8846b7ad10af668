"""Images of discs across joined sides, beside fractions, which tell every rounding."""

from fractions import Fraction

import numpy as np
import pytest
from helpers.rounding import body, gamma

from idealgas.physics.periodic import (
    NO_IMAGES,
    Periodic,
    enter_opposite_side,
    images_between,
    images_to_wall,
    is_periodic,
    nearest_image,
    nearest_images,
    periodic_axes,
    place_in_space,
    separation,
    shift_by_images,
    wrap,
    wrapped,
)

pytestmark = pytest.mark.interpreted

LX, LY = 7.3, 4.1


def sides(x=True, y=True, discs=2):
    return Periodic(x, y, LX, LY, np.zeros((discs, 2), np.int32))


def crossed(across, up, **state):
    """A record that has counted boundary crossings along x and y."""
    disc = body(**state)
    disc.crossed_x, disc.crossed_y = np.int16(across), np.int16(up)
    return disc


def test_the_nearest_image():
    """The image at half a length or less; a product and a difference round: two roundings of the distance."""
    draw = np.random.default_rng(1)
    for distance in draw.uniform(-20, 20, 300):
        result = nearest_image(distance, LX, True)
        images = [Fraction(distance) - k * Fraction(LX) for k in range(-4, 5)]
        nearest = min(images, key=abs)
        if abs(abs(nearest) - Fraction(LX) / 2) > 1e-12:
            assert abs(Fraction(result) - nearest) <= gamma(2) * abs(distance)
        assert nearest_image(distance, LX, False) == distance
    assert nearest_image(LX / 2, LX, True) == LX / 2  # as near both ways: stays


def test_a_separation_is_to_the_nearest_images():
    draw = np.random.default_rng(2)
    for ax, ay, bx, by in draw.uniform(0, 1, (100, 4)) * (LX, LY, LX, LY):
        a, b = body(x=ax, y=ay), body(x=bx, y=by)
        x, y = ax - bx, ay - by
        assert separation(a, b, None) == (x, y)
        assert separation(a, b, sides()) == (nearest_image(x, LX, True), nearest_image(y, LY, True))
        assert separation(a, b, sides(y=False)) == (nearest_image(x, LX, True), y)
        assert shift_by_images(x, y, sides(), nearest_images(x, y, sides())) == separation(a, b, sides())
        assert nearest_images(x, y, sides(x=False))[0] == 0
    assert nearest_images(3.0, 4.0, None) == NO_IMAGES
    assert nearest_images(-0.6 * LX, 1.4 * LY, sides()) == (-1, 1)


def test_wrapping():
    """What is taken are whole lengths; a product and a difference round."""
    draw = np.random.default_rng(3)
    positions = draw.uniform(-30, 30, 300)
    for position in positions:
        place, boxes = wrapped(position, LX)
        assert boxes == Fraction(position) // Fraction(LX)
        assert abs(Fraction(place) - (Fraction(position) - int(boxes) * Fraction(LX))) <= gamma(2) * (
            abs(position) + LX
        )
    assert [array.tolist() for array in wrapped(positions, LX)] == [
        list(values) for values in zip(*(wrapped(position, LX) for position in positions), strict=True)
    ]


def test_a_disc_is_put_back_and_counted():
    periodic, disc = sides(y=False), crossed(-1, 0, x=-0.5, y=-0.5)  # it went through the left side since its record
    wrap(disc, 1, periodic)
    assert (disc.x, disc.y) == (LX - 0.5, -0.5)
    assert periodic.image.tolist() == [[0, 0], [-1, 0]]
    assert (disc.crossed_x, disc.crossed_y) == (0, 0)
    untouched = body(x=99.0, y=99.0)
    wrap(untouched, 0, None)
    assert (untouched.x, untouched.y) == (99.0, 99.0)


@pytest.mark.parametrize("x", [0.0, -0.0, LX, np.nextafter(LX, 0), np.nextafter(LX, 9), 5e-324, -5e-324, 3 * LX])
def test_at_a_side_a_disc_is_put_where_wrapping_puts_it(x):
    """Only a disc beyond the open interval between the sides is wrapped: for one inside, that changes no bit."""
    periodic, disc = sides(), crossed(0, 0, x=x, y=1.0)
    wrap(disc, 0, periodic)
    place, boxes = wrapped(x, LX)
    assert np.float64(disc.x).tobytes() == np.float64(place).tobytes()
    assert (disc.crossed_x, periodic.image[0, 0]) == (-boxes, boxes)


def test_images_are_counted_from_the_records_and_none_without_joined_sides():
    periodic, a, b = sides(), crossed(2, -1), crossed(0, 3)
    assert images_between(periodic, a, b, (1, 0)) == (3, -4)
    assert images_between(periodic, b, a, (0, 0)) == (-2, 4)
    assert images_to_wall(periodic, b, (-1, 1)) == (-1, 4)
    assert shift_by_images(1.0, 2.0, periodic, (1, -2)) == (1.0 - LX, 2.0 + 2 * LY)
    assert images_between(None, body(), body(), (1, 0)) == images_to_wall(None, body(), (1, 0)) == NO_IMAGES
    assert shift_by_images(1.0, 2.0, None, (1, 1)) == (1.0, 2.0)
    assert periodic_axes(None) == (False, False)
    assert periodic_axes(sides(x=False)) == (False, True)
    assert [is_periodic(sides(x=False), along_y) for along_y in (False, True)] == [False, True]
    assert not is_periodic(None, True)


def test_places_in_space_and_rows_of_sheared_boxes():
    """Two boxes to the right and one down; a disc that crosses the top is one row further up, and wrapped along x."""
    both = sides()
    both.image[1] = (2, -1)
    assert place_in_space(body(x=1.0, y=2.0), 1, both) == (1.0 + 2 * LX, 2.0 - LY)
    assert place_in_space(body(x=1.0, y=2.0), 1, None) == (1.0, 2.0)
    joined = sides(y=False)
    disc = crossed(-1, 0, x=1.0 - LX, y=0.0)
    enter_opposite_side(disc, 1, 1, joined)
    assert disc.x == pytest.approx(1.0, abs=4 * 2.0**-52)
    assert (joined.image[1].tolist(), disc.crossed_x, disc.crossed_y) == ([-1, 1], 0, 0)
    assert joined.image[0].tolist() == [0, 0]

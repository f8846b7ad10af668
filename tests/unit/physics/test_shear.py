"""Sheared sides: where the image above is, how discs cross to it, and the flow, in numbers worked out by hand."""

import math

import pytest
from helpers.rounding import body

from idealgas.physics.motion import NEVER
from idealgas.physics.shear import (
    add_flow,
    at,
    begin_epoch,
    cross,
    crossing_time,
    enter_common_frame,
    flow_at,
    leave_common_frame,
    less_offset_of_nearest,
    longest_epoch,
    make_shear,
    offset_at,
    subtract_offset,
)

pytestmark = pytest.mark.interpreted


@pytest.fixture
def shear():
    """A box of 8 by 4 at the rate 0.5, whose image above moves with u = 2, in an epoch from t = 5.5 on."""
    shear = make_shear(0.5, (8.0, 4.0))
    begin_epoch(shear, 5.5, 0.25)
    return shear


def test_the_image_above_is_ahead_by_its_way_less_whole_widths(shear):
    assert shear.speed == 2.0
    assert shear.offset.tolist() == [3.0, 3.5]  # 2 · 5.5 - 8
    assert offset_at(shear, 0.25) == 3.5
    assert at(shear, 9.0).offset.tolist() == [2.0, 2.0]
    assert shear.offset.tolist() == [3.0, 3.5]
    assert longest_epoch(shear) == 4.0
    assert longest_epoch(None) == math.inf


def test_relative_motion_is_seen_from_the_image_and_both_discs_half_way(shear):
    assert subtract_offset(1.0, 0.5, 0.25, shear, (0, 1)) == (-2.5, -1.5)
    assert subtract_offset(1.0, 0.5, 0.25, shear, (0, -2)) == (8.0, 4.5)
    assert less_offset_of_nearest(1.0, 3.0, 0.25, shear) == (-2.5, -1.0)
    assert subtract_offset(1.0, 0.5, 0.25, None, (0, 1)) == (1.0, 0.5)
    a, b = body(vx=1.0), body(vx=-1.0)
    enter_common_frame(a, b, shear, (0, 1))
    assert (a.vx, b.vx) == (0.0, 0.0)
    leave_common_frame(a, b, shear, (0, 1))
    assert (a.vx, b.vx) == (1.0, -1.0)


def test_a_disc_crosses_to_the_opposite_side(shear):
    up, down = body(x=1.0, y=3.0, vx=0.5, vy=2.0, t=0.25), body(x=1.0, y=1.0, vx=0.5, vy=-2.0, t=0.25)
    assert [crossing_time(up, side, 4.0, True, 1.0) for side in (2, 3)] == [NEVER, 0.75]
    assert [crossing_time(down, side, 4.0, True, 1.0) for side in (2, 3)] == [0.75, NEVER]
    assert crossing_time(body(y=1.0, vy=0.0), 2, 4.0, True, 1.0) == NEVER
    assert crossing_time(up, 3, 4.0, None, 1.0) == 1.0
    assert (cross(up, 3, shear), up.x, up.y, up.vx, up.vy) == (1, -2.5, 0.0, -1.5, 2.0)
    assert (cross(down, 2, shear), down.x, down.y, down.vx, down.vy) == (-1, 4.5, 4.0, 2.5, -2.0)


def test_the_flow_vanishes_half_way_up(shear):
    assert [flow_at(y, 0.5, 4.0) for y in (0.0, 2.0, 3.0)] == [-1.0, 0.0, 0.5]
    disc = body(y=3.0, vx=1.0)
    add_flow(disc, shear)
    assert disc.vx == 1.5

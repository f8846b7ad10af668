"""Contact times and collisions of two discs, against cases worked out by hand."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from idealgas.effects.bundle import Effects
from idealgas.engine.records import DISC
from idealgas.jit import aligned, njit
from idealgas.physics.disc_disc import collide, contact_time, random_contact
from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import NEVER
from idealgas.physics.periodic import NO_IMAGES

pytestmark = pytest.mark.interpreted


@njit
def contact_with(discs, gravity, effects):
    return contact_time(discs[0], discs[1], 0, 1, NO_IMAGES, gravity, None, effects)


def contact_of(discs):
    return contact_with(discs, None, Effects())


def contact_under_gravity(discs):
    return contact_with(discs, Gravity(0.0, -1.0), Effects())


@njit
def collide_with(discs, effects):
    collide(discs[0], discs[1], 0, 1, (0, 0), None, None, effects)


def collide_them(discs):
    collide_with(discs, Effects())


def pair(a, b):
    """Two records from (x, y, vx, vy, t, r, m)."""
    discs = aligned(2, DISC)
    for record, values in zip(discs, (a, b), strict=True):
        record.x, record.y, record.vx, record.vy, record.t, record.r, record.m = values
    return discs


@pytest.mark.parametrize(
    ("a", "b", "time"),
    [
        pytest.param((0, 0, 1, 0, 0, 0.5, 1), (5, 0, -1, 0, 0, 0.5, 1), 2.0, id="head on"),
        pytest.param((-3, 0, 1, 0, 0, 0.5, 1), (5, 0, -1, 0, 3, 0.5, 1), 5.0, id="records of different times"),
        pytest.param((0, 0, -1, 0, 0, 0.5, 1), (5, 0, 1, 0, 0, 0.5, 1), NEVER, id="receding"),
        pytest.param((0, 0, 1, 0, 0, 0.5, 1), (5, 1.01, 0, 0, 0, 0.5, 1), NEVER, id="passing"),
        pytest.param((-3, 1, 1, 0, 0, 0.5, 1), (0, 0, 0, 0, 0, 0.5, 1), NEVER, id="grazing, exactly"),
        pytest.param((0, 0, 1, 0, 7, 0.5, 1), (-2, 0, 0, 0, 3, 0.5, 1), NEVER, id="apart when both records are valid"),
        pytest.param((0, 0, 1, 0, 0, 0.5, 1), (5, 0, 1, 0, 0, 0.5, 1), NEVER, id="same velocity"),
        pytest.param((0, 0, 0, 0, 0, 0.5, 1), (1, 0, 1, 0, 0, 0.5, 1), NEVER, id="touching and receding"),
        pytest.param((0, 0, 1, 0, 7, 0.5, 1), (1, 0, 0, 0, 7, 0.5, 1), 7.0, id="touching and approaching"),
        pytest.param((0, 0, 1, 0, 7, 0.5, 1), (1 - 1e-15, 0, 0, 0, 7, 0.5, 1), 7.0, id="overlapping by rounding"),
        pytest.param((0, 0, 1, 0, 7, 0.5, 1), (0.9, 0, 0, 0, 7, 0.5, 1), 7.0, id="overlapping"),
    ],
)
def test_contact_times(a, b, time):
    assert contact_of(pair(a, b)) == time


@pytest.mark.parametrize(("first", "then"), [(0, 2), (2, 0)])
def test_discs_that_fall_since_different_times(first, then):
    """At t = 2 both are level, at rest and at the speed 1, three apart: they touch at t = 4, as they fall alike."""
    bodies = {2: (0, 0, 1, 0, 2, 0.5, 1), 0: (3, -2, 0, 2, 0, 0.5, 1)}
    assert contact_under_gravity(pair(bodies[first], bodies[then])) == 4.0


def test_oblique_contact_at_45_degrees():
    time = contact_of(pair((0, 0, 1, 0, 0, 0.5, 1), (10, math.sqrt(0.5), 0, 0, 0, 0.5, 1)))
    assert time == pytest.approx(10 - math.sqrt(0.5), rel=1e-15)


@pytest.mark.parametrize("side", [-1, 1])
def test_oblique_contact_along_a_triangle(side):
    """Along (0.6, 0.8) at the speed 5, 10 away and 0.6 aside: the centres are 0.8 short of abreast, at 9.2/5."""
    b = (6 - side * 0.48, 8 + side * 0.36, 0, 0, 0, 0.5, 1)
    assert contact_of(pair((0, 0, 3, 4, 0, 0.5, 1), b)) == pytest.approx(1.84, rel=1e-14)


def test_touching_discs_whose_collision_changes_nothing_are_done():
    assert contact_of(pair((0, 0, 1, 1e-30, 0, 0.5, 1), (0, 1, 1, 0, 0, 0.5, 1))) == 0.0
    assert contact_of(pair((0, 0, 1, 1 + 1e-16, 0, 0.5, 1), (0, 1, 1, 1, 0, 0.5, 1))) == NEVER
    assert contact_of(pair((0, 0, 1, 0, 0, 0.5, 1), (1e-17, 1, 0, 1, 0, 0.5, 1))) == NEVER
    slides = pair((0, 0, 1, 8, 7, 0.5, 1), (2.0**-52 - 2, -31, 0.5, 8, 3, 0.5, 1))  # b comes to (2⁻⁵², 1) when t = 7
    assert contact_of(slides) == NEVER
    assert slides.vx.tolist() == [1.0, 0.5]


@pytest.mark.parametrize(
    ("masses", "velocities", "expected"),
    [((1, 1), ((1, 0.25), (-2, 0.5)), [[-2, 0.25], [1, 0.5]]), ((3, 1), ((1, 0), (0, 0)), [[0.5, 0], [1.5, 0]])],
)
def test_collisions_along_x(masses, velocities, expected):
    """Equal discs exchange their normal velocities."""
    discs = pair(*((k, 0, *velocities[k], 0, 0.5, masses[k]) for k in (0, 1)))
    collide_them(discs)
    assert [[disc.vx, disc.vy] for disc in discs] == expected


numbers = st.floats(-10, 10).filter(lambda x: x == 0 or abs(x) > 1e-100)  # whose squares keep all their digits
records = st.tuples(numbers, numbers, numbers, numbers, st.floats(0, 10), st.floats(0.1, 2), st.floats(0.1, 10))


@given(records, records)
def test_both_laws_are_symmetric_to_the_last_bit(a, b):
    there, back = pair(a, b), pair(b, a)
    assert contact_of(there) == contact_of(back)
    there.t = back.t = 0
    if (a[0], a[1]) != (b[0], b[1]):
        collide_them(there)
        collide_them(back)
        assert np.array_equal(there[0].tolist(), back[1].tolist(), equal_nan=True)
        assert np.array_equal(there[1].tolist(), back[0].tolist(), equal_nan=True)


@given(records, records, st.floats(0, 2 * math.pi))
def test_a_collision_conserves_energy_and_momentum_and_turns_the_approach_round(a, b, angle):
    a, b = list(a), list(b)
    reach = a[5] + b[5]
    b[0], b[1] = a[0] + reach * math.cos(angle), a[1] + reach * math.sin(angle)
    discs = pair(a, b)
    before = discs.copy()
    collide_them(discs)
    masses = discs.m

    def energy(d):
        return 0.5 * (masses * (d.vx**2 + d.vy**2)).sum()

    speed = max(np.abs([before.vx, before.vy]).max(), 1e-300)
    scale = masses.sum() * speed
    assert energy(discs) == pytest.approx(energy(before), rel=1e-14, abs=1e-14 * scale * speed)
    for component in ("vx", "vy"):
        total = (masses * discs[component]).sum()
        assert total == pytest.approx((masses * before[component]).sum(), abs=2e-14 * scale)

    def approach(d):
        return (d.x[0] - d.x[1]) * (d.vx[0] - d.vx[1]) + (d.y[0] - d.y[1]) * (d.vy[0] - d.vy[1])

    assert approach(discs) == pytest.approx(-approach(before), abs=1e-13 * reach * speed)


def two_discs(a, b, masses=(1.0, 3.0)):
    record = np.zeros(2, DISC).view(np.recarray)
    record.vx, record.vy = np.transpose([a, b])
    record.r, record.m = (0.3, 0.7), masses
    return record


@pytest.mark.parametrize("offset", [-1.0, -0.6, 0.0, 0.25, 0.999])
def test_the_line_of_centres_has_the_sine_of_the_offset(offset):
    record = two_discs((1.0, 2.0), (-0.5, 1.0))
    random_contact(record[0], record[1], offset)
    centres = np.array([record[0].x - record[1].x, record[0].y - record[1].y])
    relative = np.array([1.5, 1.0])
    unit, ahead = centres / np.hypot(*centres), relative / np.hypot(*relative)
    assert ahead[0] * unit[1] - ahead[1] * unit[0] == pytest.approx(offset, abs=1e-15)
    assert unit @ ahead == pytest.approx(-math.sqrt(1 - offset**2), abs=1e-15)  # a comes from behind b's surface


def test_a_head_on_contact_of_equal_discs_exchanges_the_velocities():
    record = two_discs((2.0, 1.0), (-1.0, 0.5), masses=(1.0, 1.0))
    random_contact(record[0], record[1], 0.0)
    collide(record[0], record[1], 0, 1, NO_IMAGES, None, None, Effects())
    assert (record[0].vx, record[0].vy) == pytest.approx((-1.0, 0.5), abs=1e-15)
    assert (record[1].vx, record[1].vy) == pytest.approx((2.0, 1.0), abs=1e-15)

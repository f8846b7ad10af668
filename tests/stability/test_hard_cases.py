"""Motions that are exactly solvable and nasty: simultaneous events, contact from the start, corners, discs at rest.

Where three or more discs meet at one instant the laws of motion do not say what happens. There, the events are taken in
the written order, and what is asserted is conservation, determinism and agreement of the two methods.
"""

import math

import numpy as np
import pytest
from helpers.support import gas_of, record, same_rows, within

from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop

pytestmark = pytest.mark.interpreted

U = 2.0**-53

methods = pytest.mark.parametrize("method", [EventDriven, BruteForce])


def end_of(gas, method, time):
    """The gas at a time, and the rows on the way there."""
    simulation = Simulation(gas, method())
    rows = record(simulation, Stop(time=time))
    return simulation.state()[0], rows


def conserved(gas):
    return np.array([gas.kinetic_energy, *(gas.mass[:, None] * gas.velocity).sum(axis=0)])


# ── touching at the start ──


@methods
@pytest.mark.parametrize("strikers", [1, 2, 3])
def test_newtons_cradle(strikers, method):
    """Five touching discs: as many leave as came, to the last bit, as all numbers are sums of powers of two."""
    x = np.array([*(3.0 + 2 * np.arange(strikers)), *(14.0 + 2 * np.arange(5))])
    velocity = np.zeros((len(x), 2))
    velocity[:strikers, 0] = 0.5
    end, rows = end_of(gas_of((64, 8), np.column_stack((x, np.full(len(x), 4.0))), velocity, 1.0), method, 30.0)
    assert end.velocity[:, 0].tolist() == [0.0] * 5 + [0.5] * strikers
    assert not end.velocity[:, 1].any()
    assert len(rows.time) == 2 * 5 * strikers
    assert rows.time[0] == (14 - x[strikers - 1] - 2) / 0.5


@methods
@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0])
def test_a_cradle_that_is_rounded(angle, method):
    """Radii and places of no finite binary fraction: gaps and overlaps of an ulp pass the motion on as well.

    A gap of an ulp of a place turns each line of centres by up to 2u * 16/0.2; through five contacts, to 1e-13.
    """
    along = np.array([math.cos(angle), math.sin(angle)])
    place = np.array([3.0, 3.0]) + np.array([0.0, 1.0, 1.2, 1.4, 1.6, 1.8])[:, None] * along
    velocity = np.zeros((6, 2))
    velocity[0] = 0.7 * along
    end, _ = end_of(gas_of((16, 16), place, velocity, 0.1), method, 3.0)
    expected = np.zeros((6, 2))
    expected[5] = 0.7 * along
    within("cradle that is rounded: velocities", np.abs(end.velocity - expected).max(), 1e-13)


@methods
def test_touching_discs_at_rest_stay(method):
    """Touching is no event: nothing approaches."""
    place = [(1, 1), (3, 1), (2, 1 + math.sqrt(3)), (5, 1)]
    end, rows = end_of(gas_of((16, 16), place, 0.0, 1.0), method, 1e6)
    assert len(rows.time) == 0
    assert end.position.tolist() == [list(p) for p in place]


@methods
def test_touching_discs_that_part_or_slide_never_meet(method):
    """Relative motion away from each other, or along the tangent, is no approach."""
    for velocity in ([(-1, 0), (1, 0)], [(0, 1), (0, -1)], [(0.5, 0.5), (0.5, 0.5)], [(-1, 3), (-1, -2)]):
        _, rows = end_of(gas_of((64, 64), [(30, 30), (32, 30)], velocity, 1.0), method, 5.0)
        assert len(rows.time) == 0


# ── three and more at one instant ──

SQUARE = [(-1, 0), (1, 0), (0, -1), (0, 1)]
HEXAGON = [(math.cos(k * math.pi / 3), math.sin(k * math.pi / 3)) for k in range(6)]
BREAK = [(-3.0, 0.0), *((math.sqrt(3) * row, 2 * k - row) for row in range(3) for k in range(row + 1))]

meetings = pytest.mark.parametrize(
    ("place", "velocity", "radius"),
    [
        pytest.param(np.array(SQUARE) * 4, -np.array(SQUARE), 1.0, id="four to a point"),
        pytest.param(np.array(HEXAGON) * 4, -np.array(HEXAGON), 1.0, id="six to a point"),
        pytest.param([(-4, 0), *SQUARE[1:]], [(1, 0)] + [(0, 0)] * 3, math.sqrt(0.5), id="into touching three"),
        pytest.param([(-4, 0), (0, -1), (0, 1)], [(1, 0), (0, 0), (0, 0)], 1.0, id="between touching two"),
        pytest.param([(-4, 0), (0, 0), (4, 0)], [(1, 0), (0, 0), (-1, 0)], 1.0, id="from both sides"),
        pytest.param(BREAK, [(1, 0)] + [(0, 0)] * 6, 1.0, id="break of a triangle"),
    ],
)


@meetings
def test_many_at_one_instant(place, velocity, radius):
    """Energy and momentum to rounding (20 collisions of 8 u each), repeatable, the same by both methods."""
    gas = gas_of((64, 64), np.array(place, float) + 32, velocity, radius)
    end, rows = end_of(gas, EventDriven, 20.0)
    scale = gas.kinetic_energy
    assert len(rows.time) >= 4
    within(
        "many at one instant: energy and momentum, in u",
        np.abs(conserved(end) - conserved(gas)).max() / (U * scale),
        160,
    )
    for method in (EventDriven, BruteForce):
        again, same = end_of(gas, method, 20.0)
        assert same_rows(rows, same)
        assert np.array_equal(end.position, again.position)


def fold(x, length):
    """Where a point is that moves between two walls, and whether it moves backwards there."""
    x %= 2 * length
    return (x, 1.0) if x <= length else (2 * length - x, -1.0)


def rods(start, length, velocity, time, diameter=2.0):
    """Places and velocities of equal rods on a line: points that pass through each other, once the rods are shrunk."""
    shrunk = length - diameter * len(start)
    points = [start[k] - diameter * k - diameter / 2 for k in range(len(start))]
    moved = sorted(fold(x + velocity * time, shrunk) for x in points)
    return (
        np.array([x + diameter * k + diameter / 2 for k, (x, _) in enumerate(moved)]),
        np.array([velocity * sign for _, sign in moved]),
    )


@methods
@pytest.mark.parametrize("direction", [(1, 0), (0, 1), (1, 1), (1, 0.5)])
@pytest.mark.parametrize("pitch", [2.0, 3.0])
def test_a_lattice_that_moves_as_one(pitch, direction, method):
    """Each row and each column is a line of rods, exactly: dozens of contacts at every instant, no digit lost.

    At the time looked at no two shrunk points coincide, so that every rod has a velocity.
    """
    columns, rows, time = 5, 4, 16.25
    x, y = (pitch * np.arange(n) + 1.5 for n in (columns, rows))
    box = (24.0, 20.0)
    place = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    end, log = end_of(gas_of(box, place, direction, 1.0), method, time)
    assert (np.diff(log.time) == 0).mean() > 0.5
    (x, vx), (y, vy) = (rods(s, side, v, time) for s, side, v in zip((x, y), box, direction, strict=True))
    assert np.array_equal(end.position, np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
    assert np.array_equal(end.velocity, np.stack(np.meshgrid(vx, vy), axis=-1).reshape(-1, 2))


# ── walls ──


@methods
@pytest.mark.parametrize("ulps", [-2, -1, 0, 1, 2])
def test_into_a_corner(ulps, method):
    """Within an ulp or two of the corner: two hits, as far apart as the place was off or its rounding, and back."""
    y = 5.0 + ulps * np.spacing(5.0)
    end, rows = end_of(gas_of((10, 10), [(5, y)], [(1, 1)], 1.0), method, 5.0)
    assert sorted(rows.partner.tolist()) == [-4, -2]
    assert rows.partner[0] == (-4 if ulps > 0 else -2)
    assert 0 <= rows.time[1] - rows.time[0] <= abs(ulps) * np.spacing(5.0) + np.spacing(8.0)
    assert end.velocity.tolist() == [[-1, -1]]
    within("corner: place, in ulps", np.abs(end.position - 8).max() / np.spacing(8.0), 2)


@methods
def test_a_disc_that_just_fits(method):
    """Clearance 1e-9: 5000 bounces at the times that the clearance gives, to an ulp of the coordinate each.

    The disc stands within an ulp of where it should, a part 2u/1e-9 of its way, so that is how exact the count is.
    """
    height, speed, bounces = 1.0 + 1e-9, 0.25, 5000
    clearance = (height - 0.5) - 0.5
    gas = gas_of((4, height), [(2, 0.5)], [(0.0, speed)], 0.5)
    simulation = Simulation(gas, method())
    rows = record(simulation, Stop(events=bounces))
    error = abs(rows.time[-1] / (bounces * clearance / speed) - 1)
    within("a disc that just fits: time of 5000 bounces, in u / clearance", error * clearance / U, 4)
    assert (np.diff(rows.time) > 0).all()
    assert set(rows.velocity[:, 1].tolist()) == {speed, -speed}
    assert np.abs(rows.position[:, 1] - np.where(rows.partner == -4, height - 0.5, 0.5)).max() <= 2 * U


@methods
def test_a_disc_that_fits_exactly(method):
    """No clearance at all, motion along the channel: the only events are those at its ends."""
    end, rows = end_of(gas_of((8, 1), [(2, 0.5)], [(1.0, 0.0)], 0.5), method, 40.0)
    assert rows.partner.tolist() == [-2, -1] * 2 + [-2]
    assert rows.time.tolist() == [5.5, 12.5, 19.5, 26.5, 33.5]
    assert end.position.tolist() == [[1.0, 0.5]]


# ── at rest ──


@methods
def test_discs_that_nobody_meets_stay_to_the_bit(method):
    """One disc runs to and fro between two rows of others."""
    draw = np.random.default_rng(1)
    x = np.arange(1.5, 30)
    place = np.concatenate(([(1, 8)], np.column_stack((x, np.full(29, 4.0))), np.column_stack((x, np.full(29, 12.0)))))
    place[1:] += draw.uniform(-0.1, 0.1, (58, 2))
    velocity = np.zeros((59, 2))
    velocity[0] = 1.7, 0.0
    end, rows = end_of(gas_of((31, 16), place, velocity, 0.4), method, 200.0)
    assert set(rows.disc.tolist()) == {0}
    assert len(rows.time) == (200 * 1.7 + 1 - 0.4) // (31 - 0.8)
    assert np.array_equal(end.position[1:], place[1:])


# ── simulation time ──


@pytest.mark.parametrize("start", [1.0, 1e12, 2.0**52])
def test_a_late_start_is_the_same_motion(start):
    """Clocks count from the start of an epoch: at time 10¹² every bit of the motion is as at time 0."""
    draw = np.random.default_rng(2)
    place = np.stack(np.meshgrid(np.arange(4), np.arange(4)), axis=-1).reshape(-1, 2) * 3.0 + 2.0
    gas = gas_of((13, 13), place, draw.normal(size=(16, 2)), 1.0)
    early, late = (Simulation(gas, EventDriven(), time=time) for time in (0.0, start))
    first, second = (record(simulation, Stop(events=1600)) for simulation in (early, late))
    assert early.epoch == late.epoch >= 1
    assert same_rows(first._replace(time=second.time), second)
    within(
        "late start: times, in ulps of the clock",
        np.abs(second.time - (start + first.time)).max() / np.spacing(start),
        1,
    )

"""Walls, their ends, and gravity, where rounding could do harm: against closed forms, or mpmath with 50 digits."""

import math
import warnings

import mpmath
import numpy as np
import pytest
from helpers.support import batches, gas_of, record, within

from idealgas.columns import Kind
from idealgas.effects.bundle import Effects
from idealgas.effects.wall import make_segments
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop
from idealgas.physics.gravity import Gravity

U = 2.0**-53
FEW = 16  # roundings on the way to a contact time, each of u times the condition number
NEVER = math.inf


def simulation_of(gas, walls=(), gravity=None) -> Simulation:
    ends = np.array(walls, float).reshape(-1, 2, 2)
    segments = make_segments(ends[:, 0], ends[:, 1]) if walls else None
    return Simulation(gas, EventDriven(), Effects(gravity=Gravity(*gravity) if gravity else None, segments=segments))


def exact_end_contact(place, velocity, radius, gravity=(0.0, 0.0)):
    """When a disc first comes to `radius` from the origin, with 50 digits, and how fast along the normal; or None."""
    with mpmath.workdps(50):
        x, y, vx, vy, gx, gy, r = (mpmath.mpf(float(v)) for v in (*place, *velocity, *gravity, radius))
        quartic = [
            (gx**2 + gy**2) / 4, gx * vx + gy * vy, vx**2 + vy**2 + gx * x + gy * y, 2 * (x * vx + y * vy),
            x**2 + y**2 - r**2,
        ]  # fmt: skip
        while quartic[0] == 0:
            quartic.pop(0)
        with warnings.catch_warnings(action="ignore"):  # of the order of coefficients, which is to change
            roots = mpmath.polyroots(quartic, maxsteps=500, extraprec=400)
        roots = [z.real for z in roots if abs(z.imag) < 1e-30]
        times = sorted(t for t in roots if t > 0)
        if not times:
            return None
        t = times[0]
        normal_speed = ((x + vx * t + gx * t**2 / 2) * (vx + gx * t) + (y + vy * t + gy * t**2 / 2) * (vy + gy * t)) / r
        return float(t), abs(float(normal_speed))


@pytest.mark.parametrize("gravity", [None, (0.0, -0.125), (0.3, 0.1)], ids=["straight", "down", "aslant"])
@pytest.mark.parametrize("exponent", range(1, 17))
@pytest.mark.parametrize("side", [-1, 1])
def test_a_wall_end_is_hit_where_geometry_says(exponent, side, gravity):
    """Impact parameter R(1 ± 10⁻ᵉ) at an end whose wall leads down: hit or miss, and the time to its condition number.

    A change δ of the coordinates moves the contact by δ/(normal speed); below √u of grazing, no double decides.
    """
    radius, speed, end = 0.5, 1.0, np.array([10.0, 8.0])
    impact = radius * (1 + side * 10.0**-exponent)
    start, velocity = np.array([4.0, 8.0 + impact]), np.array([speed, 0.0])
    if gravity is not None:  # a path that is as far from the end where it is nearest to it in x
        duration = 6.0
        velocity -= 0.5 * np.array(gravity) * duration
    gas = gas_of((20, 16), [start], [velocity], radius)
    rows = record(simulation_of(gas, [(*end, 10.0, 2.0)], gravity), Stop(time=10.0, events=1))
    exact = exact_end_contact(start - end, velocity, radius, gravity or (0.0, 0.0))
    hit = len(rows.time) == 1 and rows.kind[0] == Kind.WALL_END and rows.time[0] < 8
    if exact is None or exact[1] > 1e-7:
        assert hit == (exact is not None and exact[0] < 8)
    if hit and exact is not None:
        size = 20.0 + abs(velocity).max() * 10
        error = abs(rows.time[0] - exact[0]) / (U * (size / max(exact[1], 1e-12) + exact[0]))
        within("wall ends: contact time, in u times condition", error, FEW)


@pytest.mark.parametrize("gravity", [None, (0.0, -0.125)], ids=["straight", "falling"])
@pytest.mark.parametrize("radius", [0.5, 1e-3, 1e-7])
@pytest.mark.parametrize("tilt", [0.0, 1.0, -1.5])
def test_a_wall_end_hit_centrally_sends_a_disc_back(radius, tilt, gravity):
    """Whatever way the wall leads on: the velocity turns round, to the error of the place over the radius, or 1 ulp."""
    end, start = np.array([10.0, 8.0]), np.array([10.0, 14.0])
    wall = (*end, end[0] + 3 * math.sin(tilt), end[1] - 3 * math.cos(tilt))
    simulation = simulation_of(gas_of((20, 16), [start], [(0.0, -1.0)], radius), [wall], gravity)
    rows = record(simulation, Stop(time=10.0, events=1))
    assert rows.kind[0] == Kind.WALL_END
    speed = 1.0 if gravity is None else math.sqrt(1.0 + 2 * 0.125 * (6.0 - radius))
    off = np.abs(rows.velocity[0] - [0.0, speed]).max()
    within("wall ends hit centrally: velocity, in u L / R", off / (U * 20 / radius), FEW)
    within(
        "wall ends hit centrally: distance, in u L", abs(np.hypot(*(rows.position[0] - end)) - radius) / (U * 20), FEW
    )


@pytest.mark.parametrize("degrees", [90, 60, 37, 10, 3, 1])
@pytest.mark.parametrize("offset", [0.3, 0.01])
def test_a_wedge_gives_back_a_disc_after_the_exact_number_of_bounces(degrees, offset):
    """Mirror images of the wedge unfold the way of the centre into a line: it crosses one image after the other.

    The line passes the apex of the centre's wedge at a distance `offset`; ⌈π/θ⌉ crossings, or one less.
    """
    angle, radius, length = math.radians(degrees), 0.02, 400.0
    apex = np.array([500.0, 500.0])
    walls = [
        (*apex, apex[0] + length, apex[1]),
        (*apex, apex[0] + length * math.cos(angle), apex[1] + length * math.sin(angle)),
    ]
    middle = np.array([math.cos(angle / 2), math.sin(angle / 2)])
    inner = apex + radius / math.sin(angle / 2) * middle
    across = np.array([-middle[1], middle[0]])
    far = 100.0
    start = inner + far * middle + offset * min(1.0, far * math.tan(angle / 2)) * across
    gas = gas_of((1000, 1000), [start], [-middle], radius)
    rows = record(simulation_of(gas, walls), Stop(time=1.8 * far))
    from_apex = start - inner
    polar = math.atan2(from_apex[1], from_apex[0])
    turned = math.atan2(-middle[1], -middle[0]) % (2 * math.pi)  # where the unfolded line goes
    images = [k * angle for k in range(-400, 400)]
    if from_apex[1] * middle[0] > from_apex[0] * middle[1]:  # counter-clockwise about the apex
        crossed = sum(polar < image < turned for image in images)
    else:
        crossed = sum(turned - 2 * math.pi < image < polar for image in images)
    assert len(rows.time) == crossed
    assert abs(crossed - math.pi / angle) <= 1
    within("wedges: speed, in u times bounces", np.abs(np.hypot(*rows.velocity.T) - 1).max() / (U * crossed), 4)


def test_a_disc_that_slides_along_a_wall_never_meets_it():
    """In contact, along the wall, past its ends, which it grazes: nothing changes but at the sides of the box."""
    gas = gas_of((16, 8), [(2.0, 4.5)], [(1.0, 0.0)], 0.5)
    simulation = simulation_of(gas, [(3.0, 4.0, 9.0, 4.0)])
    rows = record(simulation, Stop(time=1000.0))
    assert set(rows.partner[rows.kind == Kind.WALL].tolist()) == {-1, -2}
    assert set(rows.position[:, 1].tolist()) == {4.5}
    assert set(rows.velocity[:, 1].tolist()) == {0.0}
    assert rows.time[rows.kind == Kind.WALL].tolist() == [13.5 + 15 * k for k in range(66)]


@pytest.mark.long
def test_a_million_bounces():
    """Energy m(v²/2 + gy) to 1e-10; the disc never sinks, but for the rounding of each contact by itself."""
    gas = gas_of((64, 64), [(7.3, 11.7)], [(0.9, 0.4)], 0.5)
    simulation = simulation_of(gas, gravity=(0.0, -1.0))
    energy = 0.5 * 0.9**2 + 0.5 * 0.4**2 + 11.7
    lowest, now, drift = math.inf, 0.0, 0.0
    for rows in batches(simulation, Stop(events=1_000_000)):
        if len(rows.time):
            actual = 0.5 * (rows.velocity**2).sum(axis=1) + rows.position[:, 1]
            drift = max(drift, np.abs(actual / energy - 1).max())
            assert rows.time[0] >= now
            lowest, now = min(lowest, rows.position[:, 1].min()), rows.time[-1]
    within("a million bounces: energy, relative", drift, 1e-10)
    within("a million bounces: below the floor", 0.5 - lowest, 1e-12)
    rates = 0.9 / 63, 0.5 / math.sqrt(2 * (energy - 0.5 - 0.5 * 0.9**2))  # of the sides, and of the floor
    assert now == pytest.approx(1_000_000 / sum(rates), rel=1e-5)


@pytest.mark.parametrize("ulps", [-2, -1, 0, 1, 2])
def test_an_orbit_that_just_touches_the_ceiling(ulps):
    """Thrown up with 4 under gravity 1: the top is 8 higher. A ceiling d lower sends it back √(2d) earlier.

    What is lower by some ulps is known to a few of them.
    """
    ceiling = 9.0
    for _ in range(abs(ulps)):
        ceiling = np.nextafter(ceiling, math.copysign(math.inf, ulps))
    gas = gas_of((4, ceiling), [(2.0, 0.5)], [(0.0, 4.0)], 0.5)
    simulation = simulation_of(gas, gravity=(0.0, -1.0))
    rows = record(simulation, Stop(time=161.0))
    floor = rows.partner == -3
    assert floor.sum() == 20
    earlier = 2 * math.sqrt(2 * (abs(ulps) + 4) * np.spacing(9.0))
    assert np.abs(rows.time[floor] - 8.0 * np.arange(1, 21)).max() <= 20 * earlier
    within("touching the ceiling: speed at the floor", np.abs(rows.velocity[floor, 1] - 4.0).max(), 1e-12)


def test_bounces_of_a_millionth_of_a_millionth():
    """Height 1e-12 above the floor, a thousand times; an ulp of the coordinate changes it by 2e-10 at each of them."""
    radius, height, bounces = 2.0**-20, 1e-12, 1000
    speed = math.sqrt(2 * height)
    gas = gas_of((1.0, 1.0), [(0.5, radius)], [(0.0, speed)], radius)
    simulation = simulation_of(gas, gravity=(0.0, -1.0))
    rows = record(simulation, Stop(events=bounces))
    change = bounces * np.spacing(radius) / height
    within(
        "bounces of height 1e-12: time of a thousand, relative", abs(rows.time[-1] / (bounces * 2 * speed) - 1), change
    )
    within("bounces of height 1e-12: speed, relative", np.abs(rows.velocity[:, 1] / speed - 1).max(), change)
    assert rows.position[:, 1].min() >= radius - np.spacing(radius)


@pytest.mark.parametrize("speed", [1.0, 2.0], ids=["four roots in one", "a double root"])
def test_a_multiple_root_at_a_wall_end(speed):
    """The top of a parabola touches a wall's end from above: a double root, fourfold for v² = gR.

    It only touches: the way goes on as if nothing were there, to the root of the rounding.
    """
    radius, end = 1.0, np.array([16.0, 16.0])
    start = np.array([16.0 - 4.0 * speed, 16.0 + radius - 8.0])
    gas = gas_of((32, 32), [start], [(speed, 4.0)], radius)  # at the top after 4, on top of the end
    simulation = simulation_of(gas, [(*end, 16.0, 8.0)], gravity=(0.0, -1.0))
    record(simulation, Stop(time=5.0))
    state = simulation.state()[0]
    energy = 0.5 * (state.velocity**2).sum() + state.position[0, 1]
    within("multiple roots: energy, relative", abs(energy / (0.5 * (speed**2 + 16.0) + start[1]) - 1), 1e-14)
    free = start + np.array([speed, 4.0]) * 5.0 + np.array([0.0, -12.5])
    within("multiple roots: place after the touch", np.abs(state.position[0] - free).max(), 1e-6)

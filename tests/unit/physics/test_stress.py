"""Terms of the momentum flow: flights against integrals, collisions under exchange, and the faces of walls."""

import numpy as np
import pytest
from helpers.effect_samples import make_flow
from helpers.support import gas_of
from scipy.integrate import quad

from idealgas.columns import Kind
from idealgas.effects.bundle import Effects
from idealgas.effects.wall import make_segments
from idealgas.engine.records import DISC
from idealgas.engine.resolve import resolve_pair, resolve_segment, resolve_side
from idealgas.jit import aligned
from idealgas.physics.exact_sum import BATCH, make_sums, stored, values
from idealgas.physics.gravity import Gravity
from idealgas.physics.rotation import Rotation
from idealgas.physics.stress import (
    COLLISIONAL,
    KINETIC,
    complete_flights,
    copy_of,
    energy_gained,
    flush,
    kinetic_flow,
)

pytestmark = pytest.mark.interpreted


def flow_of(faces=4, rough=False):
    """In a box whose middle is (5, 4)."""
    return make_flow(gas_of((10, 8), [(1, 1)], 0.0, 0.1), faces, 7 if rough else 6)


def discs(*rows):
    """Records of x, y, vx, vy, t, r, m."""
    record = aligned(len(rows), DISC)
    for disc, row in zip(record, rows, strict=True):
        for name, value in zip(("x", "y", "vx", "vy", "t", "r", "m"), row, strict=True):
            disc[name] = value
    return record


@pytest.mark.parametrize("gravity", [None, Gravity(0.7, -1.3)])
def test_a_flight_is_an_integral(gravity):
    g = gravity or (0.0, 0.0)
    result = kinetic_flow(2.5, 1.1, -0.4, 1.7, gravity)
    for part, (a, b) in zip(result, ((0, 0), (0, 1), (1, 1)), strict=True):
        v = [lambda t, k=k: (1.1, -0.4)[k] + g[k] * t for k in (a, b)]
        expected = quad(lambda t: 2.5 * v[0](t) * v[1](t), 0, 1.7, epsabs=1e-14)[0]  # noqa: B023
        assert part == pytest.approx(expected, rel=1e-13, abs=1e-15)


@pytest.mark.parametrize("rough", [False, True])
def test_exchanged_discs_give_the_same_bits(rough):
    draw = np.random.default_rng(2)
    for _ in range(50):
        angle, flows = draw.uniform(0, 2 * np.pi), []
        place = 1.5 * np.array([np.cos(angle), np.sin(angle)])
        rows = [(0, 0, *(place + draw.normal(size=2)), 0.1, 0.9, 1.0), (*place, *draw.normal(size=2), 0.2, 0.6, 3.0)]
        spin = draw.normal(size=2)
        for order in ((0, 1), (1, 0)):
            pair = discs(*(rows[k] for k in order))
            flow = flow_of(rough=rough)
            rotation = Rotation(spin.copy(), np.array([0.4, 0.5]), 0.5, 0.0) if rough else None
            effects = Effects(flow=flow, rotation=rotation)
            before = [(disc.vx, disc.vy) for disc in pair]
            resolve_pair(*pair, *order, 0.2, (0, 0), effects)
            flush(flow)
            flows.append(stored(flow.tensor))
            impulse = pair[0].m * (np.array([pair[0].vx, pair[0].vy]) - before[0])
            apart = np.array([pair[0].x - pair[1].x, pair[0].y - pair[1].y])
            xx, xy, yy, *yx = values(flow.tensor[COLLISIONAL])
            transfer = np.outer(impulse, apart)
            assert [[xx, xy], [yx[0] if rough else xy, yy]] == pytest.approx(transfer, rel=1e-12, abs=1e-14)
        assert np.array_equal(*flows)


@pytest.mark.parametrize("gravity", [None, Gravity(0.7, -1.3)])
def test_what_a_collision_adds(gravity):
    """What both discs carried up to their contact, and what one received there, times where it is from the other."""
    flow, pull = flow_of(), np.array(gravity or (0.0, 0.0))
    pair = discs((0, 0, 1.1, 0.3, 0.05, 1, 1), (1.9, 0.4, -0.6, 0.2, 0.15, 1, 3))
    flights = [(disc.m.item(), disc.vx.item(), disc.vy.item(), 0.2 - disc.t.item()) for disc in pair]
    resolve_pair(*pair, 0, 1, 0.2, (0, 0), Effects(flow=flow, gravity=gravity))
    flush(flow)
    carried = np.sum([kinetic_flow(*flight, gravity) for flight in flights], axis=0)
    assert values(flow.tensor[KINETIC]) == pytest.approx(carried, rel=1e-14)
    mass, vx, vy, delay = flights[0]
    received = mass * (np.array([pair[0].vx, pair[0].vy]) - [vx, vy] - pull * delay)
    (xx, xy), (_, yy) = np.outer(received, [pair[0].x - pair[1].x, pair[0].y - pair[1].y])
    assert values(flow.tensor[COLLISIONAL]) == pytest.approx([xx, xy, yy], rel=1e-13)
    assert abs(xx) > 0.5


def test_collisions_are_added_together_and_one_by_one():
    flow, other = flow_of(), flow_of()
    for _ in range(3 * BATCH + 5):
        for each in (flow, other):
            pair = discs((0, 0, 0.7, 0.1, 0, 1, 1), (2, 0.1, -0.3, 0.2, 0, 1, 2))
            resolve_pair(*pair, 0, 1, 0.05, (0, 0), Effects(flow=each))
        flush(other)
    assert flow.buffer.number[0] == 5
    flush(flow)
    assert stored(flow.tensor).tolist() == stored(other.tensor).tolist()
    assert values(flow.tensor).all()


def test_flights_in_the_air_and_energy_in_a_moving_frame():
    flow = flow_of()
    record = discs((0, 0, 1, 2, 0.5, 1, 1), (0, 0, -3, 1, 0.25, 1, 2))
    copy = copy_of(flow)
    complete_flights(record, 1.0, None, copy, None)
    assert values(copy.tensor[KINETIC]).tolist() == [0.5 + 13.5, 1.0 - 4.5, 2.0 + 1.5]
    assert not values(flow.tensor).any()
    assert copy_of(None) is None
    # From (1, 2) to (3, 1): ½ · 2 (9 + 1 - 1 - 4) at rest, and seen from (1, -1) ½ · 2 (4 + 4 - 0 - 9).
    assert energy_gained(2.0, 1.0, 2.0, 3.0, 1.0, 0.0, 0.0) == 5.0
    assert energy_gained(2.0, 1.0, 2.0, 3.0, 1.0, 1.0, -1.0) == -1.0


@pytest.mark.parametrize(("frame", "passed_on"), [(0.5, 0.0), (0.0, 2.25), (1.0, -2.25)])
def test_heat_flows_relative_to_a_frame(frame, passed_on):
    """Masses 3 and 1 at the velocities 1 and -1 come out of a head-on collision with 0 and 2.

    Flights carry m v²/2 · v t, with v as the frame sees it. In the collision the first disc, at -3/2 from the second,
    gains 0, -3/2 or 3/2: seen from the centre of mass, at rest, and from a frame as fast as the first.
    """
    flow = flow_of()._replace(heat=make_sums([1.0] * 4), vx=frame, vy=0.0)
    pair = discs((0, 0, 1, 0, 0.25, 1, 3), (2.25, 0, -1, 0, 0.5, 1, 1))
    resolve_pair(*pair, 0, 1, 0.75, (0, 0), Effects(flow=flow))
    complete_flights(pair, 1.25, None, flow, None)
    flights = ((3, 1, 0.5), (1, -1, 0.25), (3, 0, 0.5), (1, 2, 0.5))
    carried = sum(m / 2 * (v - frame) ** 3 * t for m, v, t in flights)
    assert values(flow.heat) == pytest.approx([carried, 0, passed_on, 0], rel=1e-14, abs=1e-14)


@pytest.mark.parametrize(
    ("side", "velocity", "normal_impulse"), [(0, (-1, 2), 4), (1, (1, 2), 4), (2, (1, -2), 8), (3, (1, 2), 8)]
)
def test_sides_are_pushed_outwards(side, velocity, normal_impulse):
    flow = flow_of()
    (disc,) = discs((2, 7, *velocity, 0, 1, 2))
    resolve_side(disc, 0, side, 0.0, Effects(flow=flow))
    assert values(flow.normal_impulse).tolist() == [normal_impulse * (k == side) for k in range(4)]
    assert flow.hits.tolist() == [int(k == side) for k in range(4)]
    received = 2 * np.array([disc.vx - velocity[0], disc.vy - velocity[1]])
    assert values(flow.walls)[0] == -((2 - 5) * received[0] + (7 - 4) * received[1])


@pytest.mark.parametrize("face", [0, 1])
@pytest.mark.parametrize(("at_end", "kind"), [(False, Kind.WALL), (True, Kind.WALL_END)])
def test_both_faces_of_a_segment(face, at_end, kind):
    """A slanted wall: what both faces receive, normal and along, is what the disc loses."""
    segments = make_segments(np.array([[1.0, 1.0]]), np.array([[4.0, 5.0]]))
    tangent = np.array([0.6, 0.8])
    left = np.array([-0.8, 0.6]) * (1 if face == 0 else -1)
    foot = np.array([4.0, 5.0]) + 0.3 * tangent if at_end else np.array([2.2, 2.6])
    place = foot + left * (np.sqrt(1 - 0.09) if at_end else 1.0)
    flow = flow_of(6)
    velocity = -left + 0.25 * tangent
    (disc,) = discs((*place, *velocity, 0, 1, 2))
    assert resolve_segment(disc, 0, 0, 0.0, (0, 0), segments, Effects(flow=flow, segments=segments)) == kind
    given = -2 * (np.array([disc.vx, disc.vy]) - velocity)
    k = 4 + face
    assert flow.hits.tolist() == [int(j == k) for j in range(6)]
    assert values(flow.normal_impulse)[k] > 0
    assert values(flow.normal_impulse)[k] * -left + values(flow.tangential_impulse)[k] * tangent == pytest.approx(
        given, rel=1e-12, abs=1e-14
    )
    assert abs(values(flow.tangential_impulse)[k]) > 0.1 or not at_end

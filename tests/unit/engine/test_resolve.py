"""What an event does to records and accounts: energies, momenta and faces, in numbers worked out by hand.

The oracle takes these functions too, so that a wrong entry would be the same in both.
"""

import numpy as np
import pytest
from helpers.effect_samples import make_flow
from helpers.rounding import body
from helpers.support import gas_of

from idealgas.columns import FIRST_SEGMENT, Kind
from idealgas.effects.bundle import Effects
from idealgas.effects.wall import make_segments
from idealgas.engine.resolve import (
    energy_of,
    face_of,
    resolve_pair,
    resolve_piston,
    resolve_segment,
    resolve_side,
    resolve_stop,
    resolve_thermostat_collision,
)
from idealgas.physics.exact_sum import make_sums, values
from idealgas.physics.gravity import Gravity
from idealgas.physics.periodic import Periodic
from idealgas.physics.restitution import Restitution
from idealgas.physics.rotation import Rotation
from idealgas.physics.shear import begin_epoch, make_shear
from idealgas.physics.thermal import Thermal
from idealgas.physics.thermostat import Thermostat
from idealgas.physics.vibration import VIBRATION

pytestmark = [pytest.mark.interpreted, pytest.mark.filterwarnings("ignore:overflow encountered")]

WALLS = FIRST_SEGMENT + 2


def disc(x, y, vx, vy, mass=2.0, radius=1.0, time=0.0):
    record = body(x=x, y=y, vx=vx, vy=vy, m=mass, r=radius, t=time)
    record.count = np.uint32(0)
    return record


def effects_of(**fields):
    """With all accounts, in a box of 10 by 8 with two walls inside."""
    sums = {"wall_energy": make_sums([1.0] * WALLS), "dissipated": make_sums([1.0] * (1 + WALLS))}
    flow = make_flow(gas_of((10, 8), [(1, 1)], 0.0, 0.1), FIRST_SEGMENT + 4)
    return Effects(**{**sums, "bath_energy": make_sums([1.0]), "flow": flow, **fields})


def inelastic(normal=0.5, wall=0.5):
    return Restitution(normal, wall, 0.1, np.full(2, -np.inf))


def accounts(effects):
    """Energies given by walls, and lost, by number, without zeros."""
    return [
        {k: value for k, value in enumerate(values(sums).tolist()) if value}
        for sums in (effects.wall_energy, effects.dissipated)
    ]


def box(**fields):
    return Periodic(True, False, 10.0, 8.0, np.zeros((2, 2), np.int32), **fields)


def segments():
    """Wall 4 along x at y = 3, wall 5 upwards at x = 5."""
    return make_segments(np.array([[2.0, 3.0], [5.0, 4.0]]), np.array([[6.0, 3.0], [5.0, 7.0]]))


def test_energy_of_motion_and_spin_and_what_two_discs_lose():
    spins = Rotation(np.array([0.0, 3.0]), np.array([1.0, 0.5]), 0.0, 0.0)
    assert energy_of(disc(0, 0, 1.0, -2.0), 1, None) == 5.0
    assert energy_of(disc(0, 0, 1.0, -2.0), 1, spins) == 7.25
    # Masses of 2 that approach at 3 lose ½ μ v² (1 - e²) = ½ · 1 · 9 · ¾.
    effects = effects_of(restitution=inelastic())
    a, b = disc(0, 0, 1, 0.5), disc(2.75, 0.125, -2, 0.5, time=0.25)
    resolve_pair(a, b, 0, 1, 0.5, (0, 0), effects)
    assert accounts(effects) == [{}, {0: 3.375}]
    assert (a.x, b.x, a.vx, b.vx, a.vy, a.t, b.t) == (0.5, 2.25, -1.25, 0.25, 0.5, 0.5, 0.5)
    assert (a.y, b.y, b.vy) == (0.25, 0.25, 0.5)
    assert (a.count, b.count, effects.restitution.last.tolist()) == (1, 1, [0.5, 0.5])


@pytest.mark.parametrize(
    ("side", "velocity", "after"),
    [(0, (-2, 1), (1, 1)), (1, (2, 1), (-1, 1)), (2, (1, -2), (1, 1)), (3, (1, 2), (1, -1))],
)
def test_a_loss_is_booked_to_its_side(side, velocity, after):
    """½ · 2 (4 - 1), which an elastic wall would have given back; the face receives 2 (2 + 1)."""
    effects = effects_of(restitution=inelastic())
    record = disc(4, 3, *velocity)
    resolve_side(record, 0, side, 0.5, effects)
    assert accounts(effects) == [{side: -3.0}, {1 + side: 3.0}]
    assert (record.x, record.y) == (4 + velocity[0] / 2, 3 + velocity[1] / 2)
    assert (record.vx, record.vy) == after
    assert values(effects.flow.normal_impulse).tolist() == [6.0 * (k == side) for k in range(8)]


def test_a_thermal_side_gives_heat_and_loses_none():
    hot = Thermal(np.array([-1.0, -1.0, 2.0, -1.0, -1.0, -1.0]), np.uint64(1), np.zeros(2, np.uint64))
    effects = effects_of(restitution=inelastic(), thermal=hot)
    record = disc(4, 1, 1, -2)
    resolve_side(record, 1, 2, 0.0, effects)
    assert accounts(effects) == [{2: pytest.approx(record.vx**2 + record.vy**2 - 5, rel=1e-12)}, {}]
    assert record.vy > 0
    assert hot.emissions.tolist() == [0, 1]


def test_a_vibrating_side_does_work_on_the_disc():
    """At its mean height it moves with a t = 2 into the box: from -1 the disc comes to 5, and gains ½ · 2 (25 - 1)."""
    vibration = np.zeros(4, VIBRATION).view(np.recarray)
    vibration[2] = (0.5, 4.0, 1.0, 0.0, 0.0)  # amplitude, acceleration, half a period, start, no sine
    for restitution, lost, after in ((None, 0.0, 5.0), (inelastic(), 9 * 0.75, 3.5)):
        effects = effects_of(vibration=vibration, restitution=restitution)
        record = disc(4, 1.5, 3, -1, time=0.5)
        resolve_side(record, 0, 2, 0.5, effects)
        assert (record.vx, record.vy) == (3.0, after)
        assert accounts(effects) == [{2: after**2 - 1}, {3: lost} if lost else {}]


@pytest.mark.parametrize(
    ("segment", "place", "velocity", "face"),
    [
        (0, (4, 4), (0.5, -2), 4),  # from above: on its left
        (0, (4, 2), (0.5, 2), 5),
        (1, (4, 5), (2, 0.5), 6),
        (1, (6, 5), (-2, 0.5), 7),
    ],
)
def test_both_faces_of_walls_inside(segment, place, velocity, face):
    """Faces of a wall come in the order left, right; the normal impulse on each is positive."""
    effects = effects_of(segments=segments(), restitution=inelastic())
    kind = resolve_segment(disc(*place, *velocity), 0, segment, 0.0, (0, 0), effects.segments, effects)
    assert kind == Kind.WALL
    assert accounts(effects) == [{4 + segment: -3.0}, {5 + segment: 3.0}]
    assert values(effects.flow.normal_impulse).tolist() == [6.0 * (k == face) for k in range(8)]
    assert effects.flow.hits.tolist() == [int(k == face) for k in range(8)]
    assert [face_of(4 + segment, left) for left in (True, False)] == [face - face % 2, face - face % 2 + 1]


def test_an_absorbed_disc_takes_its_whole_energy_along():
    """½ · 2 (4 + 0.25) and -m g·r = 2 · 4, where it is in space: three boxes to the right, which changes nothing."""
    absorbing = np.array([True, False])
    effects = effects_of(segments=segments(), absorbing=absorbing, gravity=Gravity(0.0, -1.0), periodic=box())
    effects.periodic.image[0] = (3, 0)
    record = disc(4, 4, 0.5, -2)
    assert resolve_segment(record, 0, 0, 0.0, (0, 0), effects.segments, effects) == Kind.ESCAPED
    assert accounts(effects) == [{4: -(4.25 + 8.0)}, {}]
    assert values(effects.flow.normal_impulse)[4] == 4.0
    pulled = effects._replace(gravity=Gravity(-1.0, 0.0), wall_energy=make_sums([1.0] * WALLS))
    resolve_segment(disc(4, 4, 0.5, -2), 0, 0, 0.0, (0, 0), pulled.segments, pulled)
    assert accounts(pulled) == [{4: -(4.25 + 2 * (4 + 30))}, {}]


def test_the_work_of_a_sheared_image():
    """The image above moves with u = 4: discs of masses 2 and 6, the second one there, meet head on along x.

    Half-way between the boxes they have the velocities -1 and 3, and 5 and 1 after the collision: 7 and -1 in their
    boxes. The kinetic energy of both grows from 1 + 3 to 49 + 3, by u times the momentum 12 that passes the top.
    """
    shear = make_shear(0.5, (10.0, 8.0))
    begin_epoch(shear, 0.0, 1.0)
    effects = effects_of(shear=shear, periodic=box(shear=shear), flow=None)
    a, b = disc(4, 7.5, 1, 0), disc(2, -0.5, 1, 0, mass=6.0)
    resolve_pair(a, b, 0, 1, 0.0, (0, 1), effects)
    before = 0.5 * 2 * 1 + 0.5 * 6 * 1
    after = 0.5 * 2 * a.vx**2 + 0.5 * 6 * b.vx**2
    assert (a.vx, b.vx) == (7.0, -1.0)
    assert accounts(effects) == [{3: after - before}, {}]
    assert after - before == 48.0


def test_a_disc_that_crosses_a_sheared_side_is_slowed():
    """By u = 4 to -1: ½ · 2 (1 - 9), given by the side that it crosses; no collision."""
    shear = make_shear(0.5, (10.0, 8.0))
    begin_epoch(shear, 0.0, 1.0)
    effects = effects_of(shear=shear, periodic=box(shear=shear), flow=None, restitution=inelastic())
    record = disc(4, 8, 3, 1)
    resolve_side(record, 0, 3, 0.0, effects)
    assert (record.y, record.vx, record.count) == (0.0, -1.0, 1)
    assert accounts(effects) == [{3: -8.0}, {}]
    assert effects.periodic.image[0].tolist() == [0, 1]
    assert effects.restitution.last.tolist() == [-np.inf, -np.inf]


def piston(mass, outward=1.0, velocity=-1.0, wall=1, place=6.0):
    record = body(x=place, v=velocity, a=0.0, m=mass, length=10.0, outward=outward)
    record.wall, record.axis, record.count = wall, 0, np.uint32(0)
    return record


@pytest.mark.parametrize(
    ("mass", "restitution", "after", "given", "lost"),
    [
        (0.0, None, (-4.0, -1.0), 16.0 - 4.0, 0.0),
        (0.0, 0.5, (-2.5, -1.0), 6.25 - 4.0, 9 * 0.75),
        (4.0, None, (-2.0, 1.0), 0.0, 0.0),
        (4.0, 0.5, (-1.0, 0.5), 1.0 - 4.0, 0.75 * 0.5 * (4 / 3) * 9),
    ],
)
def test_energies_at_a_piston(mass, restitution, after, given, lost):
    """A disc of mass 2 and velocity 2 meets it at -1: work of a given motion, or an exchange with a mass."""
    effects = effects_of(piston=[piston(mass)], restitution=restitution and inelastic())
    record = disc(5, 4, 2, 1)
    assert resolve_piston(record, 0, 0, 0.0, effects.piston, effects) == 1
    assert (record.vx, record.vy, effects.piston[0].v) == pytest.approx((after[0], 1.0, after[1]), rel=1e-15)
    assert accounts(effects) == [
        {1: pytest.approx(given, rel=1e-14)} if given else {},
        {2: pytest.approx(lost, rel=1e-14)} if lost else {},
    ]
    assert effects.piston[0].count == (mass > 0)
    assert values(effects.flow.normal_impulse)[1] == pytest.approx(2 * (2 - after[0]), rel=1e-14)


@pytest.mark.parametrize(("x", "velocity", "face"), [(5.0, 2.0, 6), (7.0, -4.0, 7)])
def test_both_faces_of_an_inner_piston(x, velocity, face):
    """Wall 5, which points upwards: the gas before it is on its left."""
    effects = effects_of(piston=[piston(0.0, outward=0.0, wall=5)])
    resolve_piston(disc(x, 4, velocity, 0), 0, 0, 0.0, effects.piston, effects)
    assert effects.flow.hits.tolist() == [int(k == face) for k in range(8)]
    assert values(effects.flow.normal_impulse)[face] == 2 * 2 * abs(velocity + 1)


def test_a_piston_turns_at_a_side():
    moving = piston(3.0, velocity=-1.5)
    resolve_stop(0, 4.0, [moving])
    assert (moving.x, moving.v, moving.t, moving.count) == (0.0, 1.5, 4.0, 1)


def test_what_the_heat_bath_gives():
    """The energy of the disc afterwards less that before; in a sheared gas about the flow, no contact duration."""
    given = []
    for shear in (None, make_shear(0.5, (10.0, 8.0))):
        bath = Thermostat(2.0, 0.5, np.uint64(7), np.zeros(2), np.zeros(2, np.uint64))
        effects = effects_of(shear=shear, restitution=inelastic())
        record = disc(4, 6, 1, -2)
        resolve_thermostat_collision(record, 1, 0.5, bath, effects)
        assert values(effects.bath_energy)[0] == pytest.approx(record.vx**2 + record.vy**2 - 5, rel=1e-12)
        assert bath.number.tolist() == [0, 1]
        assert effects.restitution.last.tolist() == [-np.inf, -np.inf]
        given.append(record)
    assert given[1].vx - given[0].vx == pytest.approx(0.5 * (5 - 4), rel=1e-14)  # at y = 6 - 2 · 0.5
    assert given[1].vy == given[0].vy

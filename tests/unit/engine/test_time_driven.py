"""Time steps: beside the same method written plainly, in slices, over epochs; and how wrong they are, by theory."""

import math

import numpy as np
import pytest
from helpers.log_compare import differences
from helpers.rounding import body
from helpers.support import gas_of, record, same_rows

from idealgas.columns import Kind
from idealgas.effects.bundle import Effects
from idealgas.engine.simulation import Simulation, Stop
from idealgas.engine.time_driven import TimeDriven, first_step_after, make_nearby, side_beyond
from idealgas.log import open_log
from idealgas.physics.gravity import Gravity
from idealgas.physics.periodic import Periodic
from idealgas.run.resume import resume
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

BOX = (10.0, 8.0)


def some_gas(n=60, seed=1, radius=0.25, box=BOX):
    random = np.random.default_rng(seed)
    columns = math.ceil(math.sqrt(n * box[0] / box[1]))
    rows = -(-n // columns)
    place = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1).reshape(-1, 2)[:n]
    position = (place + 0.5) * [box[0] / columns, box[1] / rows]
    return gas_of(box, position, random.normal(size=(n, 2)), radius)


def effects_of(n=60, gravity=False, periodic=(), box=BOX):
    image = np.zeros((n, 2), np.int32)
    return Effects(
        gravity=Gravity(0.1, -0.5) if gravity else None,
        periodic=Periodic("x" in periodic, "y" in periodic, *box, image) if periodic else None,
    )


def plainly(gas, dt, steps, effects):
    """(step, disc, partner) of all that happens: all pairs in every step, none of them twice."""
    position, velocity = gas.position.copy(), gas.velocity.copy()
    pull = np.array(effects.gravity or (0.0, 0.0))
    periodic = np.array(effects.periodic[:2] if effects.periodic else (False, False))
    events = []
    for step in range(1, steps + 1):
        position += velocity * dt + 0.5 * pull * dt**2
        velocity += pull * dt
        for i in range(len(gas)):
            for side in range(4):
                axis, upper = divmod(side, 2)
                gap = gas.box[axis] - position[i, axis] if upper else position[i, axis]
                if gap < gas.radius[i] and velocity[i, axis] * (1 if upper else -1) > 0 and not periodic[axis]:
                    velocity[i, axis] *= -1
                    events.append((step, i, -1 - side))
        for i in range(len(gas)):
            for j in range(i + 1, len(gas)):
                apart = position[i] - position[j]
                apart -= np.where(periodic, gas.box * np.round(apart / gas.box), 0.0)
                closing = (velocity[i] - velocity[j]) @ apart
                if apart @ apart < (gas.radius[i] + gas.radius[j]) ** 2 and closing < 0:
                    change = closing * apart / (apart @ apart)
                    velocity[i] -= change
                    velocity[j] += change
                    events += [(step, i, j), (step, j, i)]
    return sorted(events), position, velocity


@pytest.mark.interpreted
@pytest.mark.parametrize("gravity", [False, True])
@pytest.mark.parametrize("periodic", ["", "x", "xy"])
@pytest.mark.slow
def test_it_does_what_the_plain_method_does(gravity, periodic):
    gas, dt, steps = some_gas(radius=0.2), 0.02, 120  # no three overlap: the order of collisions does not matter
    effects = effects_of(gravity=gravity, periodic=periodic)
    made = Simulation(gas, TimeDriven(dt), effects)
    rows = record(made, Stop(time=dt * (steps + 0.5)))
    expected, position, velocity = plainly(gas, dt, steps, effects)
    assert sorted(zip(np.rint(rows.time / dt), rows.disc, rows.partner, strict=True)) == expected
    assert {kind.value for kind in (Kind.DISC,)} <= set(rows.kind.tolist())
    end = made.state()[0]
    left = dt / 2
    position += velocity * left + 0.5 * np.array(effects.gravity or (0.0, 0.0)) * left**2
    offset = end.position - position
    boxes = np.round(offset / gas.box)
    assert np.abs(offset - boxes * gas.box).max() < 1e-10
    assert "x" in periodic or not boxes.any()


@pytest.mark.interpreted
@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("periodic", ["", "xy"])
def test_few_discs_do_what_the_plain_method_does(periodic):
    gas, dt, steps = some_gas(16, radius=0.4), 0.05, 60
    effects = effects_of(16, gravity=True, periodic=periodic)
    made = Simulation(gas, TimeDriven(dt), effects)
    rows = record(made, Stop(time=dt * (steps + 0.5)))
    expected, _, velocity = plainly(gas, dt, steps, effects)
    assert sorted(zip(np.rint(rows.time / dt), rows.disc, rows.partner, strict=True)) == expected
    assert (rows.kind == Kind.DISC).sum() > 20
    velocity += np.array(effects.gravity) * dt / 2
    assert np.abs(made.state()[0].velocity - velocity).max() < 1e-10


@pytest.mark.interpreted
@pytest.mark.usefixtures("uncompiled")
def test_a_head_on_collision_is_found_at_the_end_of_a_step():
    """3 - 2 · 0.4 k apart: below 1 after three steps, by 0.4 of the sum of the radii."""
    gas = gas_of(BOX, [(2.0, 4.0), (5.0, 4.0)], [(1.0, 0.0), (-1.0, 0.0)], 0.5)
    made = Simulation(gas, TimeDriven(0.4))
    rows = record(made, Stop(time=2.0))
    assert rows.time == pytest.approx([1.2, 1.2], rel=1e-15)
    assert rows.velocity.tolist() == [[-1.0, 0.0], [1.0, 0.0]]
    assert made.check_invariants_of(made.state()[0]).overlap == pytest.approx(0.4, rel=1e-14)


@pytest.mark.interpreted
@pytest.mark.usefixtures("uncompiled")
def test_discs_that_both_move_are_listed_in_time():
    """They are a gap and a half of the skin apart at first, and no pair: each flies three quarters of it."""
    skin = make_nearby(gas_of(BOX, [(2.0, 4.0), (8.0, 4.0)], 0.0, 0.25), (False, False)).skin
    dt, away = skin / 40, 0.25 + 0.75 * skin
    gas = gas_of(BOX, [(5.0 - away, 4.0), (5.0 + away, 4.0)], [(1.0, 0.0), (-1.0, 0.0)], 0.25)
    rows = record(Simulation(gas, TimeDriven(dt)), Stop(disc_collisions=1))
    assert rows.time == pytest.approx([31 * dt] * 2, rel=1e-12)  # after 30 steps they touch


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("place", "velocity", "side"),
    [((0.4, 4), (-1, 0), 0), ((0.4, 4), (1, 0), -1), ((9.6, 4), (1, 0), 1), ((9.6, 4), (-1, 0), -1),
     ((4, 0.4), (0, -1), 2), ((4, 7.6), (0, 1), 3), ((0.5, 4), (-1, 0), -1), ((0.4, 0.4), (-1, -1), 0)],
)  # fmt: skip
def test_discs_beyond_a_side_on_their_way_out(place, velocity, side):
    disc = body(x=place[0], y=place[1], vx=velocity[0], vy=velocity[1], r=0.5)
    assert side_beyond(disc, BOX, None) == side
    assert side_beyond(disc, BOX, effects_of(1, periodic="xy").periodic) == -1


@pytest.mark.parametrize(("rows", "events"), [(3, 1 << 62), (17, 5), (4096, 1)])
def test_neither_batches_nor_slices_change_anything(rows, events):
    stop = Stop(time=12.0)
    whole = Simulation(some_gas(), TimeDriven(0.05))
    parts = Simulation(some_gas(), TimeDriven(0.05))
    assert same_rows(record(whole, stop), record(parts, stop, rows, events))
    assert whole.state()[0].position.tolist() == parts.state()[0].position.tolist()
    assert whole.check_invariants_of(whole.gas).overlap == parts.check_invariants_of(parts.gas).overlap > 0


@pytest.mark.interpreted
@pytest.mark.parametrize("dt", [2.3331434616323543, 0.1, 1 / 3])
def test_no_step_is_left_out_between_epochs(dt):
    for end in (28_672.0, 4096.0, 3 * dt, 7 * dt):
        number = first_step_after(end, dt)
        assert number * dt > end >= (number - 1) * dt
    assert first_step_after(28_672.0, 2.3331434616323543) == 12_289  # 0.000000000004 later


@pytest.mark.slow
def test_a_resumed_run_has_the_log_of_one_without_a_break(tmp_path):
    scene = parse_scene(
        'species = [{name = "a", count = 60, radius = 0.5, temperature = 1}]\nbox.size = [20, 20]\n'
        'run = {method = "time_driven", dt = 0.05, until = 600}'
    )
    whole, cut_off, calls = tmp_path / "whole.h5", tmp_path / "cut.h5", []
    simulate(scene, whole)
    assert not simulate(scene, cut_off, interrupted=lambda: calls.append(1) or len(calls) > 3).completed
    assert resume(cut_off).completed
    assert differences(whole, cut_off) == []
    with open_log(whole) as log:
        overlaps = log.observables["overlap"][1]
    assert len(set(overlaps.tolist())) == len(overlaps) > 5


def test_it_stops_in_the_middle_of_a_step():
    made = Simulation(some_gas(), TimeDriven(0.05))
    rows = record(made, Stop(events=101))
    assert made.counters.events == 101
    assert len(rows.time) == 2 * made.counters.disc_collisions + made.counters.wall_hits
    whole = record(Simulation(some_gas(), TimeDriven(0.05)), Stop(events=400))
    assert np.array_equal(whole.velocity[: len(rows.time)], rows.velocity)


def test_it_goes_on_from_the_start_of_any_epoch():
    stop = Stop(time=150.0)
    gas, dt = some_gas(), 0.03
    whole = record(Simulation(gas, TimeDriven(dt)), stop)
    made = Simulation(gas, TimeDriven(dt))
    while made.epoch < 2:
        made.advance(Stop(), None)
        made.next_epoch()
    again = Simulation(made.gas, TimeDriven(dt), time=made.time, epoch=made.epoch, totals=made.totals)
    rest = record(again, stop)
    assert same_rows(whole.rows(len(whole.time) - len(rest.time), len(whole.time)), rest)
    assert len(rest.time) > 100
    assert np.abs(whole.time / dt - np.rint(whole.time / dt)).max() < 1e-10  # steps end at multiples of dt


def test_it_neither_makes_nor_loses_energy():
    made = Simulation(some_gas(seed=4), TimeDriven(0.1))
    record(made, Stop(time=200.0))
    assert made.state()[0].kinetic_energy == pytest.approx(some_gas(seed=4).kinetic_energy, rel=1e-12)


@pytest.mark.slow
def test_a_longer_list_is_made_where_the_first_is_too_short():
    """A crowd in a corner of an empty box has far more pairs near each other than the same discs all over it."""
    k = np.arange(100)
    place = np.column_stack((k % 10, k // 10)) * 0.15 + 0.5
    gas = gas_of(BOX, place, np.random.default_rng(3).normal(size=place.shape), 0.02)
    near = make_nearby(gas, (False, False))
    distance = np.hypot(*(place[:, None] - place).T)
    assert (distance < 0.04 + near.skin).sum() / 2 > 2 * len(near.pairs)
    dt, steps = 0.002, 100
    made = Simulation(gas, TimeDriven(dt))
    rows = record(made, Stop(time=dt * (steps + 0.5)))
    expected, _, velocity = plainly(gas, dt, steps, Effects())
    assert sorted(zip(np.rint(rows.time / dt), rows.disc, rows.partner, strict=True)) == expected
    assert len(expected) > 20
    assert np.abs(made.state()[0].velocity - velocity).max() < 1e-10  # each collision multiplies roundings


# how wrong it is


def lanes(n, seed=2):
    """Discs that fly to and fro between left and right, each in a lane of its own, with speeds from 1 to 2."""
    random = np.random.default_rng(seed)
    position = np.column_stack((random.uniform(0.2, 9.8, n), np.arange(n) + 0.5))
    velocity = np.column_stack((random.uniform(1, 2, n), np.zeros(n)))
    return gas_of((10.0, float(n)), position, velocity, 0.2)


@pytest.mark.parametrize("dt", [0.8, 0.2, 0.05])
def test_a_flight_from_wall_to_wall_takes_a_step_too_long(dt):
    """A wall is met half a step late on average, and takes as long to leave: the flight of ℓ/v lasts ℓ/v + dt.

    So the rate of wall hits is too low by v dt/ℓ, to first order. Phases are uniform: k = 4 standard errors.
    """
    gas = lanes(4000)
    rows = record(Simulation(gas, TimeDriven(dt)), Stop(time=60.0))
    order = np.lexsort((rows.time, rows.disc))
    same = np.diff(rows.disc[order].astype(int)) == 0
    flight = np.diff(rows.time[order])[same]
    disc = rows.disc[order][1:][same]
    extra = flight - 9.6 / gas.velocity[disc, 0]
    mean = np.bincount(disc, extra) / np.bincount(disc)
    assert abs(mean.mean() - dt) < 4 * mean.std() / math.sqrt(len(gas))
    assert mean.std() > 0


def passing_pairs(n, speed, seed=3):
    """Pairs that meet with uniform impact parameters, at uniform phases of a step of any length below 1."""
    random = np.random.default_rng(seed)
    height = 12.0 * np.arange(n) + 6.0  # too far apart for those that are turned aside to meet
    gap = 1.0 + speed * random.uniform(1, 2, n)
    offset = random.uniform(-1, 1, n)
    left = np.column_stack((np.full(n, 10.0), height))
    right = np.column_stack((10.0 + gap, height + offset))
    velocity = np.concatenate((np.tile([speed, 0.0], (n, 1)), np.zeros((n, 2))))
    return gas_of((40.0, 12.0 * n), np.concatenate((left, right)), velocity, 0.5), offset


@pytest.mark.parametrize("dt", [1.0, 0.5, 0.25])
def test_pairs_are_missed_as_often_as_geometry_says(dt):
    """Approaching overlap lasts √(S² - b²)/w; with a uniform phase, a share 1 - √(S² - b²)/(w dt) falls between steps.

    Averaged over b, with S = 1 and for h = w dt <= S: h²/6 + O(h⁴). Binomial, k = 4 standard errors.
    """
    n, speed = 20_000, 1.0
    gas, offset = passing_pairs(n, speed)
    rows = record(Simulation(gas, TimeDriven(dt)), Stop(time=6.0))
    met = np.zeros(n, bool)
    met[rows.disc[rows.kind == Kind.DISC] % n] = True
    h = speed * dt
    safe = math.sqrt(1 - h**2)
    expected = (1 - safe) - (math.acos(safe) - safe * h) / (2 * h)
    assert expected == pytest.approx(h**2 / 6, rel=0.3 * h**2)
    assert abs(1 - met.mean() - expected) < 4 * math.sqrt(expected * (1 - expected) / n)
    assert met[np.sqrt(1 - offset**2) > speed * dt].all()


def test_contacts_are_found_half_a_step_late():
    """The delay of those that cannot be missed is uniform from 0 to dt: k = 4 standard errors of its mean."""
    n, speed, dt = 20_000, 1.0, 0.25
    gas, offset = passing_pairs(n, speed)
    rows = record(Simulation(gas, TimeDriven(dt)), Stop(time=6.0))
    first = (rows.kind == Kind.DISC) & (rows.disc < n)
    pair = rows.disc[first]
    contact = (gas.position[n + pair, 0] - 10.0 - np.sqrt(1 - offset[pair] ** 2)) / speed
    safe = np.sqrt(1 - offset[pair] ** 2) > speed * dt
    delay = (rows.time[first] - contact)[safe]
    assert delay.min() > -1e-12
    assert delay.max() < dt * (1 + 1e-12)
    assert abs(delay.mean() - dt / 2) < 4 * dt / math.sqrt(12 * len(delay))

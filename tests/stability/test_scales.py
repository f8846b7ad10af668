"""Gases of extreme masses, radii, speeds, sizes and densities: what must hold at every collision, and closed forms."""

import math

import numpy as np
import pytest
from helpers.support import batches, gas_of, record, same_rows, within

from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop

U = 2.0**-53


def lattice_gas(columns, rows, pitch, radius, mass=1.0, speed=1.0, seed=0):
    """Discs on a square lattice with Gaussian velocities."""
    place = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1).reshape(-1, 2) * pitch + pitch / 2
    velocity = np.random.default_rng(seed).normal(size=place.shape) * np.broadcast_to(speed, len(place))[:, None]
    return gas_of((columns * pitch, rows * pitch), place, velocity, radius, mass)


def resolution(gas, fastest, length):
    """How well a double tells where a disc is: of the box, and of the way the fastest can go in an epoch."""
    return U * (max(gas.box) + fastest * length)


def assert_sound(gas, events):
    """Run and look at every event: time order, contact distance, discs inside the box, energy. Returns the last time.

    Distances may be off by four times the resolution. Energy to 1e-12: rounding is u an event and knows no direction.
    """
    simulation = Simulation(gas, EventDriven())
    now, contact, outside, energy = 0.0, 0.0, 0.0, 0.0
    for rows in batches(simulation, Stop(events=events)):
        assert (np.diff(rows.time, prepend=now) >= 0).all()
        now = rows.time[-1]
        known = resolution(gas, np.hypot(*rows.velocity.T).max(), simulation.length)
        first = np.flatnonzero(rows.partner > rows.disc.astype(np.int64))
        assert np.array_equal(rows.disc[first + 1], rows.partner[first])
        reach = gas.radius[rows.disc[first]] + gas.radius[rows.partner[first]]
        distance = np.hypot(*(rows.position[first] - rows.position[first + 1]).T)
        contact = max(contact, np.abs(distance - reach).max(initial=0) / known)
        beyond = np.abs(rows.position - np.array(gas.box) / 2) + gas.radius[rows.disc][:, None] - np.array(gas.box) / 2
        outside = max(outside, beyond.max() / known)
        energy = max(energy, abs(simulation.state()[0].kinetic_energy / gas.kinetic_energy - 1))
    within("extreme gases: contact distance, in resolutions", contact, 4)
    within("extreme gases: outside the box, in resolutions", outside, 4)
    within("extreme gases: energy, relative", energy, 1e-12)
    return now


def assert_same_as_oracle(gas, events):
    stop = Stop(events=events)
    first, second = (record(Simulation(gas, method()), stop) for method in (EventDriven, BruteForce))
    assert same_rows(first, second)


extremes = pytest.mark.parametrize(
    "gas",
    [
        pytest.param(lattice_gas(10, 10, 2.5, 1.0, mass=[1e12] + [1.0] * 99), id="one of mass 1e12"),
        pytest.param(lattice_gas(10, 10, 2.5, 1.0, mass=[1e-12] + [1.0] * 99), id="one of mass 1e-12"),
        pytest.param(lattice_gas(10, 10, 2.5, 1.0, mass=10.0 ** np.linspace(-6, 6, 100)), id="masses over 12 decades"),
        pytest.param(lattice_gas(10, 10, 2.5, [1.0] + [1e-4] * 99), id="one of radius 1 among 1e-4"),
        pytest.param(lattice_gas(10, 10, 2.5, 10.0 ** np.linspace(-4, 0, 100)), id="radii over 4 decades"),
        pytest.param(lattice_gas(10, 10, 2.5, 1.0, speed=[1e6] + [1.0] * 99), id="one hot among cold"),
        pytest.param(lattice_gas(10, 10, 2.5, 1.0, speed=[1.0] + [0.0] * 99), id="one hot among resting"),
        pytest.param(lattice_gas(10, 10, 2.5, 1.0, speed=10.0 ** np.linspace(-8, 8, 100)), id="speeds over 16 decades"),
        pytest.param(lattice_gas(100, 1, 2.0 + 1e-9, 1.0), id="a row with gaps of 1e-9"),
        pytest.param(lattice_gas(2, 2, 2.0 + 1e-9, 1.0), id="four discs that just fit"),
        pytest.param(lattice_gas(100, 1, 1e4, 0.5), id="a long way between"),
    ],
)


@extremes
def test_extreme_mixtures(gas):
    assert_sound(gas, 100_000)


@extremes
def test_extreme_mixtures_as_the_oracle_has_them(gas):
    assert_same_as_oracle(gas, 2_000)


@pytest.mark.parametrize("size", [1e-9, 1e9])
@pytest.mark.parametrize("speed", [1e-8, 1e8])
def test_extreme_units(size, speed):
    gas = lattice_gas(12, 12, 3.0 * size, size, speed=speed)
    end = assert_sound(gas, 50_000)
    assert 50 <= end * speed / size <= 5000


@pytest.mark.parametrize("length", [-100, -30, 30, 100])
@pytest.mark.parametrize("time", [-57, 0, 57])
def test_units_are_arbitrary(length, time):
    """Units larger by powers of two change exponents only: the motion is the same, digit for digit."""
    gas = lattice_gas(12, 12, 3.0, 1.0)
    scale, clock = 2.0**length, 2.0**time
    scaled = gas_of(
        (gas.box[0] * scale, gas.box[1] * scale), gas.position * scale, gas.velocity * scale / clock, gas.radius * scale
    )
    stop = Stop(events=20_000)
    rows, same = (record(Simulation(g, EventDriven()), stop) for g in (gas, scaled))
    assert np.array_equal(rows.disc, same.disc)
    assert np.array_equal(rows.partner, same.partner)
    assert np.array_equal(rows.time * clock, same.time)
    assert np.array_equal(rows.position * scale, same.position)
    assert np.array_equal(rows.velocity * scale / clock, same.velocity)


@pytest.mark.parametrize(("digits", "events"), [(0, 3), (1, 31), (2, 314), (3, 3141), (4, 31415), (6, 3141592)])
def test_digits_of_pi(digits, events):
    """A disc of mass 100^digits drives a light one against a wall: the hits count the digits of π, up to mass 1e12.

    Galperin, Regul. Chaotic Dyn. 8, 375 (2003). Each hit turns the state by 2 arctan(10^-digits), rounded by a few u;
    after all of them that is 1e-9 of a turn, and the next hit is a tenth of a turn away. Energy: u times the hits.
    """
    gas = gas_of((64, 1), [(1, 0.5), (2, 0.5)], [(0, 0), (-1, 0)], 0.25, [1.0, 100.0**digits])
    simulation = Simulation(gas, EventDriven())
    simulation.run(Stop(time=16.0))
    assert simulation.counters.events == events
    end = simulation.state()[0]
    assert end.velocity[1, 0] > 0.9
    within(
        "digits of π: energy, in u times hits",
        abs(end.kinetic_energy / gas.kinetic_energy - 1) / (U * max(events, 4)),
        1,
    )


def crystal(columns, rows, packing_fraction):
    """Discs on a hexagonal lattice that touches all walls when it is swollen to close packing."""
    height = 1 + (rows - 1) * math.sqrt(0.75)
    x, y = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) * math.sqrt(0.75) + 0.5)
    x += 0.5 * (np.arange(rows) % 2)[:, None]
    box = (columns + 0.5, height)
    radius = math.sqrt(packing_fraction * box[0] * box[1] / (math.pi * columns * rows))
    assert radius < 0.5
    place = np.column_stack((x.ravel(), y.ravel()))
    return gas_of(box, place, np.random.default_rng(4).normal(size=place.shape), radius)


@pytest.mark.parametrize(
    "collisions", [pytest.param(1_000_000, id="1e6"), pytest.param(10_000_000, id="1e7", marks=pytest.mark.long)]
)
def test_a_crystal(collisions):
    """φ = 0.88, 0.97 of close packing: every contact to 1e-12 σ, no deeper overlap, and the clock keeps going."""
    gas = crystal(40, 46, 0.88)
    simulation = Simulation(gas, EventDriven())
    now, deepest, contact = 0.0, 0.0, 0.0
    for rows in batches(simulation, Stop(disc_collisions=collisions)):
        assert rows.time[0] >= now
        assert rows.time[-1] > rows.time[0]
        now = rows.time[-1]
        first = np.flatnonzero(rows.partner > rows.disc.astype(np.int64))
        distance = np.hypot(*(rows.position[first] - rows.position[first + 1]).T)
        contact = max(contact, np.abs(distance / (2 * gas.radius[0]) - 1).max())
        deepest = max(deepest, simulation.check_invariants_of(simulation.state()[0]).overlap)
    case = f"crystal, {collisions:.0e} collisions"
    within(f"{case}: contact distance, in diameters", contact, 1e-12)
    within(f"{case}: overlap, in diameters", deepest, 1e-12)
    within(f"{case}: energy, relative", abs(simulation.state()[0].kinetic_energy / gas.kinetic_energy - 1), 1e-12)

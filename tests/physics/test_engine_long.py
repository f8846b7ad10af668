"""Contacts and energy in thin, dense and long runs, looked at during the run."""

import numpy as np
import pytest
from helpers.support import batches

from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop
from idealgas.initial.build import make_gas
from idealgas.scene import Box, Header, Run, Scene, Species


def gas_at(phi, number, seed=7):
    radius = (phi * 100 / (np.pi * number)) ** 0.5
    species = Species(name="gas", count=number, radius=radius, temperature=1.0)
    return make_gas(Scene(scene=Header(seed=seed), box=Box(size=(10.0, 10.0)), species=(species,), run=Run(events=1)))


@pytest.mark.parametrize("phi", [0.0003, 0.001, 0.003, 0.01, 0.1, 0.3, 0.6])
def test_every_collision_is_a_contact_and_keeps_the_energy(phi):
    """To 1e-12 of a diameter; where an epoch of as many events would take clocks too far, it has fewer."""
    gas = gas_at(phi, 200)
    simulation = Simulation(gas, EventDriven())
    contact, drift, overlap = 0.0, 0.0, simulation.check_invariants().overlap
    for rows in batches(simulation, Stop(disc_collisions=100_000), 800):  # about 4 collisions per disc
        first = np.flatnonzero(rows.partner > rows.disc.astype(np.int64))
        distance = np.hypot(*(rows.position[first] - rows.position[first + 1]).T)
        contact = max(contact, np.abs(distance / (2 * gas.radius[0]) - 1).max(initial=0.0))
        state = simulation.state()[0]
        drift = max(drift, abs(state.kinetic_energy / gas.kinetic_energy - 1))
        overlap = max(overlap, simulation.check_invariants_of(state).overlap)
    assert simulation.counters.disc_collisions == 100_000
    assert contact <= 1e-12
    assert overlap <= 1e-12
    assert drift <= 1e-12


@pytest.mark.long
def test_a_hundred_million_collisions():
    """Energy is a random walk of rounding errors, u a step and shared by N discs: 1e-12 is far."""
    gas = gas_at(0.1, 1000)
    simulation = Simulation(gas, EventDriven())
    stop = Stop(disc_collisions=100_000_000)
    max_errors, overlap = 0.0, 0.0
    for _ in simulation.slices(stop):
        max_errors = max(max_errors, abs(simulation.gas.kinetic_energy / gas.kinetic_energy - 1))
        overlap = max(overlap, simulation.check_invariants_of(simulation.state()[0]).overlap)
    print(f"energy drift {max_errors:.1e}, deepest overlap {overlap:.1e} in {simulation.epoch} epochs")
    assert max_errors <= 1e-12
    assert overlap <= 1e-12

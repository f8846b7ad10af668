"""A million collisions: every contact is one, nothing drifts, and rates and speeds are those of theory.

Standard errors come from blocks of time and allow for their correlation. Agreement is asked for within 4 of them: a
correct program fails that for 1 seed in 16 000.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from helpers.support import batches
from scipy import stats

from idealgas.analysis.core.autoregression import inefficiency
from idealgas.analysis.core.statistics import mean
from idealgas.analysis.theory import hard_discs
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop
from idealgas.initial.build import make_gas
from idealgas.scene import Box, Header, Run, Scene, Species
from idealgas.state import Gas

N = 1000
COLLISIONS = 1_000_000
BLOCKS = 256
FRAME = 4 * N  # rows between two looks at the speeds, about 4 collisions a disc

dense_and_thin = pytest.mark.parametrize("phi", [0.01, 0.1, 0.3])


class Record(NamedTuple):
    """What is kept of a run; contact is |r_ij|/σ - 1 at worst, speeds is (frames, N)."""

    gas: Gas
    end: float
    contact: float
    drift: float
    overlap: float
    epochs: int
    collision_times: np.ndarray
    speeds: np.ndarray


def gas_at(phi, number=N, seed=7):
    radius = (phi * 100 / (np.pi * number)) ** 0.5
    species = Species(name="gas", count=number, radius=radius, temperature=1.0)
    return make_gas(Scene(scene=Header(seed=seed), box=Box(size=(10.0, 10.0)), species=(species,), run=Run(events=1)))


@cache
def run(phi, collisions=COLLISIONS, number=N):
    """Collisions from Gaussian velocities, looked at one by one."""
    gas = gas_at(phi, number)
    simulation = Simulation(gas, EventDriven())
    sigma, energy = 2 * gas.radius[0], gas.kinetic_energy
    contact, drift, overlap = 0.0, 0.0, simulation.check_invariants().overlap
    times, speeds = [], []
    for rows in batches(simulation, Stop(disc_collisions=collisions), FRAME):
        first = np.flatnonzero(rows.partner > rows.disc.astype(np.int64))
        distance = np.hypot(*(rows.position[first] - rows.position[first + 1]).T)
        contact = max(contact, np.abs(distance / sigma - 1).max(initial=0.0))
        state = simulation.state()[0]
        drift = max(drift, abs(state.kinetic_energy / energy - 1))
        overlap = max(overlap, simulation.check_invariants_of(state).overlap)
        times.append(rows.time[first])
        speeds.append(np.hypot(*state.velocity.T))
    end = simulation.last_event_time
    return Record(gas, end, contact, drift, overlap, simulation.epoch, np.concatenate(times), np.array(speeds))


@dense_and_thin
def test_every_collision_is_a_contact(phi):
    """To 1e-12 of a diameter; clocks are rounded by u times the way flown in an epoch, up to 6144 diameters."""
    found = run(phi)
    assert len(found.collision_times) == COLLISIONS
    assert found.contact <= 1e-12
    assert found.overlap <= 1e-12


@pytest.mark.parametrize("phi", [0.0003, 0.001, 0.003, 0.6])
def test_contacts_are_as_close_in_thinner_and_denser_gases(phi):
    """Where an epoch of as many events would take clocks too far, it has fewer."""
    found = run(phi, collisions=100_000, number=200)
    assert found.contact <= 1e-12
    assert found.overlap <= 1e-12


@dense_and_thin
def test_energy_does_not_drift(phi):
    """A collision changes the energy by rounding, u or so of two discs' share: 1e6 of them stay far below 1e-12."""
    found = run(phi)
    assert found.drift <= 1e-12
    assert found.epochs >= 10


@dense_and_thin
def test_collision_rate(phi):
    """Enskog's rate, with what a closed box of N discs changes: `hard_discs.box_contacts`, `finite_speed_factor`."""
    found = run(phi)
    start = found.end / 8
    counts, edges = np.histogram(found.collision_times, BLOCKS, (start, found.end))
    contacts = hard_discs.box_contacts(found.gas.radius[:1], [N], found.gas.box)[0, 0]
    expected = contacts * hard_discs.mean_relative_speed(found.gas.temperature, 1.0, dof=2 * N)
    rate = mean(2 / N * counts / np.diff(edges), theory=expected)
    assert rate.standard_error < 2e-3 * expected
    assert abs(rate.deviation) <= 4


@dense_and_thin
def test_speeds(phi):
    """Kolmogorov and Smirnov, p > 0.001, against fixed total energy: P(speed > v) = (1 - m v²/2E)^(N - 1).

    Samples of a disc are thinned by their statistical inefficiency, at least two frames apart.
    """
    found = run(phi)
    speeds = found.speeds[len(found.speeds) // 8 :]
    spacing = 2 * int(np.ceil(inefficiency(speeds)))
    assert spacing <= 10
    samples = speeds[::spacing].ravel()
    assert len(samples) >= 30_000
    energy = found.gas.kinetic_energy
    test = stats.kstest(samples, lambda v: 1 - np.maximum(1 - v**2 / (2 * energy), 0) ** (N - 1))
    assert test.pvalue > 0.001


@pytest.mark.long
def test_a_hundred_million_collisions():
    """Energy is a random walk of rounding errors, u a step and shared by N discs: 1e-12 is far."""
    gas = gas_at(0.1)
    simulation = Simulation(gas, EventDriven())
    stop = Stop(disc_collisions=100_000_000)
    max_errors, overlap = 0.0, 0.0
    for _ in simulation.slices(stop):
        max_errors = max(max_errors, abs(simulation.gas.kinetic_energy / gas.kinetic_energy - 1))
        overlap = max(overlap, simulation.check_invariants_of(simulation.state()[0]).overlap)
    print(f"energy drift {max_errors:.1e}, deepest overlap {overlap:.1e} in {simulation.epoch} epochs")
    assert max_errors <= 1e-12
    assert overlap <= 1e-12

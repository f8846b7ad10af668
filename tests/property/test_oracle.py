"""The event-driven method writes the log of the brute-force method, float for float, whatever its cells and batches."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from helpers.logs import log_of
from helpers.support import gas_of, record, same_rows
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from idealgas.effects.bundle import Effects
from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop
from idealgas.state import Gas


class Case(NamedTuple):
    number: int
    phi: float
    aspect: float
    masses: tuple[float, ...]
    radii: tuple[float, ...]
    gridded: bool  # on a lattice, with velocities of a few values: many simultaneous events
    seed: int


cases = st.builds(
    Case,
    number=st.integers(1, 200),
    phi=st.floats(0.001, 0.6),
    aspect=st.sampled_from([1.0, 0.3, 4.0]),
    masses=st.sampled_from([(1.0,), (1.0, 7.0), (1e-3, 1.0, 1e3)]),
    radii=st.sampled_from([(1.0,), (1.0, 0.4), (1.0, 0.1, 0.7)]),
    gridded=st.booleans(),
    seed=st.integers(0, 2**32),
)


def make(case: Case) -> Gas:
    """Discs on a lattice, moved a little unless gridded; phi is what the largest would fill."""
    draw = np.random.default_rng(case.seed)
    columns = max(round(math.sqrt(case.number * case.aspect)), 1)
    rows = -(-case.number // columns)
    pitch = max(math.sqrt(math.pi / (4 * case.phi)), 1.02) * 2 * max(case.radii)
    site = np.arange(case.number)
    position = (np.column_stack((site % columns, site // columns)) + 0.5) * pitch
    radius = draw.choice(case.radii, case.number)
    slack = pitch / 2 - radius
    if case.gridded:
        velocity = draw.choice([-1.0, 0.0, 1.0], (case.number, 2))
    else:
        position += draw.uniform(-0.99, 0.99, position.shape) * slack[:, None] * 0.7
        velocity = draw.normal(size=(case.number, 2))
    box = (columns * pitch, rows * pitch)
    return gas_of(box, position, velocity, radius, draw.choice(case.masses, case.number))


def assert_same_log(case: Case, events: int) -> None:
    gas = make(case)
    stop = Stop(events=events)
    oracle = record(Simulation(gas, BruteForce()), stop)
    for filling, rows in ((None, 65_536), (0.1, 65_536), (3.0, 1_000), (1e9, 257)):
        result = record(Simulation(gas, EventDriven(filling)), stop, rows)
        assert same_rows(result, oracle), (filling, rows)


@settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(cases)
@example(Case(1, 0.5, 1.0, (1.0,), (1.0, 0.1, 0.7), True, 34527))  # delays differ, times are equal
def test_same_log_as_the_oracle(case):
    assert_same_log(case, 3_000)


@pytest.mark.interpreted
@settings(max_examples=4, deadline=None, derandomize=True)
@given(cases.filter(lambda case: case.number < 12))
def test_same_log_as_the_oracle_in_a_few_discs(case):
    assert_same_log(case, 40)


@pytest.mark.usefixtures("uncompiled")
@settings(max_examples=6, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(cases.filter(lambda case: case.number < 12))
def test_same_log_as_the_oracle_of_discs_that_do_not_interact(case):
    """All discs start at the same place, so that events of all discs are simultaneous, many more if gridded."""
    gas = make(case)
    gas = replace(gas, position=np.full_like(gas.position, min(gas.box) / 2))
    effects, stop = Effects(noninteracting=True), Stop(events=60)
    oracle = record(Simulation(gas, BruteForce(), effects), stop)
    assert len(oracle.time) == (60 if gas.velocity.any() else 0)
    assert (oracle.partner < 0).all()
    for filling, rows in ((None, 65_536), (0.1, 7), (1e9, 257)):
        assert same_rows(record(Simulation(gas, EventDriven(filling), effects), stop, rows), oracle), (filling, rows)


@pytest.mark.long
@settings(max_examples=300, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(cases)
def test_same_log_as_the_oracle_for_long(case):
    assert_same_log(case, 20_000)


def test_many_simultaneous_events():
    """A lattice whose discs all start touching a neighbour or a wall at once: ties decide, and all methods agree."""
    side = 10
    x, y = np.meshgrid(np.arange(side) * 2.0 + 1.0, np.arange(side) * 2.0 + 1.0)
    draw = np.random.default_rng(8)
    velocity = draw.choice([-1.0, 1.0], (side * side, 2))
    gas = gas_of((2.0 * side, 2.0 * side), np.column_stack((x.ravel(), y.ravel())), velocity, 1.0)
    stop = Stop(events=400)
    oracle = record(Simulation(gas, BruteForce()), stop)
    assert (np.diff(oracle.time) == 0).mean() > 0.9
    for filling in (0.1, 1.0, 1e9):
        result = record(Simulation(gas, EventDriven(filling)), stop, 100)
        assert same_rows(result, oracle)


@pytest.mark.parametrize("pull", [(0, -1e4), (1e4, 0), (-1e4, 3e3)], ids=["down", "right", "both"])
@pytest.mark.usefixtures("uncompiled")
def test_the_same_log_of_discs_that_turn_round_between_periodic_sides(pull):
    """At the speed 50 they turn back after v²/2g = 0.125, in a box of 6: often at a side that they never cross."""
    text = f"""
        scene.seed = 5
        box = {{ size = [6, 6], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic" }}
        run.events = 12
        gravity.acceleration = {list(pull)}
        species = [{{ name = "gas", count = 4, radius = 0.8, speed = 50 }}]
    """
    logs = []
    for method in ("event_driven", "brute_force"):
        log = log_of(text, f"run.method={method}")
        logs.append(list(log.chunks()))
    for each, other in zip(*logs, strict=True):
        assert all(np.array_equal(a, b) for a, b in zip(each, other, strict=True) if a is not None)

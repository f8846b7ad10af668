"""Epochs, stops and diagnostics of a simulation, on gases whose motion is known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.support import gas_of, record

from idealgas.effects.bundle import Effects
from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop
from idealgas.initial.build import make_gas
from idealgas.physics.gravity import Gravity
from idealgas.run.effects import make_effects
from idealgas.scene import parse_scene

pytestmark = pytest.mark.interpreted

methods = pytest.mark.parametrize("method", [EventDriven, BruteForce])


THREE = [(2, 5, 1, 0.1, 0.5), (8, 5.2, -1, 0, 0.5), (5, 8, 0.3, -0.4, 0.5)]


def discs_in(box, *discs):
    """Unit-mass discs from (x, y, vx, vy, radius)."""
    table = np.array(discs, float)
    return gas_of(box, table[:, :2], table[:, 2:4], table[:, 4])


def run(simulation, stop, batch_rows=64):
    """All rows up to the stop, as a list of (time, disc, partner)."""
    rows = record(simulation, stop, batch_rows)
    return list(zip(rows.time.tolist(), rows.disc.tolist(), rows.partner.tolist(), strict=True))


@methods
def test_events_of_one_disc_and_ties_come_in_their_order(method):
    simulation = Simulation(discs_in((10, 10), (5, 5, 1, 0, 1)), method())
    assert run(simulation, Stop(time=30.0)) == [(4, 0, -2), (12, 0, -1), (20, 0, -2), (28, 0, -1)]
    end = simulation.state()[0]
    assert end.position.tolist() == [[3, 5]]
    assert end.velocity.tolist() == [[1, 0]]
    simulation = Simulation(discs_in((10, 10), (5, 5, 1, 1, 1)), method())
    assert run(simulation, Stop(events=3)) == [(4, 0, -2), (4, 0, -4), (12, 0, -1)]
    discs = [(5, 2, 1, 0, 1), (5, 5, 1, 0, 1), (5, 8, 1, 0, 1)]
    simulation = Simulation(discs_in((10, 10), *discs), method())
    assert run(simulation, Stop(time=5.0)) == [(4, 0, -2), (4, 1, -2), (4, 2, -2)]


@methods
def test_stops_where_it_should_and_limits_count_from_time_0_through_all_calls(method):
    whole = run(Simulation(discs_in((10, 10), *THREE), method()), Stop(time=200.0))
    limited = Simulation(discs_in((10, 10), *THREE), method())
    assert run(limited, Stop(time=200.0, events=17)) == whole[: len(run_rows(whole, 17))]
    assert limited.counters.events == 17
    pairs = Simulation(discs_in((10, 10), *THREE), method())
    run(pairs, Stop(time=200.0, disc_collisions=5))
    assert pairs.counters.disc_collisions == 5
    early = Simulation(discs_in((10, 10), *THREE), method())
    assert run(early, Stop(time=20.0)) == [row for row in whole if row[0] <= 20.0]
    at_once, on_the_way = (Simulation(discs_in((10, 10), *THREE), method()) for _ in range(2))
    assert at_once.length > 5.0
    rows = run(on_the_way, Stop(time=2.0))
    assert on_the_way.finished(Stop(time=2.0))
    assert not on_the_way.finished(Stop(time=5.0))
    assert rows + run(on_the_way, Stop(time=5.0)) == run(at_once, Stop(time=5.0))
    made = Simulation(discs_in((10, 10), *THREE), method())
    for stop in (Stop(disc_collisions=2), Stop(disc_collisions=5)):
        run(made, stop)
        assert made.counters.disc_collisions == stop.disc_collisions
    for events in (made.counters.events + 3, made.counters.events + 5):
        run(made, Stop(events=events))
        assert made.counters.events == events


@methods
@pytest.mark.usefixtures("uncompiled")
def test_epochs_end_at_changes_and_time_counts_from_the_start_of_the_run(method):
    """The pull changes at t = 3, one after the start at t = 2; from there the disc falls to y = 5 + 1 - 2 · 1/2."""
    effects = Effects(gravity=Gravity(0.0, 0.0), schedule=((3.0, 0, 1, -2.0),))
    made = Simulation(discs_in((10, 10), (5, 5, 0, 1, 1)), method(), effects, time=2.0)
    assert (made.length, made.effects.gravity.y) == (1.0, 0.0)
    run(made, Stop(time=4.0))
    assert (made.reached, made.effects.gravity.y) == (4.0, -2.0)
    end = made.state()[0]
    assert end.position.tolist() == [[5.0, 6.0]]
    assert end.velocity.tolist() == [[0.0, -1.0]]


def run_rows(rows, events):
    """The rows of the first so many events."""
    taken, k = [], 0
    while k < len(rows) and events:
        step = 2 if rows[k][2] >= 0 else 1
        taken += rows[k : k + step]
        k, events = k + step, events - 1
    return taken


@methods
@pytest.mark.parametrize("rows", [3, 7, 1000])
def test_the_size_of_the_batch_changes_nothing(method, rows):
    stop = Stop(time=60.0)
    assert run(Simulation(discs_in((10, 10), *THREE), method()), stop, rows) == run(
        Simulation(discs_in((10, 10), *THREE), method()), stop
    )


@methods
def test_three_discs_in_line_pass_the_motion_on_and_discs_at_rest_end_at_the_end_time(method):
    discs = [(2, 5, 1, 0, 1), (5, 5, 0, 0, 1), (7, 5, 0, 0, 1)]
    simulation = Simulation(discs_in((20, 10), *discs), method())
    assert run(simulation, Stop(time=2.0)) == [(1, 0, 1), (1, 1, 0), (1, 1, 2), (1, 2, 1)]
    assert simulation.state()[0].velocity.tolist() == [[0, 0], [0, 0], [1, 0]]
    simulation = Simulation(discs_in((10, 10), (2, 2, 0, 0, 1), (4, 2, 0, 0, 1)), method())
    assert run(simulation, Stop(time=1e6)) == []
    assert simulation.finished(Stop(time=1e6))
    simulation = Simulation(discs_in((10, 10), (2, 2, 0, 0, 1)), method())
    assert run(simulation, Stop(events=5)) == []


@methods
def test_the_end_of_an_epoch_changes_only_records(method):
    simulation = Simulation(discs_in((10, 10), (5, 5, 1, 0.5, 1)), method())
    stop = Stop(time=4 * simulation.length)
    simulation.run(stop)
    assert simulation.epoch == 3
    assert simulation.time == 3 * simulation.length
    x = 1 + abs((4 + stop.time + 8) % 16 - 8)
    assert simulation.state()[0].position[0, 0] == pytest.approx(x, abs=1e-9)
    diagnostics = simulation.check_invariants_of(simulation.state()[0])
    assert diagnostics.kinetic_energy == pytest.approx(0.625, rel=1e-15)
    assert diagnostics.overlap == 0
    assert diagnostics.outside < 1e-15


def test_diagnostics_find_overlaps_and_escapes():
    discs = [(5, 5, 1, 0, 1), (6.5, 5, 0, 0, 1), (0.9, 2, 0, 0, 1)]
    for method in (EventDriven, BruteForce):
        diagnostics = Simulation(discs_in((10, 10), *discs), method()).check_invariants()
        assert diagnostics.overlap == pytest.approx(0.25)
        assert diagnostics.outside == pytest.approx(0.05)
    # A disc at a periodic side reaches across it by its radius; at the side that reflects another one by a tenth.
    scene = """
    box = { size = [10, 10], left = "periodic", right = "periodic" }
    disc = [{ position = [0.1, 5], radius = 1 }, { position = [5, 5], radius = 1, velocity = [1, 0] }]
    run.until = 1
    """
    scene = parse_scene(scene)
    gas = replace(make_gas(scene), position=np.array([[0.1, 5.0], [5.0, 0.8]]))
    diagnostics = Simulation(gas, BruteForce(), make_effects(scene, gas)).check_invariants()
    assert diagnostics.outside == pytest.approx(0.1)


@methods
def test_a_gas_keeps_its_energy_and_never_overlaps(method):
    draw = np.random.default_rng(5)
    places = [(2.0 * i + 1.5, 2.0 * j + 1.5) for i in range(4) for j in range(4)]
    discs = [(x, y, *draw.normal(size=2), 0.8) for x, y in places]
    simulation = Simulation(discs_in((9, 9), *discs), method())
    energy = simulation.gas.kinetic_energy
    stop = Stop(events=600)
    overlap = 0.0
    for _ in simulation.slices(stop, events=100):
        overlap = max(overlap, simulation.check_invariants_of(simulation.state()[0]).overlap)
    assert math.isclose(simulation.state()[0].kinetic_energy, energy, rel_tol=1e-13)
    assert overlap < 1e-13

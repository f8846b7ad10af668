"""Unit tests of idealgas.engine.event_driven.method: memory that epochs share."""

import numpy as np
import pytest
from helpers.effect_samples import make_effects, make_gas
from helpers.support import batches, joined, record, same_rows

from idealgas.effects.bundle import Effects
from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven import method
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop

several = pytest.mark.parametrize(
    "effects",
    [
        pytest.param(set(), id="plain"),
        pytest.param({"gates"}, id="gates", marks=pytest.mark.slow),
        pytest.param({"periodic", "piston"}, id="periodic and piston", marks=pytest.mark.slow),
    ],
)
STOP = Stop(events=20_000)  # several epochs


def simulation_of(engine, effects):
    gas = make_gas(3)
    return Simulation(gas, engine, make_effects(effects, gas) if effects else Effects())


def rows_of(engine, effects, each=1000):
    """Rows of a run whose states are looked at on the way."""
    simulation = simulation_of(engine, effects)
    result = record(simulation, STOP, events=each)
    assert simulation.epoch > 1
    return result


@several
@pytest.mark.parametrize("in_any_order", [0, 4096], ids=["sorted", "as they were"])
def test_epochs_in_the_memory_of_those_before_change_nothing(effects, in_any_order, monkeypatch):
    monkeypatch.setattr(method, "MAX_UNSORTED", in_any_order)
    for a, b in zip(rows_of(EventDriven(), effects), rows_of(BruteForce(), effects), strict=True):
        assert np.array_equal(a, b)


@several
def test_diagnostics_on_the_way_changes_nothing(effects):
    looked_at, quiet, rows = simulation_of(EventDriven(), effects), simulation_of(EventDriven(), effects), []
    for batch in batches(looked_at, STOP, events=1000):
        looked_at.check_invariants_of(looked_at.state()[0])
        rows.append(batch)
    assert same_rows(joined(rows), record(quiet, STOP, events=1000))
    assert looked_at.counters == quiet.counters
    for name in ("position", "velocity"):
        assert np.array_equal(getattr(looked_at.state()[0], name), getattr(quiet.state()[0], name))


def test_another_gas_has_memory_of_its_own():
    engine, few, many = EventDriven(), make_gas(1, 2, 2), make_gas(1)
    for gas in (many, few, many):
        engine.start(gas, make_effects(set(), gas))
        assert len(engine.discs.record) == len(gas)
        assert sorted(engine.discs.id) == list(range(len(gas)))
        assert np.array_equal(engine.discs.record.x, gas.position[engine.discs.id, 0])
        assert np.array_equal(engine.discs.record.r, gas.radius[engine.discs.id])

"""Analyses of a gas that a heat bath: its collisions are no hits of a wall, and its energy is on the account."""

import numpy as np
import pytest
from helpers.logs import gas

from idealgas import evolution, histogram
from idealgas.analysis.pressure.measure import pressure
from idealgas.columns import BATH, Kind
from idealgas.tallies.flights import Moments
from idealgas.tallies.impacts import Impacts
from idealgas.tallies.stream import stream
from idealgas.tallies.walls import WallImpulses

GAS = gas(
    40, 0.1, (8, 6), "until = 60", temperature=1.5, seed=3,
    then="log.pressure = true\nthermostat = { temperature = 2, rate = 0.5 }",
)  # fmt: skip


@pytest.mark.slow
def test_thermostat_collisions_hit_no_wall(log):
    """Sums over the rows of walls alone, and over the samples of a run that counts as it goes."""
    edges = np.array([0.0, log.end_time])
    moments, impacts, walls = Moments(), Impacts(), WallImpulses(log)
    stream(log, edges, [moments, impacts, walls])
    (rows,) = log.chunks()
    of_bath = rows.kind == Kind.THERMOSTAT
    assert (
        of_bath.sum() == log.summary["thermostat_collisions"] == log.observables["thermostat_collisions"][1][-1] > 800
    )
    assert (of_bath == (rows.partner == BATH)).all()
    hits = np.bincount(-1 - rows.partner[(rows.partner < 0) & ~of_bath], minlength=4)
    assert log.summary["wall_hits"] == hits.sum() == moments.events[0, 1]
    for tally in (impacts, walls):
        assert tally.hits[0].tolist() == hits.tolist()
    assert impacts.wall_virial[0] == pytest.approx(log.observables["wall_virial"][1][-1], rel=1e-9)
    assert impacts.pair_virial[0] == pytest.approx(log.observables["collision_flow"][1][-1][[0, 2]].sum(), rel=1e-9)
    push = log.observables["face_normal_impulse"][1][-1]
    assert walls.faces[0, :, :, 0].sum(axis=1) == pytest.approx(push, rel=1e-9)


def test_the_pressure_is_that_of_the_bath(log):
    result = pressure(log)
    assert result.temperature == 2
    assert result.check().agrees


def test_the_energy_that_thermostat_collisions_give_is_on_the_account(log):
    result = evolution(log)
    assert np.abs(result.balance).max() < 1e-12
    assert result.given.keys() == {"the heat bath"}
    mass, before, given = log.discs.mass, log.discs.velocity.copy(), 0.0
    for rows in log.chunks():
        for disc, kind, velocity in zip(rows.disc, rows.kind, rows.velocity, strict=True):
            if kind == Kind.THERMOSTAT:
                given += mass[disc] / 2 * (velocity @ velocity - before[disc] @ before[disc])
            before[disc] = velocity
    assert result.given["the heat bath"][-1] == pytest.approx(given, rel=1e-10)
    assert result.law.temperature[0] == 2
    assert any("energy from the heat bath" in table.heads for table in result.plain_tables())
    assert result.plot().axes


@pytest.mark.slow
def test_what_has_no_law(make, log):
    assert histogram(log).no_law is None
    assert histogram(log, "free-path").no_law == "a heat bath changes velocities during flights"
    two = make("box.left={ thermal = 1 }")
    assert histogram(two).no_law == "walls and heat bath have 2 temperatures"

"""Order of the discs of a log, against sums by hand and theory."""

import json
import math

import numpy as np
import pytest
from helpers.logs import gas, raised

from idealgas import order
from idealgas.analysis.order import FEWEST_FRAMES, FRAMES, WaveVectors
from idealgas.columns import SIDES
from idealgas.tallies.bond_order import bond_order

GAS = gas(60, 0.04, (1, 1.2), "collisions_per_disc = 60", periodic="xy", seed=3)

WALLS = tuple(f"box.{side}=reflecting" for side in SIDES)


def test_pairs_and_discs_are_counted_by_hand(make):
    log = make()
    result = order(log, start=0.1, end=0.4)
    assert result.frames == FRAMES
    states = list(log.frames(np.linspace(0.1, 0.4, FRAMES)))
    local = [bond_order(state.position, log.box, log.periodic) for state in states]
    assert result.local.value == pytest.approx(np.mean([np.abs(each.value) for each in local]))
    assert result.whole.value == pytest.approx(np.mean([abs(each.value.mean()) for each in local]))
    assert result.square.value == pytest.approx(60 * np.mean([abs(each.value.mean()) ** 2 for each in local]))
    assert result.hexagons.value == pytest.approx(np.mean([each.neighbours == 6 for each in local]))
    half = (result.distance[1] - result.distance[0]) / 2
    for k in (0, 5, -1):
        products = []
        for state, each in zip(states, local, strict=True):
            apart = state.position[:, None] - state.position
            apart -= np.array(log.box) * np.round(apart / log.box)
            near = np.abs(np.hypot(*np.moveaxis(apart, 2, 0)) - result.distance[k]) < half
            products += (each.value[:, None].conj() * each.value).real[near & ~np.eye(60, dtype=bool)].tolist()
        assert result.correlation[k] == pytest.approx(np.mean(products), abs=1e-12)
    assert result.distance[-1] + half == pytest.approx(0.5)  # half of the shorter side
    assert json.dumps(result.as_dict(), allow_nan=False)


def test_the_structure_factor_is_the_sum_over_discs():
    position, box = np.random.default_rng(1).random((30, 2)) * (2, 1), (2.0, 1.0)
    waves = WaveVectors(box, 30)
    result = waves.structure_factor(position)
    vectors = np.stack(np.meshgrid(waves.kx, waves.ky, indexing="ij"), axis=-1)[waves.used]
    assert result == pytest.approx(np.abs(np.exp(1j * vectors @ position.T).sum(axis=1)) ** 2 / 30, rel=1e-9)
    assert not (vectors == 0).all(axis=1).any()
    opposite = {tuple(np.round(v, 9)) for v in -vectors} & {tuple(np.round(v, 9)) for v in vectors}
    assert not opposite


def test_a_lattice_at_rest_has_full_positional_order():
    column, row = (axis.ravel() for axis in np.meshgrid(np.arange(8), np.arange(6)))
    sites, box = np.column_stack((column + row % 2 / 2, row * math.sqrt(3) / 2)), (8, 3 * math.sqrt(3))
    waves = WaveVectors(box, 48)
    lattice = waves.structure_factor(sites)
    result = waves.structure(np.array([lattice, 0.25 * lattice] * 2), 48)
    assert result.positional.value == pytest.approx(0.25)  # of every second frame; the others choose the wave vector
    result = waves.structure(np.array([lattice] * 4), 48)
    assert result.positional.value == pytest.approx(1.0)
    angle = math.degrees(math.atan2(result.peak[1], result.peak[0])) % 60  # rows along x have peaks at 30° and so on
    assert angle == pytest.approx(30.0)


def test_long_waves_know_the_compressibility(make):
    """Smallest wave numbers beside theory, within 4 standard errors; S has hardly left its limit there."""
    result = order(make("species.gas.count=400", "species.gas.radius=0.0169", "run.collisions_per_disc=150"))
    limit = result.compressibility
    assert 0.2 < limit < 0.3  # φ = 0.3
    assert abs(result.structure.value[0] - limit) < 4 * result.structure.error[0] + 0.03 * limit
    assert result.structure.error[0] < 0.25 * limit


def test_a_fluid_has_no_order_of_all_discs(make):
    """√N |Ψ₆| of 100 states of a gas at φ = 0.3, each 20 collisions a disc after the last: of the order of 1."""
    log = make("species.gas.count=100", "species.gas.radius=0.0339", "run.collisions_per_disc=2020")
    states = log.frames(np.linspace(0, log.end_time, 102)[1:-1])
    whole = [abs(bond_order(state.position, log.box, log.periodic).value.mean()) for state in states]
    assert len(whole) == 100
    assert 0.5 < 10 * np.mean(whole) < 4


def test_walls_have_neighbours_but_no_structure_factor(make):
    result = order(make(*WALLS))
    assert result.structure is None
    assert result.compressibility is None
    assert 0.3 < result.local.value < 0.7


def test_instants_of_a_log_without_events_are_its_checkpoints(make):
    log = make("log.events=false", "log.pressure=true", "run.collisions_per_disc=2000", "log.snapshot_every=0.1")
    result = order(log, start=1.0)
    assert result.frames >= FEWEST_FRAMES
    assert set(result.time) <= set(log.checkpoints.times)
    state = log.state_at(result.time[3])
    assert result.series[3] == np.abs(bond_order(state.position, log.box, log.periodic).value.mean())
    raised(
        "only 0 checkpoints",
        order,
        log,
        start=float(log.checkpoints.times[-2]) + 1e-6,
        end=float(log.checkpoints.times[-1]) - 1e-6,
    )

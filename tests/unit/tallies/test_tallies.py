"""Tallies against a slow and obvious computation in plain Python."""

import math
from itertools import pairwise

import numpy as np
import pytest
from helpers.logs import gas, species, streamed

from idealgas.tallies.collision_statistics import CollisionCounts, ImpactParameters
from idealgas.tallies.flights import DensityBins, Moments, VelocityHistogram
from idealgas.tallies.impacts import Impacts
from idealgas.tallies.intervals import FreeFlights, WaitingTimes
from idealgas.tallies.stream import stream

LIGHT = gas(9, 0.2, (6.0, 4.0), "events = 900", name="light", seed=3)
GAS = LIGHT + species("heavy", 5, 0.35, mass=3.0, speed=0.5)


@pytest.fixture(scope="module", params=[(0.0, 1.0, 11), (0.23, 0.71, 4), (0.1, 1.0, 900)], ids=str)
def edges(log, request):
    start, end, blocks = request.param
    return np.linspace(start * log.end_time, end * log.end_time, blocks + 1)


def rows_of(log, edges):
    columns = ("time", "disc", "partner", "kind", "position", "velocity")
    (rows,) = log.chunks(columns, log.row_at(edges[0], "right"), log.row_at(edges[-1], "right"))
    return [tuple(row) for row in zip(*(column.tolist() for column in rows), strict=True)]


def block_of(edges, time):
    return min(max(int(np.searchsorted(edges, time, "left")) - 1, 0), len(edges) - 2)


def flights_of(log, edges):
    """(disc, block, duration, velocity) of every flight, cut at the block edges."""
    discs = range(len(log.discs))
    state = log.state_at(edges[0])
    since, velocity = dict.fromkeys(discs, edges[0]), dict(enumerate(state.velocity))
    pieces = []

    def fly(disc, until):
        cuts = [since[disc], *(edge for edge in edges[1:-1] if since[disc] < edge < until), until]
        for a, b in pairwise(cuts):
            pieces.append((disc, block_of(edges, (a + b) / 2), b - a, velocity[disc]))
        since[disc] = until

    for time, disc, _, _, _, after in rows_of(log, edges):
        fly(disc, time)
        velocity[disc] = np.array(after)
    for disc in discs:
        fly(disc, edges[-1])
    return pieces


def test_moments(log, edges):
    tally = streamed(log, edges, Moments())
    flights = np.zeros_like(tally.flights)
    for disc, block, duration, v in flights_of(log, edges):
        m = log.discs.mass[disc]
        powers = (math.hypot(*v), m * v[0] ** 2, m * v[1] ** 2)
        flights[block, log.discs.species[disc]] += duration * np.array(powers)
    assert tally.flights == pytest.approx(flights, rel=1e-11, abs=1e-13)
    events = np.zeros_like(tally.events)
    for time, disc, partner, *_ in rows_of(log, edges):
        if partner < 0:
            events[block_of(edges, time), 1] += 1
        elif disc > partner:
            events[block_of(edges, time), 0] += 1
    assert tally.events.tolist() == events.tolist()
    energy = tally.flights[:, :, 1:3].sum(axis=(1, 2)) / 2 / np.diff(edges)
    assert energy == pytest.approx(np.full(len(energy), log.discs.kinetic_energy), rel=1e-10)


@pytest.mark.parametrize("quantity", ["speed", "vx", "vy", "energy"])
def test_velocity_histogram(log, edges, quantity):
    value = {
        "speed": lambda m, v: math.hypot(*v),
        "vx": lambda m, v: v[0],
        "vy": lambda m, v: v[1],
        "energy": lambda m, v: m * (v @ v) / 2,
    }[quantity]
    low, high = np.array([-0.5, 0.1]), np.array([1.2, 0.8])
    sampled = np.array([0, 3, 10])
    tally = streamed(log, edges, VelocityHistogram(quantity, low, high, 8, sampled))
    counts, sums = np.zeros_like(tally.counts), np.zeros_like(tally.sums)
    for disc, block, duration, v in flights_of(log, edges):
        s = log.discs.species[disc]
        x = value(log.discs.mass[disc], v)
        place = np.searchsorted(np.linspace(low[s], high[s], 9), x, "right")
        counts[block, s, place] += duration
        sums[block, s] += duration * x
    assert tally.counts == pytest.approx(counts, rel=1e-11, abs=1e-12)
    assert tally.sums == pytest.approx(sums, rel=1e-11, abs=1e-12)
    for k, state in enumerate(log.frames(edges[1:-1])):
        actual = [value(log.discs.mass[disc], state.velocity[disc]) for disc in sampled]
        assert tally.snapshots[k] == pytest.approx(actual, rel=1e-14)


def test_impacts(log, edges):
    tally = streamed(log, edges, Impacts())
    before = dict(enumerate(log.state_at(edges[0]).velocity))
    expected = {name: np.zeros_like(getattr(tally, name)) for name in ("pair_virial", "wall_virial", "impulse", "hits")}
    collisions = np.zeros_like(tally.collisions)
    rows = rows_of(log, edges)
    mass, species = log.discs.mass, log.discs.species
    for k, (time, disc, partner, _, position, velocity) in enumerate(rows):
        block = block_of(edges, time)
        push = mass[disc] * (np.array(velocity) - before[disc])
        before[disc] = np.array(velocity)
        if partner < 0:
            expected["hits"][block, -1 - partner] += 1
            expected["impulse"][block, -1 - partner] -= push
            expected["wall_virial"][block] -= (np.array(position) - np.array(log.box) / 2) @ push
        elif disc < partner:
            other = rows[k + 1]
            assert (other[1], other[2]) == (partner, disc)
            expected["pair_virial"][block] += (np.array(position) - np.array(other[4])) @ push
            collisions[block, species[disc], species[partner]] += 1
            collisions[block, species[partner], species[disc]] += 1
    for name, sums in expected.items():
        assert getattr(tally, name) == pytest.approx(sums, rel=1e-10, abs=1e-12), name
    assert tally.collisions.tolist() == collisions.tolist()


def test_virials_of_pairs_and_walls_balance(log, edges):
    """d/dt Σ r·p = 2E + Σ r·F of pairs and walls: over any window both sides are the same number."""
    tally = streamed(log, edges, Impacts())
    mass = log.discs.mass[:, None]
    first, last = (
        (mass * (state.position - np.array(log.box) / 2) * state.velocity).sum()
        for state in log.frames([edges[0], edges[-1]])
    )
    energy = log.discs.kinetic_energy * (edges[-1] - edges[0])
    balance = 2 * energy + tally.pair_virial.sum() - tally.wall_virial.sum()
    assert balance == pytest.approx(last - first, abs=1e-9 * energy)


def test_force_on_a_side_comes_from_the_bulk(log, edges):
    """d/dt Σ p w = ±F + flights and collisions, w the nearness to a side: over any block both are the same number."""
    moments, impacts = streamed(log, edges, Moments(), Impacts())
    gas, species = log.discs, log.discs.species
    for side in range(4):
        axis, sign = side // 2, 2 * (side % 2) - 1
        reach = log.box[axis] - 2 * gas.radius
        momentum = []
        for state in log.frames(edges):
            near = (state.position[:, axis] - gas.radius) / reach
            momentum.append((gas.mass * state.velocity[:, axis] * (near if sign > 0 else 1 - near)).sum())
        _, first = np.unique(species, return_index=True)
        bulk = (moments.flights[:, :, 1 + axis] / reach[first]).sum(axis=1) + impacts.passed_on[:, side]
        force = sign * impacts.impulse[:, side, axis]
        assert force == pytest.approx(bulk - sign * np.diff(momentum), abs=1e-10)


def test_virials_of_bulk_and_walls_balance_in_every_block(log, edges):
    moments, impacts = streamed(log, edges, Moments(), Impacts())
    middle, mass = np.array(log.box) / 2, log.discs.mass[:, None]
    virial = [(mass * (state.position - middle) * state.velocity).sum() for state in log.frames(edges)]
    kinetic = moments.flights[:, :, 1:3].sum(axis=(1, 2))
    assert impacts.wall_virial == pytest.approx(kinetic + impacts.inner_virial - np.diff(virial), abs=1e-9)
    assert impacts.inner_virial == pytest.approx(impacts.pair_virial, rel=1e-9, abs=1e-12)


def test_density_bins(log, edges):
    tally = streamed(log, edges, DensityBins(3))
    discs = np.zeros_like(tally.discs)
    for block, state in enumerate(log.frames(edges[1:])):
        place = (state.position / np.array(log.box) * 3).astype(int)
        for axis in range(2):
            np.add.at(discs[block], (log.discs.species, axis, place[:, axis]), 1)
    assert (tally.discs == discs).all()
    assert (tally.discs.sum(axis=3) == [[9], [5]]).all()


@pytest.mark.parametrize("path", [True, False], ids=["path", "time"])
def test_free_flights(log, edges, path):
    high = np.array([2.0, 1.0])
    tally = streamed(log, edges, FreeFlights(path, high, 10, stride=3, most_samples=200))
    since, speed, length, began = {}, {}, {}, {}
    flights = []
    for time, disc, partner, _, _, velocity in rows_of(log, edges):
        if disc in began:
            length[disc] += (speed[disc] if path else 1.0) * (time - since[disc])
        since[disc], speed[disc] = time, math.hypot(*velocity)
        if partner >= 0:
            if disc in began:
                flights.append((block_of(edges, began[disc]), int(log.discs.species[disc]), length[disc]))
            began[disc], length[disc] = time, 0.0
    counts, sums = np.zeros_like(tally.counts), np.zeros_like(tally.sums)
    for block, s, x in flights:
        counts[block, s, np.searchsorted(np.linspace(0, high[s], 11), x, "right")] += 1
        sums[block, s] += x
    assert tally.counts.tolist() == counts.tolist()
    assert tally.sums == pytest.approx(sums, rel=1e-11)
    chosen = flights[::3][:200]
    assert tally.sample == pytest.approx([x for _, _, x in chosen], rel=1e-11)
    assert tally.sample_block.tolist() == [block for block, _, _ in chosen]
    assert tally.sample_species.tolist() == [s for _, s, _ in chosen]


def test_waits(log, edges):
    tally = streamed(log, edges, WaitingTimes(np.array([0.05]), 10, stride=4, most_samples=50))
    times = [time for time, disc, partner, *_ in rows_of(log, edges) if partner < 0 or disc < partner]
    waits = np.diff(times)
    assert tally.counts.sum() == len(waits)
    assert tally.sums.sum() == pytest.approx(times[-1] - times[0], rel=1e-12)
    assert tally.sample == pytest.approx(waits[::4][:50], rel=1e-12, abs=1e-15)
    assert tally.sample_block.tolist() == [block_of(edges, time) for time in times[:-1:4][:50]]
    counts = np.histogram(waits, np.append(np.linspace(0, 0.05, 11), np.inf))[0]
    assert tally.counts.sum(axis=(0, 1)).tolist() == [0, *counts]


def test_impact_parameters(log, edges):
    """From positions and velocities after collisions, which conserve |b|."""
    tally = streamed(log, edges, ImpactParameters((False, False), 10, stride=3, most_samples=200))
    rows = rows_of(log, edges)
    actual = []
    for first, second in pairwise(rows):
        if second[2] == first[1] and second[0] == first[0] and first[2] == second[1]:
            (x, y), (vx, vy) = (np.subtract(second[k], first[k]) for k in (4, 5))
            actual.append((block_of(edges, first[0]), abs(x * vy - y * vx) / math.hypot(x, y) / math.hypot(vx, vy)))
    counts = np.zeros_like(tally.counts)
    for block, b in actual:
        counts[block, 0, min(int(b * 10), 9) + 1] += 1
    assert tally.counts.tolist() == counts.tolist()
    assert tally.sample == pytest.approx([b for _, b in actual[::3][:200]], rel=1e-9)


def test_collision_counts(log, edges):
    time = (edges[-1] - edges[0]) / 7.5
    tally = streamed(log, edges, CollisionCounts(time, bins=4, stride=3))
    result = np.zeros((7, 14), int)
    for when, disc, partner, *_ in rows_of(log, edges):
        if partner >= 0 and (v := int((when - edges[0]) / time)) < 7:
            result[v, disc] += 1
    assert tally.begins == pytest.approx(edges[0] + time * np.arange(7))
    for v, numbers in enumerate(result):
        for s in range(2):
            own = numbers[log.discs.species == s]
            assert tally.counts[v, s].tolist() == [0, *[(own == n).sum() for n in range(4)], (own >= 4).sum()]
            assert tally.sums[v, s].tolist() == [(own**power).sum() for power in range(4)]
    sampled = [(result[v, disc], v, log.discs.species[disc]) for v in range(7) for disc in range(v % 3, 14, 3)]
    assert list(zip(tally.sample, tally.sample_index, tally.sample_species, strict=True)) == sampled


def test_collision_counts_of_times_together(log, edges, monkeypatch):
    """Seven times in at most four groups: three of two each."""
    time = (edges[-1] - edges[0]) / 7.5
    single = streamed(log, edges, CollisionCounts(time, bins=4, stride=3))
    monkeypatch.setattr("idealgas.tallies.collision_statistics.MOST_BLOCKS", 4)
    grouped = streamed(log, edges, CollisionCounts(time, bins=4, stride=3))
    assert grouped.begins == pytest.approx(single.begins[:6:2])
    assert np.array_equal(grouped.counts, single.counts[:6:2] + single.counts[1:6:2])
    assert np.array_equal(grouped.sums, single.sums[:6:2] + single.sums[1:6:2])
    some = single.sample_index < 6
    assert np.array_equal(grouped.sample, single.sample[some])
    assert np.array_equal(grouped.sample_index, single.sample_index[some] // 2)


def test_rows_cut_into_chunks_make_no_difference(log, edges, monkeypatch):
    """Pairs may straddle two chunks."""

    chunks = log.chunks

    def short(columns, start, stop):
        for row in range(start, stop, 7):
            yield from chunks(columns, row, min(row + 7, stop))

    whole, parts = (
        [
            Moments(),
            Impacts(),
            FreeFlights(True, np.ones(2), 5, 2, 100),
            WaitingTimes(np.ones(1), 5, 2, 100),
            CollisionCounts(0.3, 9, 2),
            ImpactParameters((False, False), 5, 2, 100),
        ]
        for _ in range(2)
    )
    stream(log, edges, whole)
    monkeypatch.setattr(log, "chunks", short)
    stream(log, edges, parts)
    assert whole[0].flights == pytest.approx(parts[0].flights, rel=1e-12)
    assert whole[1].pair_virial == pytest.approx(parts[1].pair_virial, rel=1e-12)
    assert np.array_equal(whole[1].collisions, parts[1].collisions)
    assert np.array_equal(whole[2].sample, parts[2].sample)
    assert np.array_equal(whole[3].counts, parts[3].counts)
    assert np.array_equal(whole[4].counts, parts[4].counts)
    assert np.array_equal(whole[5].sample, parts[5].sample)


def test_progress_counts_rows(log):
    seen = []
    stream(
        log,
        np.linspace(0, log.end_time, 5),
        [WaitingTimes(np.ones(1), 5, 2, 9)],
        lambda done, total: seen.append((done, total)),
    )
    assert seen[-1] == (len(log), len(log))

"""Monte Carlo trials: where they stop, what they write, which pairs they take, and what they are accepted for."""

import math

import numpy as np
import pytest
from helpers.support import gas_of, record

from idealgas.columns import EventBatch, Kind
from idealgas.engine.monte_carlo import MonteCarlo
from idealgas.engine.simulation import Simulation, Stop
from idealgas.errors import UserError

BOX = (10.0, 10.0)


def some_gas(n=60, seed=1, radius=0.05, mass=1.0):
    velocity = np.random.default_rng(seed).normal(size=(n, 2))
    return gas_of(BOX, np.full((n, 2), 5.0), velocity, radius, mass)


def simulation(gas=None, seed=3, v_ref=20.0, **options):
    return Simulation(some_gas() if gas is None else gas, MonteCarlo(seed, v_ref, **options))


@pytest.mark.interpreted
def test_rows_are_pairs_without_positions():
    rows = record(simulation(), Stop(events=500))
    assert rows.position is None
    assert len(rows.time) == 1000
    first, second = (EventBatch(*(c if c is None else c[k::2] for c in rows)) for k in (0, 1))
    assert (first.disc < second.disc).all()
    assert (first.partner == second.disc).all()
    assert (second.partner == first.disc).all()
    assert (first.time == second.time).all()
    assert (first.trial == second.trial).all()
    assert (np.diff(first.time) > 0).all()
    assert (np.diff(first.trial.astype(int)) > 0).all()
    assert (rows.kind == Kind.DISC).all()


def test_rows_give_the_state_at_the_end():
    made = simulation()
    rows = record(made, Stop(trials=5000))
    velocity = some_gas().velocity.copy()
    velocity[rows.disc] = rows.velocity
    assert made.state()[0].velocity.tolist() == velocity.tolist()
    assert made.state()[0].position.tolist() == some_gas().position.tolist()


@pytest.mark.parametrize("rows", [3, 17, 4096])
def test_neither_batches_nor_slices_change_anything(rows):
    whole = record(simulation(), Stop(trials=40_000))
    parts = record(simulation(), Stop(trials=40_000), rows)
    for name in ("time", "disc", "velocity", "trial"):
        assert np.array_equal(getattr(whole, name), getattr(parts, name)), name
    silent = simulation()
    for _ in silent.slices(Stop(trials=40_000), events=7):
        pass
    assert silent.counters.events == len(whole.time) // 2
    assert silent.epoch >= 2


def test_stops_where_it_should():
    made = simulation()
    rows = record(made, Stop(trials=1234))
    assert (made.counters.trials, made.counters.events) == (1234, len(rows.time) // 2)
    assert rows.trial[-1] <= 1234
    made = simulation()
    assert len(record(made, Stop(disc_collisions=77)).time) == 2 * 77
    assert made.counters.trials == int(record(simulation(), Stop(events=77)).trial[-1])
    made = simulation()
    assert record(made, Stop(time=9.5)).time[-1] <= 9.5
    assert made.finished(Stop(time=9.5))


def test_seeds_differ_and_epochs_do_too():
    result, two = (record(simulation(seed=seed), Stop(events=5)).time.tolist() for seed in (1, 2))
    assert result != two
    method, other = MonteCarlo(1, 20.0), MonteCarlo(1, 20.0)
    first = record(Simulation(some_gas(), method), Stop(events=5))
    second = record(Simulation(some_gas(), other, time=8.0, epoch=1), Stop(events=5))
    assert first.disc.tolist() != second.disc.tolist()


def test_too_small_a_reference_speed_is_named_with_the_one_that_is_needed():
    made = simulation(v_ref=2.0)
    with pytest.raises(
        UserError, match=r"^run\.v_ref: too small: an acceptance probability of 1\.\d+ in trial \d+ "
    ) as caught:
        record(made, Stop(trials=100_000))
    message = str(caught.value)
    assert "\n" not in message
    needed = float(message.split("allowed >= ")[1].split(",")[0])
    gas = made.state()[0]
    speeds = np.hypot(*(gas.velocity[:, None] - gas.velocity).T)
    assert speeds == pytest.approx(speeds.T)
    assert np.isclose(speeds, needed, rtol=1e-5).any()
    assert needed > 2.0


# ── a reference speed that rises ──


def uneven_gas(seed):
    """Six discs of two kinds, whose light ones get faster than any disc was at the start."""
    draw = np.random.default_rng(seed)
    velocity = draw.normal(size=(6, 2)) * 0.5
    return gas_of(
        BOX, np.full((6, 2), 5.0), velocity, [0.1, 0.1, 0.1, 0.3, 0.3, 0.3], [0.02, 0.02, 0.02, 5.0, 5.0, 5.0]
    )


def rising(gas, seed, share=5.0):
    fastest = float(np.hypot(*gas.velocity.T).max())
    return Simulation(gas, MonteCarlo(seed, share * fastest, rises=True))


def test_no_pair_is_ever_faster_than_a_reference_speed_that_rises():
    raises = 0
    for seed in range(20):
        made = rising(uneven_gas(seed), seed)
        before = made.method.v_ref
        for _ in made.slices(Stop(trials=3000), events=1):
            speeds = np.hypot(*made.state()[0].velocity.T)
            assert np.sort(speeds)[-2:].sum() < made.method.v_ref
            raises += made.method.v_ref > before
            assert made.method.v_ref >= before
            before = made.method.v_ref
    assert raises > 20


def test_while_it_rises_every_pair_collides_at_its_own_rate():
    """Waits times the rate of all pairs are exponential with mean 1, and the pairs come in proportion to their rates.

    Both for the first eight collisions of 500 gases, nearly all of which raise v_ref among them: Kolmogorov's bound for
    p = 0.001, and 4 standard errors of the mean share of the pair that collides (its variance is bounded by 1/4).
    """
    waits, excess, raised = [], [], 0
    for seed in range(500):
        gas = uneven_gas(seed)
        made = rising(gas, seed, 2.05)
        start = made.method.v_ref
        rows = record(made, Stop(events=8))
        raised += made.method.v_ref > start
        chi = (1 - 7 * gas.packing_fraction / 16) / (1 - gas.packing_fraction) ** 2
        velocity, last = gas.velocity.copy(), 0.0
        i, j = np.triu_indices(6, 1)
        for k in range(0, 16, 2):
            rate = 2 * chi * (gas.radius[i] + gas.radius[j]) * np.hypot(*(velocity[i] - velocity[j]).T) / gas.area
            waits.append((rows.time[k] - last) * rate.sum())
            taken = (i == rows.disc[k]) & (j == rows.partner[k])
            excess.append(rate[taken].sum() / rate.sum() - (rate**2).sum() / rate.sum() ** 2)
            last = rows.time[k]
            velocity[rows.disc[k : k + 2]] = rows.velocity[k : k + 2]
    assert raised > 400
    place = np.sort(1 - np.exp(-np.array(waits)))
    distance = np.abs(place - np.arange(1, len(place) + 1) / len(place)).max()
    assert distance < 1.95 / math.sqrt(len(place))
    assert abs(np.mean(waits) - 1) < 4 / math.sqrt(len(waits))
    assert abs(np.mean(excess)) < 4 * 0.5 / math.sqrt(len(excess))


@pytest.mark.parametrize("rises", [False, True])
def test_a_run_goes_on_from_the_start_of_any_epoch(rises):
    def make():
        return rising(uneven_gas(3), 3) if rises else simulation()

    stop, made = Stop(trials=8000 if rises else 60_000), make()
    whole = record(make(), stop)
    while made.epoch < 2:
        made.advance(stop, None)
        if made.epoch_over:
            made.next_epoch()
    method = MonteCarlo(3, made.method.v_ref, rises=rises)
    again = Simulation(made.gas, method, time=made.time, epoch=made.epoch, totals=made.totals)
    rest = record(again, stop)
    for name in ("time", "disc", "velocity", "trial"):
        assert np.array_equal(getattr(whole, name)[-len(rest.time) :], getattr(rest, name)), name
    assert len(rest.time) == len(whole.time) - 2 * made.totals.events
    for size in (3, 17) if rises else ():
        assert np.array_equal(whole.time, record(make(), stop, size).time)


@pytest.mark.interpreted
def test_one_sided_impact_parameters_turn_the_relative_velocity_one_way():
    def boundary_crossings(one_sided):
        gas = gas_of(BOX, [(5, 5), (5, 5)], [(1.0, 0.0), (-1.0, 0.0)], 0.1)
        rows = record(simulation(gas, v_ref=4.0, one_sided=one_sided), Stop(events=2000))
        relative = np.concatenate(([[2.0, 0.0]], rows.velocity[0::2] - rows.velocity[1::2]))
        return np.sign(relative[:-1, 0] * relative[1:, 1] - relative[:-1, 1] * relative[1:, 0])

    assert set(boundary_crossings(True)) in ({1.0}, {-1.0})
    assert abs(boundary_crossings(False).mean()) < 4 / math.sqrt(2000)


@pytest.mark.interpreted
def test_impact_parameters_are_uniform():
    """They show in the deflection: a relative velocity that meets the line of centres at φ is turned by π - 2φ."""
    gas = gas_of(BOX, [(5, 5), (5, 5)], [(1.0, 0.0), (-1.0, 0.0)], 0.1)
    rows = record(simulation(gas, v_ref=4.0), Stop(events=4000))
    relative = np.concatenate(([[2.0, 0.0]], rows.velocity[0::2] - rows.velocity[1::2]))
    cosine = (relative[:-1] * relative[1:]).sum(axis=1) / (relative[:-1] ** 2).sum(axis=1)
    offset = np.sqrt(np.maximum(1 + cosine, 0) / 2)  # |b|/S = sin φ = cos((π - 2φ)/2)
    place = np.sort(offset)
    distance = np.abs(place - np.arange(1, len(place) + 1) / len(place)).max()
    assert distance < 1.95 / math.sqrt(len(place))  # Kolmogorov's bound for p = 0.001


@pytest.mark.interpreted
def test_pairs_are_accepted_for_certain():
    gas = gas_of(BOX, [(5, 5), (5, 5)], [(1.0, 0.0), (-1.0, 0.0)], 0.1)
    for v_ref, least, most in ((2.0 * (1 + 1e-9), 50, 50), (8.0, 120, 320)):  # a quarter of them: 200 ± 24
        made = simulation(gas, v_ref=v_ref)
        record(made, Stop(events=50))
        assert least <= made.counters.trials <= most
    # Of radii 0.1, 0.3 and 0.2 these have the reach 0.5: with it and v_ref no other pair is accepted more often.
    gas = gas_of(BOX, np.full((3, 2), 5.0), [(0.0, 0.0), (1.0, 0.0), (0.0, 3.0)], [0.1, 0.3, 0.2])
    method = MonteCarlo(1, 5.0)
    Simulation(gas, method)
    chi = (1 - 7 * gas.packing_fraction / 16) / (1 - gas.packing_fraction) ** 2
    assert method._reach == 0.5
    assert method._trial_time(5.0) == pytest.approx(100 / (6 * 0.5 * chi * 5.0), rel=1e-14)


def test_every_pair_collides_as_often():
    n, trials = 12, 200_000
    rows = record(simulation(some_gas(n, seed=5), v_ref=30.0), Stop(trials=trials))
    counts = np.zeros((n, n))
    np.add.at(counts, (rows.disc, rows.partner), 1)
    each = counts[np.triu_indices(n, 1)]
    assert each.sum() == len(rows.time) / 2
    expected = each.mean()
    chi_square = ((each - expected) ** 2).sum() / expected
    freedom = len(each) - 1
    assert chi_square < freedom + 4 * math.sqrt(2 * freedom)


def test_acceptance_is_in_proportion_to_speed_and_size():
    """Of a pair's trials the share S v/(S_max v_ref) is accepted; every stretch up to a collision begins afresh."""
    velocity = [(0.0, 0.0), (1.0, 0.0), (0.0, 3.0)]
    gas = gas_of(BOX, np.full((3, 2), 5.0), velocity, [0.1, 0.3, 0.2])
    v_ref = 5.0
    shares = np.zeros((3, 3))
    done = 0
    for seed in range(6000):
        made = Simulation(gas, MonteCarlo(seed, v_ref))
        rows = record(made, Stop(events=1), 3)
        shares[rows.disc[0], rows.disc[1]] += 1
        done += made.counters.trials
    for i, j in ((0, 1), (0, 2), (1, 2)):
        speed = math.hypot(*np.subtract(velocity[i], velocity[j]))
        expected = (gas.radius[i] + gas.radius[j]) * speed / (0.5 * v_ref)
        measured = shares[i, j] / (done / 3)
        assert abs(measured - expected) < 4 * math.sqrt(expected * (1 - expected) / (done / 3)), (i, j)


def test_waits_between_trials_are_those_of_a_poisson_process():
    made = simulation(v_ref=12.0)
    rows = record(made, Stop(trials=50_000))
    per_trial = rows.time[-1] / float(rows.trial[-1])
    gas = some_gas()
    chi = (1 - 7 * gas.packing_fraction / 16) / (1 - gas.packing_fraction) ** 2
    expected = gas.area / (60 * 59 * 0.1 * chi * 12.0)
    assert abs(per_trial / expected - 1) < 4 / math.sqrt(50_000)

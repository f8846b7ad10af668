"""Measures of the way to equilibrium, on samples whose law is known and on a small log counted by hand."""

import math
import shutil

import numpy as np
import pytest
from helpers.crafted import craft, put
from helpers.logs import gas, log_of, raised, species

from idealgas import open_run, parse_scene, relaxation
from idealgas.analysis.relaxation.acceptance import acceptance
from idealgas.analysis.relaxation.speeds import (
    colliding_span,
    collisions_per_disc,
    critical_distance,
    decay_time,
    reduced_energy,
    reduced_energy_cdf,
    relative_entropy,
    speed_distributions,
)
from idealgas.errors import UserError
from idealgas.log import open_log
from idealgas.statistics.estimates import ks_distance
from idealgas.tallies.equilibrium import ensemble

GAS = gas(80, 0.1, (10, 10), "collisions_per_disc = 60", speed=2.0, seed=5)
STANDARD_ERRORS = 4


def test_distance_of_a_few_values():
    """Of one energy: the larger part of the law on either side of it."""
    assert ks_distance(np.array([math.log(4)]), reduced_energy_cdf) == pytest.approx(0.75)
    assert ks_distance(np.array([1e-12, math.log(2)]), reduced_energy_cdf) == pytest.approx(0.5)
    places = -np.log(1 - (np.arange(10) + 0.5) / 10)
    assert ks_distance(places, reduced_energy_cdf) == pytest.approx(0.05)


def test_entropy_of_equal_energies_and_of_the_law():
    """Equal energies fill one of 32 cells; of samples of the law the mean is 0 within its error √(31/2)/N per gas."""
    assert relative_entropy(np.ones(3200)) == pytest.approx(math.log(32) - 31 / 6400)
    random = np.random.default_rng(3)
    actual = [relative_entropy(random.exponential(size=2000)) for _ in range(200)]
    assert abs(np.mean(actual)) < STANDARD_ERRORS * math.sqrt(31 / 2) / 2000 / math.sqrt(200)


def test_entropy_of_a_gas_that_is_too_hot():
    """∫ p ln(p/e^(-x)) dx of p = e^(-x/a)/a is a - 1 - ln a, of which 32 cells see over 90 %.

    The error is that of the mean of ln(p/e^(-x)), which varies by a - 1.
    """
    energies = np.random.default_rng(1).exponential(1.3, size=1_000_000)
    beyond = (1 - np.arange(33) / 32) ** (1 / 1.3)
    share = -np.diff(beyond)
    in_cells = (share * np.log(32 * share)).sum()
    assert relative_entropy(energies) == pytest.approx(in_cells, abs=STANDARD_ERRORS * 0.3 / 1000)
    assert 0.9 < in_cells / (0.3 - math.log(1.3)) < 1


@pytest.mark.parametrize("number", [20, 100, 1000])
def test_one_gas_in_twenty_exceeds_the_critical_distance(number):
    """Energies that add up to a fixed sum are exponential ones over their mean."""
    random, gases = np.random.default_rng(number), 4000
    energies = random.exponential(size=(gases, number))
    energies /= energies.mean(axis=1, keepdims=True)
    share = np.mean([ks_distance(gas, reduced_energy_cdf) > critical_distance(number) for gas in energies])
    assert abs(share - 0.05) < STANDARD_ERRORS * math.sqrt(0.05 * 0.95 / gases)


def test_decay_times_are_found():
    time = np.linspace(0, 40, 321)
    for tau in (0.5, 2.9, 30.0):
        assert decay_time(time, 2 - np.exp(-time / tau), 2.0) == pytest.approx(tau, rel=1e-4)


def test_decay_times_are_found_in_collisions_that_set_in_late():
    collisions = np.maximum(np.linspace(-3, 37, 321), 0)
    assert decay_time(collisions, 2 - np.exp(-collisions / 2.9), 2.0) == pytest.approx(2.9, rel=1e-4)


def test_reduced_energies_of_both_species_have_mean_one():
    """In the mean over the discs, whatever their masses, about the velocity of the centre of mass."""
    log = log_of(GAS + species("heavy", 20, 0.1, mass=10, speed=1.0))
    state = log.state_at(log.end_time)
    result = reduced_energy(log, state.velocity, ensemble(log))
    assert speed_distributions(log, 1.0, end=1.0).expected.sum() == pytest.approx(100)
    assert result.mean() == pytest.approx(1)
    energy = log.discs.mass * (state.velocity**2).sum(axis=1) / 2
    assert result == pytest.approx(energy / energy.mean())


def test_collisions_are_counted_for_both_discs(log):
    (rows,) = log.chunks(("time", "partner"))
    time = np.array([0.0, rows.time[99], rows.time[-1]])
    result = collisions_per_disc(log, time)
    assert result[0] == 0
    assert result[1] * 80 == (rows.partner[rows.time <= time[1]] >= 0).sum()
    assert result[2] * 80 == (rows.partner >= 0).sum() == 4800
    late = collisions_per_disc(log, time[1:])
    assert late[1] == result[2] - result[1]


def test_forty_collisions_a_disc_are_looked_at(log):
    first, last = colliding_span(log, None, None)
    assert first == 0
    assert collisions_per_disc(log, np.array([0.0, last]))[-1] == pytest.approx(40, abs=2 / 80)
    assert colliding_span(log, 1.0, 2.0) == (1.0, 2.0)
    assert colliding_span(log, None, log.end_time) == (0, log.end_time)
    raised("no two discs collide between t = 0 and 1e-09", colliding_span, log, None, 1e-9)


def test_what_was_seen_of_equal_speeds(log):
    result = relaxation(log)
    late = log.state_at(result.time[40]).velocity
    assert result.kurtosis[0] == pytest.approx(1, abs=1e-12)
    assert result.distance[0] == pytest.approx(1 - math.exp(-1), abs=1e-12)
    square = (late**2).sum(axis=1)
    assert result.kurtosis[40] == pytest.approx((square**2).mean() / square.mean() ** 2)
    assert result.equilibrium_kurtosis == pytest.approx(2 * 160 / 162, rel=1e-15)
    assert result.collisions[-1] == pytest.approx(40, abs=2 / 80)
    k = int(np.flatnonzero(result.time == result.indistinguishable_after["time"])[0])
    assert result.collisions[k] == result.indistinguishable_after["collisions_per_disc"]
    assert result.distance[k] < result.critical_distance <= result.distance[:k].min()
    assert result.in_collisions.value / result.in_time.value == pytest.approx(
        result.collisions[-1] / result.time[-1], rel=0.1
    )
    axes = result.analysis.combine([result, result]).figure().axes
    assert all("(" in axis.get_xlabel() and "(" in axis.get_ylabel() for axis in axes)


def test_of_a_gas_in_equilibrium_no_relaxation_is_seen(make):
    result = relaxation(make("species.gas.speed=", "species.gas.temperature=1.0"))
    assert result.in_time is None
    assert result.indistinguishable_after is not None
    assert result.as_dict()["relaxation_time"] is None


def test_development_counts_every_disc_at_every_instant(log):
    result, whole = speed_distributions(log, 1.0, end=5.0), speed_distributions(log, 0.5).counts
    at_two = np.hypot(*log.state_at(2.0).velocity.T)
    assert result.time.tolist() == [0, 1, 2, 3, 4, 5]
    assert result.counts.shape == (6, 9)
    assert (whole.sum(axis=1) == 80).all()
    assert whole[:, -1].any()  # also far beyond the last edge
    assert result.counts[0].tolist() == [0, 0, 0, 80, 0, 0, 0, 0, 0]
    assert result.rms == pytest.approx(2)
    assert result.counts[2].tolist() == np.histogram(at_two, [*result.edges, np.inf])[0].tolist()
    assert result.expected.sum() == pytest.approx(80)
    assert result.expected[-1] == pytest.approx(80 * math.exp(-(2.4**2)))
    assert result.trials is None
    raised("instants are too many for a table", speed_distributions, log, 1e-9)


def test_development_by_trials(make):
    log = make("run.collisions_per_disc=", "run.trials=2500", "run.method=monte_carlo")
    result, made = speed_distributions(log, 1000), acceptance(log)
    (rows,) = log.chunks(("time", "trial"))
    assert result.trials.tolist() == [0, 1000, 2000]
    assert result.collisions[1] * 80 == (rows.trial <= 1000).sum()
    assert result.time[1] == rows.time[rows.trial <= 1000][-1]
    assert (made.number, made.collisions, made.published) == (2500, len(rows.time) // 2, None)


def test_development_by_trials_of_a_run_that_was_left_early(tmp_path):
    early = ("run.collisions_per_disc=", "run.trials=2500", "run.method=monte_carlo")
    with open_run(parse_scene(GAS, overrides=early), tmp_path / "run.h5") as run:
        run.advance(events=200)
    with open_log(tmp_path / "run.h5") as log:
        (rows,) = log.chunks(("trial",))
        last = int(rows.trial[-1])
        assert 100 < last < 2400
        assert speed_distributions(log, 50).trials.tolist() == list(range(0, last + 1, 50))


def test_a_gas_that_comes_to_rest_is_one_line(log, tmp_path):
    path = tmp_path / "run.h5"
    shutil.copy(log.path, path)
    craft(path, put("checkpoints/velocity", ..., 1e-200))
    with open_log(path) as log, pytest.raises(UserError, match=r"no disc moves at t = 0$"):
        relaxation(log)

"""Transport against slow and obvious computations, and against cases whose answer is known."""

import json

import numpy as np
import pytest
from helpers.logs import PERIODIC, gas, log_of

from idealgas.analysis.transport.correlations import correlation, mean_square_displacement, velocity_integral
from idealgas.analysis.transport.measure import transport
from idealgas.analysis.transport.pair_distribution import chance_within
from idealgas.tallies.stream import sample_trajectories

GAS = gas(12, 0.3, (6, 5), "collisions_per_disc = 60", seed=3)
SQUARE = gas(30, 0.3, (9, 9), "collisions_per_disc = 16_000", periodic="xy", seed=3)


@pytest.fixture(scope="module", params=[(), PERIODIC, PERIODIC[:2]], ids=["walls", "periodic", "channel"])
def log(request, make):
    return make(*request.param)


def test_trajectories_are_those_of_the_frames(log):
    times = np.linspace(0.3 * log.end_time, log.end_time, 40)
    discs = np.array([1, 5, 11])
    places, velocities = sample_trajectories(log, times, discs)
    for k, state in enumerate(log.frames(times)):
        image = 0 if state.image is None else state.image[discs]
        assert places[k] == pytest.approx(state.position[discs] + image * np.array(log.box), abs=1e-12)
        assert velocities[k] == pytest.approx(state.velocity[discs], abs=1e-13)
    assert np.abs(np.diff(places, axis=0)).max() < 5 * np.diff(times)[0] * np.abs(velocities).max()


def test_correlations_are_plain_averages():
    random = np.random.default_rng(1)
    series = random.normal(size=(2, 30, 3, 2)).cumsum(axis=1)
    remembered, displacement = correlation(series, series), mean_square_displacement(series)
    for lag in range(30):
        early, late = series[:, : 30 - lag], series[:, lag:]
        assert remembered[:, lag] == pytest.approx((early * late).sum(axis=3).mean(axis=(1, 2)), rel=1e-9, abs=1e-9)
        assert displacement[:, lag] == pytest.approx(
            ((late - early) ** 2).sum(axis=3).mean(axis=(1, 2)), rel=1e-9, abs=1e-9
        )


def test_velocity_integral_of_a_known_motion():
    """v = (cos t, 0): v(t)·v(t + s) has the integral cos t [sin(t + lag) - sin t], at steps as long as a radian."""
    t = np.arange(7.0)
    velocities, places = np.zeros((2, 1, 7, 1, 2))
    velocities[0, :, 0, 0], places[0, :, 0, 0] = np.cos(t), np.sin(t)
    result = velocity_integral(velocities, places)[0]
    assert result[0] == 0
    for k in range(1, 7):
        step = np.cos(t[: 7 - k]) * (np.sin(t[k:]) - np.sin(t[k - 1 : -1]))
        assert result[k] - result[k - 1] == pytest.approx(step.mean(), abs=1e-14)


def test_velocity_correlation_time_at_any_lag():
    """It is 2D/⟨v²⟩ by Green's and Kubo's relation, even where steps are five mean free times; four standard errors."""
    log = log_of(SQUARE)
    short, long = (transport(log, start=0.0, lag=lag).diffusion[0] for lag in (20.0, 1000.0))
    square = 2 * 1.0 * (1 - 1 / 30)  # ⟨v²⟩ at T = 1 without momentum
    expected = 2 * short.coefficient.value / square
    for each in (short.velocity_correlation_time, long.velocity_correlation_time):
        assert each.standard_error < 0.2 * each.value
        assert abs(each.value - expected) < 4 * each.standard_error


@pytest.mark.parametrize("periodic", [(False, False), (True, False), (True, True)])
def test_chance_of_a_distance(periodic):
    """Against points thrown at random; four standard errors."""
    random = np.random.default_rng(4)
    reach = [(5.0, 4.0) if not periodic[0] else (5.0, 5.0), (3.0, 3.5) if not periodic[1] else (3.0, 3.0)]
    n, r = 200_000, np.array([0.5, 1.0, 1.4])
    apart = [random.uniform(-a / 2, a / 2, n) - random.uniform(-b / 2, b / 2, n) for a, b in reach]
    for axis in range(2):
        if periodic[axis]:
            apart[axis] -= reach[axis][0] * np.round(apart[axis] / reach[axis][0])
    distance = np.hypot(*apart)
    for radius, chance in zip(r, chance_within(r, reach, periodic), strict=True):
        assert (distance < radius).mean() == pytest.approx(chance, abs=4 * np.sqrt(chance / n))


def test_a_single_result_holds_together(log):
    result = transport(log)
    (diffusion,), (g,) = result.diffusion, result.pair_distributions
    assert diffusion.correlation[0] == pytest.approx(1.0)
    assert diffusion.displacement[0] == pytest.approx(0.0, abs=1e-12)
    lag, temperature = diffusion.lag[1], 1.0
    assert diffusion.displacement[1] == pytest.approx(2 * temperature * lag**2, rel=0.3)  # ballistic
    (rate,), (contact,) = result.collision_rates, result.contacts
    assert contact.value.deviation == pytest.approx(rate.rate.deviation, rel=1e-9)
    assert g.edges[0] == 0.6
    assert result.walled == (not all(log.periodic))
    assert all(abs(estimate.deviation) < 4 for estimate in (rate.rate, contact.value))


def test_a_species_of_one_disc_has_no_pair_with_itself(make):
    lone = '{name = "lone", count = 1, radius = 0.4, temperature = 1.0}'
    result = transport(make(f'species=[{{name = "gas", count = 11, radius = 0.3, temperature = 1.0}}, {lone}]'))
    pairs = [(pair_distribution.species, pair_distribution.other) for pair_distribution in result.pair_distributions]
    assert pairs == [("gas", "gas"), ("gas", "lone")]
    assert json.dumps(result.as_dict(), allow_nan=False)


@pytest.mark.parametrize(
    ("collisions", "caveat"), [(120, "(16 needed)"), (480, "up to 1.3 times too small"), (4400, "")]
)
def test_a_window_of_few_lags_is_said(make, collisions, caveat):
    """One of 20 mean free times each; `calibration.csv` has the errors with 75 and 200 of them."""
    result = transport(make(*PERIODIC, f"run.collisions_per_disc={collisions}"), start=0.0)
    said = [sentence for sentence in result.caveats if "times as long as currents are followed" in sentence]
    assert len(said) == bool(caveat)
    assert all(caveat in sentence for sentence in said)

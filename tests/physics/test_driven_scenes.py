"""Shipped scenes that thermostats, walls or a piston drive, within 4 standard errors of theory; the seeds are fixed."""

import math

import h5py
import numpy as np
import pytest
from helpers.against_theory import LEAST_P, STANDARD_ERRORS, agrees, kinetic_at_even_times, of_runs
from helpers.logs import log_of
from scipy import stats

from idealgas import evolution, profile
from idealgas.analysis.evolution.theory import expected_law, piston_force
from idealgas.statistics.autoregression import inefficiency
from idealgas.statistics.estimates import estimate, mean, ratio
from idealgas.theory import enskog, hard_discs

pytestmark = pytest.mark.slow


def test_heat_bath():
    """Canonical: E/T has a Gamma law of N, so that its mean is N and its variance, the heat capacity, N."""
    log = log_of("heat-bath", "run.until=20000", "log.events=false", "log.snapshot_every=5")
    energy = kinetic_at_even_times(log)[10:]
    n = len(log.discs)
    agrees(mean(energy, n), 0.005)
    agrees(estimate(lambda e, square: square - e**2, energy - n, (energy - n) ** 2, theory=n), 0.05)
    thinned = energy[:: 2 * math.ceil(inefficiency(energy))]
    assert len(thinned) > 300
    assert stats.kstest(thinned, stats.gamma(n).cdf).pvalue > LEAST_P


@pytest.mark.parametrize("rate", [pytest.param(0.1, marks=pytest.mark.long), 0.6, 4.0])
def test_thermostat(rate):
    """Andersen, J. Chem. Phys. 72, 2384 (1980): canonical at any rate, here a tenth to four times that of collisions.

    E/T has a Gamma law of N = D/2; discs are independent of each other, with Maxwell's speeds and T for each direction;
    they remember nothing for long after a few times 1/rate. Collisions are a Poisson process. Var(E) within 3 standard
    errors.
    """
    times = f"log.snapshot_every={1.5 / rate}", f"run.until={3000 / rate}"
    log = log_of("thermostat", *times, f"thermostat.rate={rate}", f"scene.seed={30 + int(rate)}", "log.events=false")
    n = len(log.discs)
    energy = kinetic_at_even_times(log)[6:]
    agrees(mean(energy, n), 0.005)
    fluctuations = estimate(lambda e, square: square - e**2, energy - n, (energy - n) ** 2, theory=n)
    agrees(fluctuations, 0.05)
    assert abs(fluctuations.deviation) < 3
    assert stats.kstest(energy[::3], stats.gamma(n).cdf).pvalue > LEAST_P
    with h5py.File(log.path) as file:
        velocity = file["particles/discs/velocity/value"][6::4].reshape(-1, 2)
    for component in velocity.T:
        agrees(mean(component**2, 1.0), 0.01)
    assert stats.kstest(np.hypot(*velocity.T), stats.rayleigh().cdf).pvalue > LEAST_P
    expected = rate * n * log.end_time
    assert abs(log.summary["thermostat_collisions"] - expected) < STANDARD_ERRORS * math.sqrt(expected)
    assert log.summary["events"] == log.summary["disc_collisions"] + log.summary["thermostat_collisions"]
    assert abs(log.summary["energy_drift"]) < 1e-12


def conductivity_factor(phi):
    """Enskog's conductivity over that of the dilute gas: 1/χ + 3y/2 + 0.8718 χy², y = 2φ: Gass, see below."""
    chi, y = hard_discs.contact_value(phi), 2 * phi
    return 1 / chi + 1.5 * y + 0.8718 * chi * y * y


def test_conduction():
    """What the left side gives the right one takes; the flux is Enskog's conductivity times the slope of T.

    κ = 1.029 (2/σ) √(T/πm) in the dilute gas, Gass, J. Chem. Phys. 54, 1898 (1971), so that T^(3/2) is straight. The
    pressure n T Z(φ) is the same everywhere but in the strips next to the sides. The jumps at the sides are a few mean
    free paths of the gas there long: (2γ/(γ + 1))/Pr = 2.7 of them in Maxwell's estimate.
    """
    fluxes, slopes, ends, pressures = [], [], [], []
    for seed in range(1, 7):
        result = profile(log_of("conduction", "run.until=800", f"scene.seed={seed}"), bins=10, start=100)
        entry = result.species[0]
        n, t = (np.array([e.value for e in column]) for column in (entry.density, entry.temperature))
        slope, middle = np.polyfit(result.middles - 10, t**1.5, 1)
        fluxes.append((result.heat["left"].value, -result.heat["right"].value))
        slopes.append(-slope)
        ends.append((middle - 10 * slope, middle + 10 * slope))
        pressures.append((n * t * hard_discs.compressibility_factor(math.pi * n * 0.01))[1:-1])
    left, right = np.array(fluxes).T
    agrees(of_runs(left / right, 1.0), 0.05)
    conductivity = np.mean(fluxes, axis=1) / 5 / (2 / 3 * np.array(slopes))
    agrees(of_runs(conductivity, 1.029 * 10 / math.sqrt(math.pi) * conductivity_factor(0.1005)), 0.05)
    for strip in (np.array(pressures) / np.mean(pressures, axis=1, keepdims=True)).T:
        agrees(of_runs(strip, 1.0), 0.01)
    hot, cold = np.mean(ends, axis=0)
    for jump, density in ((2**1.5 - hot, n[0]), (cold - 1, n[-1])):
        path = hard_discs.mean_free_path(0.2, density, math.pi * density * 0.01)
        assert 0 < jump / np.mean(slopes) < 5 * path


@pytest.mark.long
def test_compression():
    """d ln T = -Z (1 + ε) dL/(L - 2R): the adiabat, which for points is T A = const, with the gas's viscosity.

    At the piston's speed u the gas is compressed along x at the rate u/L, against which viscosity adds ε = η u/(L P)
    to the pressure (Landau & Lifshitz, Fluid Mechanics, § 15, in two dimensions): 0.2 %. Work and energy to 1e-10.
    """
    actual = []
    for seed in range(1, 13):
        log = log_of("compression", f"scene.seed={seed}")
        course = evolution(log)
        assert np.abs(course.balance).max() < 1e-10
        assert course.given["piston"][-1] == pytest.approx(course.parts["motion"][-1] - 400, rel=1e-10)
        actual.append(course.temperature[-1])
    lengths = np.linspace(20, 10, 129)
    middles = (lengths[1:] + lengths[:-1]) / 2
    log_t = 0.0
    for length, step in zip(middles, np.diff(lengths), strict=True):
        n, t = 40 / length, math.exp(log_t)
        chi = float(hard_discs.contact_value(n * math.pi * 0.0004))
        excess = enskog.viscosity(0.04, n, t, 1.0, chi) * 0.0125 / (length * n * t)
        log_t -= piston_force(log, length) * (1 + excess) * step
    agrees(of_runs(actual, math.exp(log_t)), 1.5e-3)


def piston_at(log, times):
    """Its coordinate between its hits, where it falls freely."""
    rows = [
        (b.time[b.partner == -2], b.position[b.partner == -2, 0]) for b in log.chunks(("time", "partner", "position"))
    ]
    time, place = (np.concatenate(column) for column in zip(*rows, strict=True))
    place += log.discs.radius[0]
    pull = log.scene.piston[0].acceleration(log.box, log.scene.properties.acceleration)
    k = time.searchsorted(times) - 1
    since, whole = times - time[k], np.diff(time)[k]
    return place[k] + np.diff(place)[k] * since / whole - pull * since * (whole - since) / 2


def test_piston():
    """At fixed energy x = F (X - 2R)/E has a Beta law of (N + 1, N + 1/2) for points: mean and variance of the area.

    All of phase space at an energy is as likely; F = P L is the force from outside, and the momenta of discs and piston
    leave (E - F X)^(N + 1/2 - 1). Discs of a size push Z times as hard: N Z for N. Balance of energy to 1e-10.
    """
    log = log_of("piston", "run.until=6000")
    course = evolution(log)
    assert np.abs(course.balance).max() < 1e-10
    n, force, diameter = 200, 20.0, 0.04
    energy = 200 + force * (10 - diameter)
    law = expected_law(log, np.zeros(1))
    a, b = n * piston_force(log, law.piston) * (law.piston - diameter) + 1, n + 0.5
    place = piston_at(log, np.arange(100.0, 5990.0, 5.0))
    share = force * (place - diameter) / energy
    expected = a / (a + b)
    assert force * (law.piston - diameter) / energy == pytest.approx(expected, rel=1e-12)
    agrees(mean(share, expected), 0.005)
    centred = share - expected
    agrees(
        estimate(lambda s, square: square - s**2, centred, centred**2, theory=expected * b / (a + b) / (a + b + 1)), 0.1
    )
    kinetic = [state.velocity for state in log.frames(np.arange(100.0, 5990.0, 5.0))]
    t = np.array([(v**2).sum() / 2 / n for v in kinetic])
    agrees(mean(t, law.temperature[0]), 0.005)
    agrees(ratio(force * (place - diameter), n * t, a / n), 0.01)

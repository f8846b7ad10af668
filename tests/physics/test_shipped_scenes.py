"""The shipped scenes with effects against theory, within 4 standard errors; the seeds are fixed.

What a run must at least resolve is asserted too, so that the tests can fail. Errors come from correlated series, or,
where the course in time is what is measured, from the spread among independent runs.
"""

import math

import h5py
import numpy as np
import pytest
from scipy import stats
from support import ROOT

from idealgas.analysis.core.statistics import Estimate, ensemble_inefficiency, estimate, inefficiency, mean, ratio
from idealgas.analysis.effusion.measure import effusion
from idealgas.analysis.evolution.measure import evolution
from idealgas.analysis.evolution.theory import expected_course, push
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.profile.measure import profile
from idealgas.analysis.sound.measure import sound
from idealgas.analysis.temperature.measure import temperature
from idealgas.analysis.theory import hard_discs
from idealgas.analysis.transport.measure import transport
from idealgas.log import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import load_scene

pytestmark = pytest.mark.slow

STANDARD_ERRORS = 4
LEAST_P = 0.001


@pytest.fixture
def run(tmp_path):
    """Run a shipped scene with overrides; its log, open until the test ends or the next run."""
    logs = []

    def make(name, *overrides):
        for log in logs:
            log.close()
        simulate(load_scene(ROOT / "configs" / f"{name}.toml", overrides), tmp_path / "run.h5", force=True)
        logs.append(open_log(tmp_path / "run.h5"))
        return logs[-1]

    yield make
    for log in logs:
        log.close()


def agrees(found: Estimate, resolution: float) -> None:
    """Within STANDARD_ERRORS of theory, with an error below `resolution` times it."""
    assert found.standard_error < resolution * abs(found.theory)
    assert abs(found.deviation) < STANDARD_ERRORS, found


def of_runs(values, expected) -> Estimate:
    """Mean of independent runs, with the error that their spread gives."""
    values = np.array(values)
    return Estimate(float(values.mean()), float(stats.sem(values)), len(values), float(expected))


def kinetic_at_even_times(log):
    """(F,) of the snapshots."""
    with h5py.File(log.path) as file:
        velocity = file["particles/discs/velocity/value"][:]
    return (log.discs.mass * (velocity**2).sum(axis=2)).sum(axis=1) / 2


def test_periodic(run):
    """Momentum is conserved, and Z by the pairs' virial is that of hard discs without walls."""
    log = run("periodic")
    momentum = log.observables["momentum"][1]
    assert np.abs(momentum - momentum[0]).max() < 1e-12 * np.hypot(*log.discs.velocity.T).sum()
    found = pressure(log)
    (route,) = found.routes
    agrees(route.compressibility, 2e-3)
    assert found.check().agrees
    (rate,) = found.collision_rates
    agrees(rate.rate, 0.01)


def test_baffle(run):
    """Each chamber has the share of the discs that it has of the area their centres reach, very near a quarter.

    That area is the chamber's, less a disc's radius along all walls and a quarter of a circle at each free end.
    """
    log = run("baffle", "run.until=6000")
    radius = log.discs.radius[0]
    baffle = radius * (7 - radius) + math.pi * radius**2 / 4
    outer, inner = ((5 - k * radius) * (10 - 2 * radius) - (2 - k) * baffle for k in (1, 0))
    times = np.arange(300.0, 6000.0, 5.0)
    counts = np.array([np.bincount((s.position[:, 0] / 5).astype(int), minlength=4) for s in log.frames(times)])
    for chamber, area in enumerate((outer, inner, inner, outer)):
        agrees(mean(counts[:, chamber] / 400, area / (2 * (outer + inner))), 0.04)


def test_sinai(run):
    """The mean path between hits is π A/P: Chernov, J. Stat. Phys. 88, 1 (1997), eq. 1.4, after Santaló."""
    log = run("sinai")
    times = np.concatenate([block.time for block in log.chunks(("time",))])
    corners = np.array([wall.start for wall in log.scene.wall])
    sides = np.diff(corners, axis=0, append=corners[:1])
    (x, y), radius = corners.T, log.discs.radius[0]
    polygon = abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    around = np.hypot(*sides.T).sum()
    area = (10 - 2 * radius) ** 2 - (polygon + around * radius + math.pi * radius**2)
    perimeter = 4 * (10 - 2 * radius) + around + 2 * math.pi * radius
    agrees(mean(np.diff(times), math.pi * area / perimeter), 0.015)


def wall_pressure(log, start, end):
    """Of the left side, from what its hits take: (hits' 2 m v)/(length time), in blocks of time."""
    edges = np.linspace(start, end, 33)
    taken = np.zeros(32)
    for block in log.chunks(("time", "partner", "velocity"), log.row_at(start), log.row_at(end)):
        hits = block.partner == -1
        taken += np.histogram(block.time[hits], edges, weights=2 * block.velocity[hits, 0])[0]
    return taken / np.diff(edges) / log.box[1]


def test_free_expansion(run):
    """Joule: the temperature is the same after it; the pressure falls to a half, but for the size of the discs."""
    log = run("free-expansion", "run.until=300", "wall.gate.opens_at=30")
    kinetic = log.observables["kinetic_energy"][1]
    assert np.abs(kinetic / kinetic[0] - 1).max() < 1e-12
    radius = log.discs.radius
    for start, end, width in ((0, 30, 10.0), (100, 300, 20.0)):
        z = hard_discs.box_compressibility(radius[:1], [1000], (width, 10.0))
        expected = 1000 * z / ((width - 2 * radius[0]) * 10)
        agrees(mean(wall_pressure(log, start, end), expected), 0.06)
    left, right = profile(log, "x", bins=2, start=100).species[0].density
    for half in (left, right):
        agrees(half, 0.03)


def test_effusion(run):
    """n⟨v⟩/π through the slit, both ways; a disc that passes has 3T/2: T of its way through and T/2 of that across."""
    log = run("effusion")
    found = effusion(log)
    agrees(found.speed, 0.07)
    assert abs(found.beyond[-1] - found.expected[-1]) < STANDARD_ERRORS * math.sqrt(found.expected[-1])
    times = np.arange(5.0, 150.0, 0.25)
    seen, carried = np.zeros(2000, bool), []
    for state in log.frames(times):
        new = (state.position[:, 0] > 10) & ~seen
        carried.extend((state.velocity[new] ** 2).sum(axis=1) / 2)
        seen |= new
    agrees(of_runs(carried, 1.5), 0.07)


def test_mixing(run):
    """In the end both gases fill the box alike, at the temperature they had."""
    log = run("mixing", "run.until=1500")
    kinetic = log.observables["kinetic_energy"][1]
    assert np.abs(kinetic / kinetic[0] - 1).max() < 1e-12
    for entry in profile(log, "x", bins=2, start=300).species:
        for half in entry.density:
            agrees(half, 0.03)
    for entry in temperature(log, start=300).species[:2]:
        agrees(entry.both, 0.01)


def test_atmosphere(run):
    """The barometric law, and the same temperature at all heights; heights by Kolmogorov and Smirnov, p > 0.001."""
    log = run("atmosphere", "run.until=800")
    found = profile(log, bins=12, start=50)
    assert found.axis == 1
    air = found.species[0]
    for density, warmth in zip(air.density[:6], air.temperature[:6], strict=True):
        agrees(density, 0.06)
        agrees(warmth, 0.06)
    t = air.temperature[0].theory
    heights = np.array([state.position[:, 1] for state in log.frames(np.arange(50.0, 800.0, 2.5))])
    spacing = 2 * math.ceil(ensemble_inefficiency(heights))
    samples = heights[::spacing].ravel()
    assert len(samples) >= 5000
    low, high, scale = 0.01, 59.99, t / 0.2
    assert stats.kstest(samples, stats.truncexpon((high - low) / scale, low, scale).cdf).pvalue > LEAST_P


def test_rough(run):
    """Each of the three degrees of freedom has T = E/(3N/2), though the spins began with nothing: C = 3N/2."""
    log = run("rough", "run.collisions_per_disc=1000")
    found = temperature(log)
    for direction in (found.species[0].x, found.species[0].y):
        agrees(direction, 0.01)
    (spin,) = profile(log, bins=1, start=10).species[0].spin
    agrees(spin, 0.01)
    both = found.species[0].both
    energy = log.discs.kinetic_energy / len(log.discs)
    capacity = Estimate(energy / both.value, energy * both.standard_error / both.value**2, 0, theory=1.5)
    agrees(capacity, 0.01)


def test_brownian_motion(run):
    """A heavy disc forgets its velocity at the rate γ that Enskog's friction gives, before its own wake comes back.

    The other discs recoil, so that the velocity relative to them decays by a part M/(M_all - M) faster.
    """
    rates, friction = [], math.nan
    for seed in range(1, 5):
        log = run("brownian", f"scene.seed={seed}")
        grain = transport(log).diffusion[0]
        friction = 1 / grain.velocity_correlation_time.theory / (1 - 20 / log.discs.mass.sum())
        k = grain.lag.searchsorted(0.1 / friction)
        rates.append(-math.log(grain.correlation[k]) / grain.lag[k])
    agrees(of_runs(rates, friction), resolution=0.04)


def test_gases_under_gravity_separate(run):
    """Each has its own barometric law: 20 strips, two species; P(|t| > 4) = 6e-5 each."""
    found = profile(run("separation"))
    light, heavy = found.species
    for density in (*light.density, *heavy.density):
        if density.value * found.strip > 1:
            assert abs(density.deviation) < STANDARD_ERRORS
    assert light.density[10].standard_error < 0.03 * light.density[10].value
    assert heavy.density[0].value > 4 * heavy.density[-1].value
    assert light.density[0].value < 3 * light.density[-1].value


def test_cooling(run):
    """Haff, J. Fluid Mech. 134, 401 (1983), with the time of Enskog's collision rate and of van Noije & Ernst's a₂.

    Flow in long waves is not cooled by collisions but by viscosity, and so keeps somewhat more than its T/2 a wave. In
    this small box that slows the cooling by 1 or 2 % in the end, which the runs can hardly tell.
    """
    courses = [evolution(run("cooling", f"scene.seed={seed}")) for seed in range(1, 13)]
    for instant in (32, 64, 128, 256):
        ratios = [course.temperature[instant] / course.law.temperature[instant] for course in courses]
        agrees(of_runs(ratios, 1.0), 0.015)
    assert courses[0].temperature[-1] < 0.02


def test_heat_bath(run):
    """Canonical: E/T has a Gamma law of N, so that its mean is N and its variance, the heat capacity, N."""
    log = run("heat-bath", "run.until=20000", "log.events=false", "log.snapshot_every=5")
    energy = kinetic_at_even_times(log)[10:]
    n = len(log.discs)
    agrees(mean(energy, n), 0.005)
    agrees(estimate(lambda e, square: square - e**2, energy - n, (energy - n) ** 2, theory=n), 0.05)
    thinned = energy[:: 2 * math.ceil(inefficiency(energy))]
    assert len(thinned) > 300
    assert stats.kstest(thinned, stats.gamma(n).cdf).pvalue > LEAST_P


@pytest.mark.parametrize("rate", [0.1, 0.6, 4.0])
def test_thermostat(run, rate):
    """Andersen, J. Chem. Phys. 72, 2384 (1980): canonical at any rate, here a tenth to four times that of collisions.

    E/T has a Gamma law of N = D/2; discs are independent of each other, with Maxwell's speeds and T for each direction;
    they remember nothing for long after a few times 1/rate. Kicks come as a Poisson process. Var(E) within 3 standard
    errors.
    """
    times = f"log.snapshot_every={1.5 / rate}", f"run.until={3000 / rate}"
    log = run("thermostat", *times, f"thermostat.rate={rate}", f"scene.seed={30 + int(rate)}", "log.events=false")
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
    assert abs(log.summary["kicks"] - expected) < STANDARD_ERRORS * math.sqrt(expected)
    assert log.summary["events"] == log.summary["disc_collisions"] + log.summary["kicks"]
    assert abs(log.summary["energy_drift"]) < 1e-12


def conductivity_factor(phi):
    """Enskog's conductivity over that of the dilute gas: 1/χ + 3y/2 + 0.8718 χy², y = 2φ: Gass, see below."""
    chi, y = hard_discs.contact_value(phi), 2 * phi
    return 1 / chi + 1.5 * y + 0.8718 * chi * y * y


def test_conduction(run):
    """What the left side gives the right one takes; the flux is Enskog's conductivity times the slope of T.

    κ = 1.029 (2/σ) √(T/πm) in the dilute gas, Gass, J. Chem. Phys. 54, 1898 (1971), so that T^(3/2) is straight. The
    pressure n T Z(φ) is the same everywhere but in the strips next to the sides. The jumps at the sides are a few mean
    free paths long: (2γ/(γ + 1))/Pr = 2.7 of them in Maxwell's estimate.
    """
    fluxes, slopes, ends, pressures = [], [], [], []
    for seed in range(1, 7):
        found = profile(run("conduction", "run.until=800", f"scene.seed={seed}"), bins=10, start=100)
        entry = found.species[0]
        n, t = (np.array([e.value for e in column]) for column in (entry.density, entry.temperature))
        slope, middle = np.polyfit(found.middles - 10, t**1.5, 1)
        fluxes.append((found.heat["left"].value, -found.heat["right"].value))
        slopes.append(-slope)
        ends.append((middle - 10 * slope, middle + 10 * slope))
        pressures.append((n * t * hard_discs.compressibility(math.pi * n * 0.01))[1:-1])
    left, right = np.array(fluxes).T
    agrees(of_runs(left / right, 1.0), 0.05)
    conductivity = np.mean(fluxes, axis=1) / 5 / (2 / 3 * np.array(slopes))
    agrees(of_runs(conductivity, 1.029 * 10 / math.sqrt(math.pi) * conductivity_factor(0.1005)), 0.05)
    for strip in (np.array(pressures) / np.mean(pressures, axis=1, keepdims=True)).T:
        agrees(of_runs(strip, 1.0), 0.01)
    hot, cold = np.mean(ends, axis=0)
    path = hard_discs.mean_free_path(0.2, 3.2, 0.1)
    assert 0 < (2**1.5 - hot) / np.mean(slopes) < 5 * path
    assert 0 < (cold - 1) / np.mean(slopes) < 5 * path


def test_compression(run):
    """d ln T = -Z (1 + ε) dL/(L - 2R): the adiabat, which for points is T A = const, with the gas's viscosity.

    At the piston's speed u the gas is compressed along x at the rate u/L, against which viscosity adds ε = η u/(L P)
    to the pressure (Landau & Lifshitz, Fluid Mechanics, § 15, in two dimensions): 0.2 %. Work and energy to 1e-10.
    """
    found = []
    for seed in range(1, 13):
        log = run("compression", f"scene.seed={seed}")
        course = evolution(log)
        assert np.abs(course.balance).max() < 1e-10
        assert course.given["right"][-1] == pytest.approx(course.parts["motion"][-1] - 400, rel=1e-10)
        found.append(course.temperature[-1])
    lengths = np.linspace(20, 10, 129)
    middles = (lengths[1:] + lengths[:-1]) / 2
    log_t = 0.0
    for length, step in zip(middles, np.diff(lengths), strict=True):
        n, t = 40 / length, math.exp(log_t)
        chi = float(hard_discs.contact_value(n * math.pi * 0.0004))
        excess = hard_discs.enskog_viscosity(0.04, n, t, 1.0, chi) * 0.0125 / (length * n * t)
        log_t -= push(log, length) * (1 + excess) * step
    agrees(of_runs(found, math.exp(log_t)), 1.5e-3)


def piston_at(log, times):
    """Its coordinate between its hits, where it falls freely."""
    rows = [
        (b.time[b.partner == -2], b.position[b.partner == -2, 0]) for b in log.chunks(("time", "partner", "position"))
    ]
    time, place = (np.concatenate(column) for column in zip(*rows, strict=True))
    place += log.discs.radius[0]
    pull = log.scene.piston.acceleration(log.box, None)
    k = time.searchsorted(times) - 1
    since, whole = times - time[k], np.diff(time)[k]
    return place[k] + np.diff(place)[k] * since / whole - pull * since * (whole - since) / 2


def test_piston(run):
    """At fixed energy x = F (X - 2R)/E has a Beta law of (N + 1, N + 1/2) for points: mean and variance of the area.

    All of phase space at an energy is as likely; F = P L is the force from outside, and the momenta of discs and piston
    leave (E - F X)^(N + 1/2 - 1). Discs of a size push Z times as hard: N Z for N. Balance of energy to 1e-10.
    """
    log = run("piston", "run.until=6000")
    course = evolution(log)
    assert np.abs(course.balance).max() < 1e-10
    n, force, diameter = 200, 20.0, 0.04
    energy = 200 + force * (10 - diameter)
    law = expected_course(log, np.zeros(1))
    a, b = n * push(log, law.piston) * (law.piston - diameter) + 1, n + 0.5
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


def test_sound_of_a_fluid(run):
    found = sound(run("sound"))
    (wave,) = found.waves
    agrees(wave.speed, 0.05)
    agrees(wave.damping, 0.3)
    assert found.premises == ()

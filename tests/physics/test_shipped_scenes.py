"""The shipped scenes with effects against theory, within 4 standard errors; the seeds are fixed.

What a run must at least resolve is asserted too, so that the tests can fail. Errors come from correlated series, or,
where the course in time is what is measured, from the spread among independent runs.
"""

import math

import numpy as np
import pytest
from helpers.against_theory import LEAST_P, STANDARD_ERRORS, agrees, all_agree, of_runs
from helpers.logs import log_of
from scipy import stats

from idealgas import effusion, evolution, profile, sound
from idealgas.analysis.transport.measure import transport
from idealgas.statistics.autoregression import inefficiency
from idealgas.statistics.estimates import mean
from idealgas.theory import hard_discs

pytestmark = pytest.mark.slow

ROWS = [
    ("periodic", (), 2e-3, "pressure", ("routes.*.compressibility_factor",), {}),
    ("periodic", (), 0.01, "pressure", ("collision_rates.*.rate",), {}),
    ("effusion", (), 0.07, "effusion", ("speed",), {}),
    ("free-expansion", ("run.until=300", "wall.gate.opens_at=30"), 0.03, "profile", ("species.*.density.?",),
     {"along": "x", "bins": 2, "start": 100}),
    ("mixing", ("run.until=1500",), 0.03, "profile", ("species.*.density.?",), {"along": "x", "bins": 2, "start": 300}),
    ("mixing", ("run.until=1500",), 0.01, "temperature", ("species.red.both", "species.blue.both"), {"start": 300}),
    ("atmosphere", ("run.until=800",), 0.06, "profile", ("species.air.density.[0-5]", "species.air.temperature.[0-5]"),
     {"bins": 12, "start": 50}),
    ("rough", ("run.collisions_per_disc=1000",), 0.01, "temperature", ("species.*.[xy]", "species.*.both"), {}),
    ("rough", ("run.collisions_per_disc=1000",), 0.01, "profile", ("species.*.spin.0",), {"bins": 1, "start": 10}),
    ("sound", (), 0.05, "sound", ("waves.*.speed",), {}),
    ("sound", (), 0.3, "sound", ("waves.*.damping",), {}),
]  # fmt: skip
"""Scene, overrides, the error that must be resolved, relative, analysis, its quantities, and options."""


@pytest.mark.parametrize(("scene", "overrides", "resolution", "analysis", "quantities", "options"), ROWS)
def test_quantities_agree_with_theory(scene, overrides, resolution, analysis, quantities, options):
    """Rough discs have E/(3N/2) for each degree of freedom, though their spins began with nothing."""
    all_agree(log_of(scene, *overrides), resolution, analysis, *quantities, **options)


def test_baffle():
    """Each chamber has the share of the discs that it has of the area their centres reach, very near a quarter.

    That area is the chamber's, less a disc's radius along all walls and a quarter of a circle at each free end.
    """
    log = log_of("baffle", "run.until=6000")
    radius = log.discs.radius[0]
    baffle = radius * (7 - radius) + math.pi * radius**2 / 4
    outer, inner = ((5 - k * radius) * (10 - 2 * radius) - (2 - k) * baffle for k in (1, 0))
    times = np.arange(300.0, 6000.0, 5.0)
    counts = np.array([np.bincount((s.position[:, 0] / 5).astype(int), minlength=4) for s in log.frames(times)])
    for chamber, area in enumerate((outer, inner, inner, outer)):
        agrees(mean(counts[:, chamber] / 400, area / (2 * (outer + inner))), 0.04)


def wall_pressure(log, start, end):
    """Of the left side, from what its hits take: (hits' 2 m v)/(length time), in blocks of time."""
    edges = np.linspace(start, end, 33)
    taken = np.zeros(32)
    for block in log.chunks(("time", "partner", "velocity"), log.row_at(start), log.row_at(end)):
        hits = block.partner == -1
        taken += np.histogram(block.time[hits], edges, weights=2 * block.velocity[hits, 0])[0]
    return taken / np.diff(edges) / log.box[1]


def test_free_expansion():
    """Joule: the temperature is the same after it; the pressure falls to a half, but for the size of the discs."""
    log = log_of("free-expansion", "run.until=300", "wall.gate.opens_at=30")
    kinetic = log.observables["kinetic_energy"][1]
    assert np.abs(kinetic / kinetic[0] - 1).max() < 1e-12
    radius = log.discs.radius
    for start, end, width in ((0, 30, 10.0), (100, 300, 20.0)):
        z = hard_discs.box_compressibility_factor(radius[:1], [1000], (width, 10.0))
        expected = 1000 * z / ((width - 2 * radius[0]) * 10)
        agrees(mean(wall_pressure(log, start, end), expected), 0.06)


def test_effusion():
    """n⟨v⟩/π through the slit, both ways; a disc that passes has 3T/2: T of its way through and T/2 of that across."""
    log = log_of("effusion")
    result = effusion(log)
    assert abs(result.beyond[-1] - result.expected[-1]) < STANDARD_ERRORS * math.sqrt(result.expected[-1])
    times = np.arange(5.0, 150.0, 0.25)
    seen, carried = np.zeros(2000, bool), []
    for state in log.frames(times):
        new = (state.position[:, 0] > 10) & ~seen
        carried.extend((state.velocity[new] ** 2).sum(axis=1) / 2)
        seen |= new
    agrees(of_runs(carried, 1.5), 0.07)


def test_atmosphere():
    """The barometric law: heights by Kolmogorov and Smirnov, p > 0.001."""
    log = log_of("atmosphere", "run.until=800")
    result = profile(log, bins=12, start=50)
    assert result.axis == "y"
    t = result.species[0].temperature[0].theory
    heights = np.array([state.position[:, 1] for state in log.frames(np.arange(50.0, 800.0, 2.5))])
    spacing = 2 * math.ceil(inefficiency(heights))
    samples = heights[::spacing].ravel()
    assert len(samples) >= 5000
    low, high, scale = 0.01, 59.99, t / 0.2
    assert stats.kstest(samples, stats.truncexpon((high - low) / scale, low, scale).cdf).pvalue > LEAST_P


@pytest.mark.long
def test_brownian_motion():
    """A heavy disc forgets its velocity at first at the rate γ of Enskog's friction: over a fiftieth of 1/γ.

    Later its own wake carries it along.
    The other discs recoil, so that the velocity relative to them decays at γ/(1 - M/M_all).
    """
    rates, friction = [], math.nan
    for seed in range(1, 9):
        log = log_of("brownian", f"scene.seed={seed}")
        grain = transport(log).diffusion[0]
        friction = 1 / grain.velocity_correlation_time.theory
        rates.append(-math.log(grain.correlation[1]) / grain.lag[1])
    agrees(of_runs(rates, friction), resolution=0.04)


def test_gases_under_gravity_separate():
    """Each has its own barometric law: 20 strips, two species; P(|t| > 4) = 6e-5 each."""
    result = profile(log_of("separation"))
    light, heavy = result.species
    for density in (*light.density, *heavy.density):
        if density.value * result.strip > 1:
            assert abs(density.deviation) < STANDARD_ERRORS
    assert light.density[10].standard_error < 0.03 * light.density[10].value
    assert heavy.density[0].value > 4 * heavy.density[-1].value
    assert light.density[0].value < 3 * light.density[-1].value


def test_cooling():
    """Haff, J. Fluid Mech. 134, 401 (1983), with the time of Enskog's collision rate and of van Noije & Ernst's a₂.

    Flow in long waves is not cooled by collisions but by viscosity, and so keeps somewhat more than its T/2 a wave. In
    this small box that slows the cooling by 1 or 2 % in the end, which the runs can hardly tell.
    """
    curves = [evolution(log_of("cooling", f"scene.seed={seed}")) for seed in range(1, 13)]
    for instant in (32, 64, 128, 256):
        ratios = [course.temperature[instant] / course.law.temperature[instant] for course in curves]
        agrees(of_runs(ratios, 1.0), 0.015)
    assert curves[0].temperature[-1] < 0.02


def test_sound_of_a_fluid_has_no_caveat():
    assert sound(log_of("sound")).caveats == ()

"""Fixed discs: exact reflections; the periodic Lorentz gas against exact results."""

import math

import numpy as np
import pytest
from helpers.logs import log_of
from helpers.support import ROOT

from idealgas import transport
from idealgas.columns import Kind

GOLDEN = ROOT / "tests" / "cases" / "golden" / "fixed-discs.toml"


@pytest.mark.usefixtures("uncompiled")
def test_a_reflection_at_45_degrees():
    """The centres are 2.5 apart along (1, 1): a disc that comes along x leaves along y."""
    place = 5 - 2.5 / math.sqrt(2)
    discs = f"""
        disc = [
            {{ position = [5, 5], radius = 2, fixed = true }},
            {{ position = [{place - 1!r}, {10 - place!r}], velocity = [1, 0], radius = 0.5 }},
        ]
    """
    log = log_of(f"box.size = [10, 10]\n{discs}\nrun.events = 1")
    (rows,) = log.chunks()
    assert (rows.kind.tolist(), rows.partner.tolist()) == ([Kind.FIXED_DISC], [-5])
    assert rows.time[0] == pytest.approx(1, rel=1e-14)
    assert rows.velocity[0].tolist() == pytest.approx([0, 1], abs=1e-14)
    assert log.walls[4].name == "fixed disc 0"


def test_fixed_discs_are_none_of_the_gas():
    """They count neither in N nor in T, and discs at random keep clear of them, also across periodic sides."""
    log = log_of(GOLDEN, "gravity=", "restitution=")
    assert (log.scene.number_of_discs, len(log.scene.explicit_discs)) == (31, 1)
    assert len(log.discs) == 31
    for x, y, radius in ((0, 4, 1.5), (10, 4, 1.5), (5, 5, 0.75)):
        assert (np.hypot(*(log.discs.position - (x, y)).T) >= radius + log.discs.radius).all()
    assert log.observables["kinetic_energy"][1][-1] == pytest.approx(30 * 1 + 0.5, rel=1e-12)


def billiard_diffusion(gap, points=4000, times=(20.0, 120.0)):
    """D, and its error, of points of speed 1 among discs of radius 1 in a triangular lattice: positions, no events.

    Each point flies from hit to hit; D is the growth of its squared displacement between two times.
    """
    lattice = (2 + gap) * np.array([[1, 0], [0.5, math.sqrt(0.75)]])
    near = np.array([(i, j) for i in range(-3, 4) for j in range(-3, 4)]) @ lattice
    rng = np.random.default_rng(1)
    place = rng.random((20 * points, 2)) @ lattice
    start = place = place[(np.hypot(*(place[:, None] - near).T) > 1).all(axis=0)][:points]
    angle = rng.uniform(0, 2 * math.pi, points)
    velocity = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    time, square = np.zeros(points), np.zeros((2, points))
    while (time < times[1]).any():
        centre = near + (np.rint(place @ np.linalg.inv(lattice)) @ lattice)[:, None]
        apart = place[:, None] - centre
        along = (apart * velocity[:, None]).sum(axis=2)
        root = along**2 - (apart**2).sum(axis=2) + 1
        hits = np.where((along < -1e-9) & (root > 0), -along - np.sqrt(np.maximum(root, 0)), np.inf)
        hit = (np.arange(points), hits.argmin(axis=1))
        for i, instant in enumerate(times):
            now = (time <= instant) & (instant < time + hits[hit])
            there = place[now] + velocity[now] * (instant - time[now])[:, None]
            square[i, now] = ((there - start[now]) ** 2).sum(axis=1)
        time, place = time + hits[hit], place + velocity * hits[hit][:, None]
        normal = place - centre[hit]
        velocity = velocity - 2 * (velocity * normal).sum(axis=1)[:, None] * normal
        velocity /= np.hypot(*velocity.T)[:, None]
    growth = (square[1] - square[0]) / (4 * (times[1] - times[0]))
    return growth.mean(), growth.std() / math.sqrt(points)


@pytest.fixture(scope="module")
def lorentz():
    return log_of("lorentz")


def test_the_mean_free_path_is_exact(lorentz):
    """Between hits π A/P: Santaló's formula (Chernov, J. Stat. Phys. 88, 1 (1997)); within 3 s.e. of 100 discs."""
    reach = 1 + 1e-6
    disc, partner = (np.concatenate([getattr(b, name) for b in lorentz.chunks()]) for name in ("disc", "partner"))
    rate = np.bincount(disc[partner < -4], minlength=100) / lorentz.end_time  # the speed is 1
    area, perimeter = 2.25 * 2.25 * math.sqrt(3) - 2 * math.pi * reach**2, 4 * math.pi * reach
    error = rate.std(ddof=1) / 10
    assert abs(rate.mean() - perimeter / (math.pi * area)) < 3 * error
    assert error < 0.01 * rate.mean()


def test_diffusion_by_both_routes(lorentz):
    """Displacement and velocity correlation give one D, within 4 s.e. of both; that of a billiard within 3."""
    result = transport(lorentz)
    (entry,) = result.diffusion
    einstein, memory = entry.coefficient, entry.velocity_correlation_time
    assert result.collective is None
    assert not result.collision_rates
    assert abs(einstein.value - memory.value / 2) < 4 * (einstein.standard_error + memory.standard_error / 2)
    assert 0 < einstein.standard_error < 0.03 * einstein.value
    billiard, error = billiard_diffusion(0.25)
    assert abs(einstein.value - billiard) < 3 * math.hypot(error, einstein.standard_error)


@pytest.mark.slow
def test_diffusion_through_narrow_gaps():
    """That of a billiard within 3 s.e., also where discs stay long in each pocket."""
    height = 2.1 * math.sqrt(3)
    changes = [f"box.size=[2.1, {height!r}]", f"disc.1.position=[1.05, {height / 2!r}]"]
    log = log_of("lorentz", *changes)
    (entry,) = transport(log, start=0).diffusion
    billiard, error = billiard_diffusion(0.1)
    assert abs(entry.coefficient.value - billiard) < 3 * math.hypot(error, entry.coefficient.standard_error)


def test_the_energy_of_each_disc_stays(lorentz):
    velocity = lorentz.state_at(lorentz.end_time).velocity
    met = np.unique(np.concatenate([b.disc[b.kind == Kind.DISC] for b in lorentz.chunks()]))
    alone = np.setdiff1d(np.arange(100), met)
    assert len(alone) > 50
    assert np.abs(np.hypot(*velocity[alone].T) - 1).max() < 1e-13

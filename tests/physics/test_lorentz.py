"""Fixed discs: exact reflections, the same by all methods; the periodic Lorentz gas against exact results."""

import math

import numpy as np
import pytest
from helpers.log_compare import same_by_brute_force_and_resumed
from helpers.support import ROOT

from idealgas import load_scene, open_log, parse_scene, simulate, transport
from idealgas.columns import Kind

GOLDEN = ROOT / "tests" / "cases" / "golden" / "fixed-discs.toml"
LORENTZ = ROOT / "configs" / "lorentz.toml"


@pytest.mark.parametrize(
    "gravity",
    [pytest.param((), id="falling"), pytest.param(("gravity=", "restitution="), marks=pytest.mark.slow, id="straight")],
)
def test_the_same_by_brute_force_and_resumed(tmp_path, gravity):
    summary = same_by_brute_force_and_resumed(tmp_path, GOLDEN, gravity, "run.until=12")
    with open_log(tmp_path / "whole.h5") as log:
        partner = np.concatenate([block.partner for block in log.chunks()])
        assert min((partner == -6).sum(), (partner == -7).sum()) > 15
    assert summary.deepest_overlap < 1e-14


@pytest.mark.usefixtures("uncompiled")
def test_a_reflection_at_45_degrees(tmp_path):
    """The centres are 2.5 apart along (1, 1): a disc that comes along x leaves along y."""
    place = 5 - 2.5 / math.sqrt(2)
    discs = f"""
        disc = [
            {{ position = [5, 5], radius = 2, fixed = true }},
            {{ position = [{place - 1!r}, {10 - place!r}], velocity = [1, 0], radius = 0.5 }},
        ]
    """
    simulate(parse_scene(f"box.size = [10, 10]\n{discs}\nrun.events = 1"), tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        (rows,) = log.chunks()
        assert (rows.kind.tolist(), rows.partner.tolist()) == ([Kind.WALL_END], [-5])
        assert rows.time[0] == pytest.approx(1, rel=1e-14)
        assert rows.velocity[0].tolist() == pytest.approx([0, 1], abs=1e-14)
        assert log.walls[4].name == "disc 0"


def test_fixed_discs_are_none_of_the_gas(tmp_path):
    """They count neither in N nor in T, and discs at random keep clear of them, also across periodic sides."""
    scene = load_scene(GOLDEN, ["gravity=", "restitution="])
    assert (scene.number_of_discs, len(scene.given)) == (31, 1)
    simulate(scene, tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        assert len(log.discs) == 31
        for x, y, radius in ((0, 4, 1.5), (10, 4, 1.5), (5, 5, 0.75)):
            assert (np.hypot(*(log.discs.position - (x, y)).T) >= radius + log.discs.radius).all()
        assert log.observables["kinetic_energy"][1][-1] == pytest.approx(30 * 1 + 0.5, rel=1e-12)


@pytest.fixture(scope="module")
def lorentz(tmp_path_factory):
    path = tmp_path_factory.mktemp("lorentz") / "run.h5"
    simulate(load_scene(LORENTZ), path)
    with open_log(path) as log:
        yield log


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
    """Displacement and velocity correlation give one D, within 4 s.e. of both.

    In gaps this wide D is larger than that of a random walk between pockets: Klages & Dellago, J. Stat. Phys. 101, 145
    (2000).
    """
    found = transport(lorentz)
    (entry,) = found.diffusion
    einstein, memory = entry.coefficient, entry.velocity_correlation_time
    assert found.collective is None
    assert not found.collision_rates
    assert abs(einstein.value - memory.value / 2) < 4 * (einstein.standard_error + memory.standard_error / 2)
    assert 0 < einstein.standard_error < 0.03 * einstein.value
    walk = 0.25 * 2.25**2 / (math.pi * (math.sqrt(3) * 2.25**2 - 2 * math.pi))
    assert einstein.value - 4 * einstein.standard_error > walk


def test_the_energy_of_each_disc_stays(lorentz):
    velocity = lorentz.state_at(lorentz.end_time).velocity
    met = np.unique(np.concatenate([b.disc[b.kind == Kind.DISC] for b in lorentz.chunks()]))
    alone = np.setdiff1d(np.arange(100), met)
    assert len(alone) > 50
    assert np.abs(np.hypot(*velocity[alone].T) - 1).max() < 1e-13

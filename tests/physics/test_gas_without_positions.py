"""The gas without positions against kinetic theory, and beside the event-driven one on its way to equilibrium.

Seeds are fixed; deviations are counted in standard errors, and what a run must at least resolve is asserted too.
"""

import math

import numpy as np
import pytest
from helpers.against_theory import LEAST_P, STANDARD_ERRORS, agrees, all_agree
from helpers.log_compare import differences
from helpers.logs import gas, log_of, raised, species

from idealgas import histogram, relaxation
from idealgas.analysis.info import info
from idealgas.analysis.relaxation.acceptance import acceptance
from idealgas.log import open_log
from idealgas.run.resume import resume
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene


def equal_speeds(method, number, seed, collisions_per_disc, packing_fraction=0.01, keys=""):
    radius, run = math.sqrt(packing_fraction * 100 / (math.pi * number)), f"collisions_per_disc = {collisions_per_disc}"
    return gas(number, radius, (10, 10), run, speed=1.0, seed=seed, then=f"run.method = '{method}'\n{keys}")


@pytest.fixture(scope="module")
def log():
    """Half a million collisions of 500 discs."""
    return log_of(equal_speeds("monte_carlo", 500, 4, 2000, keys="run.v_ref = 9.0"))


def test_energy_and_momentum_are_conserved(log):
    energy, momentum = log.observables["kinetic_energy"][1], log.observables["momentum"][1]
    assert np.abs(energy / energy[0] - 1).max() < 1e-12
    scale = np.abs(log.discs.velocity).sum()
    assert np.abs(momentum - momentum[0]).max() < 1e-12 * scale
    assert abs(log.summary["energy_drift"]) < 1e-12


def test_every_collision_conserves_energy_and_momentum(log):
    velocity = log.discs.velocity.copy()
    rows = next(log.chunks(("disc", "velocity")))
    for first in range(0, 4000, 2):
        pair = rows.disc[first : first + 2]
        before, after = velocity[pair], rows.velocity[first : first + 2]
        assert (after**2).sum() == pytest.approx((before**2).sum(), rel=1e-14)
        assert after.sum(axis=0) == pytest.approx(before.sum(axis=0), abs=1e-14)
        velocity[pair] = after


@pytest.mark.parametrize("quantity", ["speed", "vx", "energy"])
def test_velocities_in_equilibrium(log, quantity):
    (result,) = histogram(log, quantity).distributions
    assert result.samples > 7000
    maxwell, fixed = result.tests
    assert maxwell.p_value > LEAST_P
    assert fixed.p_value > LEAST_P
    assert fixed.law_name == "fixed energy (998 degrees of freedom)"


@pytest.mark.parametrize("quantity", ["free-path", "free-time", "waiting-time", "collisions"])
def test_time_is_that_of_kinetic_theory(log, quantity):
    """Collision rate and mean free path, and the laws of free flights, which a gas without memory follows exactly."""
    (result,) = histogram(log, quantity).distributions
    assert result.samples > 4_000
    assert result.tests[0].p_value > LEAST_P
    if quantity != "waiting-time":
        agrees(result.mean, 3e-3)
    for name, each in result.cumulants.items():  # a Poisson process has 1
        assert abs(each.deviation) < STANDARD_ERRORS, name
        assert each.theory > 1 + 4 * each.standard_error


def test_acceptance(log):
    result = acceptance(log)
    assert result.collisions == 500_000
    agrees(result.acceptance, 3e-3)


def test_equipartition_in_a_mixture():
    run = "run.method = 'monte_carlo'\nrun.v_ref = 25.0"
    light = gas(300, 0.02, (10, 10), "collisions_per_disc = 1500", name="light", temperature=1.5, seed=3, then=run)
    log = log_of(light + species("heavy", 100, 0.05, mass=4.0, temperature=0.2))
    all_agree(log, 0.01, "temperature", "species.light.*", "species.heavy.*")
    all_agree(log, 0.01, "histogram", "distributions.*.mean", quantity="free-time")


def test_relaxation_agrees_with_the_event_driven_gas():
    """The fourth moment at φ = 0.01, against collisions and against time."""
    result = {}
    for method, keys in (("event_driven", ""), ("monte_carlo", "run.v_ref = 9.0")):
        result[method] = relaxation(log_of(equal_speeds(method, 4000, 12, 20, keys=keys)))
    exact, random = result["event_driven"], result["monte_carlo"]
    for name in ("in_collisions", "in_time"):
        a, b = getattr(exact, name), getattr(random, name)
        error = math.hypot(a.standard_error, b.standard_error)
        assert abs(a.value - b.value) < STANDARD_ERRORS * error, name
        assert error < 0.08 * a.value
    at = np.array([0.5, 1.0, 2.0, 3.0, 5.0, 8.0])
    curves = [np.interp(at, r.collisions, r.kurtosis) for r in (exact, random)]
    error = math.sqrt(2) * 2 / math.sqrt(4000)  # of the kurtosis in equilibrium, where it fluctuates most
    assert np.abs(curves[0] - curves[1]).max() < STANDARD_ERRORS * error
    assert curves[0][0] < 1.2 < 1.5 < curves[0][3]


def test_the_classic_run():
    """28 000 trials of 200 equal speeds: about 7 020 collisions, and speeds that nobody can tell from Maxwell's."""
    log = log_of("novak-bortz")
    tried, result = acceptance(log), relaxation(log)
    assert tried.number == 28_000
    assert tried.published == 6_552
    assert tried.at_start == pytest.approx(4 / math.pi / 5, rel=0.02)
    assert tried.expected["Maxwell-Boltzmann"] == pytest.approx(math.sqrt(math.pi / 2) / 5, rel=1e-12)
    assert abs(tried.collisions - 7_020) < STANDARD_ERRORS * math.sqrt(7_020 * 0.75)
    assert result.indistinguishable_after["collisions_per_disc"] < 12


def test_too_small_a_reference_speed_leaves_a_readable_log(tmp_path):
    path = tmp_path / "run.h5"
    scene = parse_scene(equal_speeds("monte_carlo", 100, 1, 5000, keys="run.v_ref = 3.5"))
    raised(r"run\.v_ref: too small", simulate, scene, path)
    with open_log(path) as log:
        assert not log.complete


def test_a_default_reference_speed_is_enough_for_every_run(tmp_path):
    """It rises in all of these runs; the shares accepted are right together, and any break leaves the log as it is."""
    deviations = []
    for seed in range(40):
        log, part = log_of(equal_speeds("monte_carlo", 300, seed, 60)), tmp_path / "part.h5"
        result = acceptance(log)
        values = log.observables["v_ref"][1]
        told = info(log)["run"]["v_ref"]
        assert told == {"start": values[0], "end": values[-1], "raises": len(result.reference_speeds) - 1}
        deviations.append(result.acceptance.deviation)
        assert values[0] == pytest.approx(5)
        assert (np.diff(values) >= 0).all()
        assert [speed.v_ref for speed in result.reference_speeds] == sorted(set(values.tolist()))
        assert len(result.reference_speeds) > 1
        if seed < 4:
            simulate(parse_scene(equal_speeds("monte_carlo", 300, seed, 20)), part, force=True)
            resume(part, ["run.collisions_per_disc=60"])
            assert differences(part, log.path) == []
    assert abs(np.mean(deviations)) < STANDARD_ERRORS / math.sqrt(len(deviations))


@pytest.mark.slow
def test_a_large_gas_of_equal_speeds():
    """20 000 discs have pairs faster than 5 times their speed at any time; each of six seeds comes to its end."""
    for seed in range(6):
        assert log_of(equal_speeds("monte_carlo", 20_000, seed, 20)).complete


@pytest.mark.parametrize(("number", "settled"), [(500, 5.0), (100, 25.0)])
def test_the_time_to_settle_goes_with_the_density(number, settled):
    """About 5 units for 500 discs, about 25 for a fifth of them, within three standard errors of a single run."""
    result = relaxation(log_of(f"relaxation-{number}"))
    assert result.number == number
    assert abs(3 * result.in_time.value - settled) < 3 * 3 * result.in_time.standard_error
    assert result.in_time.standard_error < (0.2 if number == 500 else 0.4) * result.in_time.value

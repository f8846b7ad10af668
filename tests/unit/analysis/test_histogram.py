"""Which gases have laws of their velocities and free flights, and what stands in their place."""

import json
from dataclasses import replace

import numpy as np
import pytest
from helpers.logs import gas, raised

from idealgas import histogram
from idealgas.tallies.collisions import expected_rates, theory_of
from idealgas.tallies.equilibrium import known_ensemble

GAS = gas(40, 0.1, (8, 6), "until = 30", temperature=1.5, seed=3)

WITHOUT = {
    "restitution.normal=0.9": "the gas loses energy (restitution)",
    "piston=[{ velocity = -0.05 }]": "the gas is driven (piston)",
    "box={ size = [8, 6], left = { thermal = 1 }, right = { thermal = 2 } }": "walls have 2 temperatures",
}


@pytest.mark.parametrize("override", WITHOUT)
def test_no_law_and_why(override, make):
    result = histogram(make(override))
    assert result.no_law == WITHOUT[override]
    (gas,) = result.distributions
    assert gas.tests == ()
    assert gas.mean.theory is None
    assert (gas.density * np.diff(gas.edges)).sum() == pytest.approx(1, abs=0.02)  # nothing to speak of is beyond
    assert json.loads(json.dumps(result.as_dict(), allow_nan=False))["no_law"] == result.no_law
    (table,) = result.plain_tables()
    assert f"Theory is not available: {result.no_law}." in table.notes
    assert result.plot().axes[0].get_legend().get_texts()[0].get_text() == "gas (no law)"


def test_without_a_stationary_state_the_window_is_the_whole_log(make):
    cooling = make("restitution.normal=0.9")
    assert histogram(cooling).window.as_dict() == {"start": 0.0, "end": 30.0, "equilibration_detected": False}
    assert histogram(cooling, start=20.0).window.start == 20.0
    assert histogram(cooling, "waiting-time").no_law
    conduction = make("box={ size = [8, 6], left = { thermal = 1 }, right = { thermal = 2 } }")
    result = histogram(conduction, "waiting-time")  # it is stationary, if not in equilibrium
    assert result.window.detected
    assert result.no_law is None


@pytest.mark.parametrize(
    "override", ["gravity.acceleration=[0, -0.3]", "piston=[{ side = 'top', position = 4, mass = 8, pressure = 2 }]"]
)
def test_maxwell_at_the_measured_temperature(override, make):
    log = make(override)
    (gas,) = histogram(log, start=5.0).distributions
    (test,) = gas.tests
    assert test.law_name == "Maxwell-Boltzmann, measured T"
    states = [(state.velocity**2).sum() / 80 for state in log.frames(np.linspace(5, 30, 2000))]
    assert test.law.mean == pytest.approx(np.sqrt(np.pi * np.mean(states) / 2), rel=1e-3)
    assert gas.mean.theory is None  # of the same velocities


def test_maxwell_at_the_temperature_of_the_walls(make):
    log = make("gravity.acceleration=[0, -0.3]", "box.bottom={ thermal = 2 }")
    (gas,) = histogram(log, "energy").distributions
    assert [(test.law_name, test.law.mean) for test in gas.tests] == [("Maxwell-Boltzmann", 2.0)]
    assert gas.mean.theory == 2.0


def test_discs_that_start_at_rest_fall(make):
    log = make("species.temperature=", "species.speed=0", "gravity.acceleration=[0, -0.3]")
    assert histogram(log, start=10.0).distributions[0].mean.value > 0.2
    raised("no disc moves", histogram, make("species.temperature=", "species.speed=0", "species.count=1"), start=0.0)


def test_free_flights_in_a_gas_that_is_not_uniform(make):
    result = histogram(make("gravity.acceleration=[0, -0.3]"), "free-time")
    assert result.no_law == "the gas is not uniform (gravity)"
    assert result.distributions[0].tests == ()
    assert 0.5 < result.distributions[0].mean.value < 10
    raised(
        "too few collisions between discs",
        histogram,
        make("gravity.acceleration=[0, -0.3]", "species.count=1"),
        "free-path",
    )


@pytest.mark.usefixtures("uncompiled")
def test_mean_free_path_without_positions(make):
    """Mean speed over Enskog's rate, 2σ (N - 1) χ/A times the mean relative speed.

    As the total momentum is 0, the mean relative speed is √2 √(N/(N - 1)) times the mean speed.
    """
    (gas,) = histogram(make('run.method="monte_carlo"'), "free-path").distributions
    phi = 40 * np.pi * 0.01 / 48
    chi = (1 - 7 * phi / 16) / (1 - phi) ** 2
    path = np.sqrt(39 / 40) * 48 / (2 * np.sqrt(2) * 0.2 * 39 * chi)
    assert gas.mean.theory == pytest.approx(path, rel=1e-12)
    assert gas.edges[-1] == pytest.approx(10 * path)


def test_a_single_disc_has_no_law(make):
    result = histogram(make("gravity.acceleration=[0, -0.3]", "species.count=1"))
    assert result.no_law == "a single disc cannot share its energy"


def test_figure_of_values_outside_all_bins(make):
    """The range follows from samples of the energy, between which a gas may be far hotter."""
    result = histogram(make())
    (gas,) = result.distributions
    beyond = replace(result, distributions=(replace(gas, density=np.zeros_like(gas.density)),))
    assert beyond.plot().axes[0].get_xlim() == (gas.edges[0], gas.edges[-1])


def test_numbers_of_collisions_have_a_theory_for_equal_discs(make):
    """The mean number has the relative error of the collision rate."""
    log = make()
    (gas,) = histogram(log, "collisions").distributions
    (relative,) = expected_rates(log.box, known_ensemble(log), theory_of(log)).relative_error.ravel()
    assert gas.mean.theory_error == pytest.approx(relative * gas.mean.theory)
    assert relative > 0
    assert gas.cumulants["variance_over_mean"].theory is not None
    two = [
        f"{{ name = '{name}', count = 20, radius = {r}, temperature = 1.5 }}" for name, r in (("a", 0.1), ("b", 0.2))
    ]
    result = histogram(make(f"species=[{', '.join(two)}]"), "collisions")
    assert result.no_law == "it is known only for equal discs"
    for each in result.distributions:
        assert (each.tests, each.mean.theory) == ((), None)
        assert each.cumulants["variance_over_mean"].theory is None

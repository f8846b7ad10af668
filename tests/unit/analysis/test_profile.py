"""Strips across an axis, against counting by hand, and the theories beside them."""

import json
import math

import numpy as np
import pytest
from helpers.logs import PERIODIC, gas, log_of, species
from scipy.signal import lfilter
from scipy.stats import kstest

from idealgas import evolution, profile, temperature
from idealgas.analysis.profile.strips import strip_test
from idealgas.analysis.profile.theory import JUMP, conduct, expected_profile, natural_axis
from idealgas.tallies.equilibrium import column_temperature
from idealgas.theory.conserved import centre_of_mass_velocity
from idealgas.theory.ensemble import composition
from idealgas.theory.hard_discs import compressibility_factor, mean_free_path

LIGHT = gas(40, 0.1, (12, 8), "collisions_per_disc = 40", name="light", seed=3)
GAS = LIGHT + species("heavy", 20, 0.2, mass=3)


HOT_AND_COLD = ("box.bottom={ thermal = 4 }", "box.top={ thermal = 1 }")
EQUAL = "species=[{ name = 'gas', count = 300, radius = 0.1, temperature = 2 }]"


def test_strips_are_counted_by_hand(make):
    log = make("rotation={ inertia = 0.4 }")
    result = profile(log, "y", bins=4, start=1.0, end=3.0)
    assert result.edges == pytest.approx([0.1, 2.05, 4.0, 5.95, 7.9])
    gas, frames = log.discs, list(log.frames(np.linspace(1.0, 3.0, result.frames)))
    for s, entry in enumerate(result.species):
        for k in range(4):
            counts, motion, spin = 0, 0.0, 0.0
            for state in frames:
                y = state.position[:, 1]
                inside = (gas.species == s) & (y >= result.edges[k]) & (y < result.edges[k + 1])
                counts += inside.sum()
                motion += (gas.mass * (state.velocity**2).sum(axis=1) / 2)[inside].sum()
                spin += (0.4 * gas.mass * gas.radius**2 * state.angular_velocity**2)[inside].sum()
            assert entry.density[k].value == pytest.approx(counts / len(frames) / (1.95 * 12))
            assert entry.temperature[k].value == pytest.approx(motion / counts)
            assert entry.spin[k].value == pytest.approx(spin / counts)
    assert json.dumps(result.as_dict(), allow_nan=False)


def test_the_gradient_is_the_slope_of_a_line_through_the_temperatures(make):
    log = make(*HOT_AND_COLD, EQUAL)
    result = profile(log, "y", bins=8, start=5.0)
    for entry in result.species:
        values = [[e.value for e in column] for column in (entry.temperature, entry.density)]
        weights = np.sqrt(values[1])  # polyfit squares them
        assert entry.gradient.value == pytest.approx(np.polyfit(result.middles, values[0], 1, w=weights)[0])
        assert entry.gradient.theory < 0
        assert entry.gradient.value < -3 * entry.gradient.standard_error
    for entry in profile(make(), "y", bins=8, start=10.0).species:
        assert entry.gradient.theory == pytest.approx(0.0, abs=1e-15)
        assert abs(entry.gradient.deviation) < 4
    assert profile(make(), "y", bins=1).species[0].gradient is None


def test_all_discs_are_in_a_uniform_gas(make):
    log = make()
    expected = expected_profile(log, 0, np.linspace(0.1, 11.9, 8), 0.0)
    assert expected.law == "uniform"
    assert (expected.density * 11.8 / 7 * 8).sum(axis=1) == pytest.approx([40, 20])
    assert expected.density[1, 0] < expected.density[1, 1]  # the heavy ones do not reach as far
    assert expected.temperature == pytest.approx(1.0)


def test_all_strips_together_tell_a_slope_that_no_strip_shows():
    """Discs that remember their strip for some frames: p is uniform without a slope, and small with one."""
    weight, draw, memory = np.linspace(2.0, 8.0, 10) * 6 / 5, np.random.default_rng(3), 0.6

    def test(slope):
        shares = weight / weight.sum() * (1 + slope * np.linspace(-1, 1, 10))
        number = 60 * shares / shares.sum()
        noise = draw.multinomial(60, number / 60, 300) - number
        noise[1:] *= np.sqrt(1 - memory**2)
        return strip_test(number + lfilter([1.0], [1.0, -memory], noise, axis=0), weight, np.zeros(10))

    right = np.array([test(0.0).p_value for _ in range(200)])
    assert kstest(right, "uniform").pvalue > 1e-3
    assert test(0.0).waves == 9
    assert np.median([test(0.15).p_value for _ in range(20)]) < 0.01
    assert strip_test(np.zeros((40, 10)), np.full(10, 0.1), np.zeros(10)) is None


def test_the_strips_of_a_right_gas_agree_together(make):
    result = profile(make("run.collisions_per_disc=900"), "y", bins=8, start=10.0)
    for entry in result.species:
        assert 1e-4 < entry.density_test.p_value <= 1
        assert 1e-4 < entry.temperature_test.p_value <= 1
    assert "In strips: all 36 agree with theory, uniform (" in result.summary()


def test_laws_of_dilute_gases_are_not_tested_in_all_strips_together(make):
    result = profile(make(*HOT_AND_COLD, EQUAL), "y", bins=8, start=10.0)
    assert result.law.startswith("T^(3/2)")
    assert all(entry.density_test is entry.temperature_test is None for entry in result.species)


def test_a_column_falls_off_with_height(make):
    """In a tall column a disc has T of height beside T of motion, so that T is half of the energy above the floor."""
    log = make("gravity={ acceleration = [0, -9] }")
    assert natural_axis(log) == 1
    discs = composition(log.discs)
    heights = log.discs.position[:, 1] - log.discs.radius
    energy = log.discs.kinetic_energy + 9 * (log.discs.mass * heights).sum()
    t = column_temperature(log, 1)
    x = discs.mass * 9 * (8 - 2 * discs.radius) / t
    assert energy == pytest.approx((discs.number * t * (2 - x / np.expm1(x))).sum(), rel=1e-9)
    expected = expected_profile(log, 1, np.linspace(1.0, 3.0, 3), 0.0)
    fall = expected.density[:, 1] / expected.density[:, 0]
    assert fall == pytest.approx(np.exp(-discs.mass * 9 / t), rel=1 / 60)  # to first order in 1/N
    assert expected_profile(log, 0, np.linspace(1.0, 3.0, 3), 0.0) is None


def test_a_conserved_momentum_leaves_spins_alone(make):
    """m v²/2 is T(1 - m/2M) where the total momentum along x is conserved, and I ω² is T."""
    log = make("box.left=periodic", "box.right=periodic", "rotation.roughness=1")
    expected, gas = expected_profile(log, 0, np.linspace(0, 12, 3), 0.0), log.discs
    t = expected.of_spin(0, 0).value
    energy = gas.kinetic_energy - gas.mass @ gas.velocity[:, 0] * centre_of_mass_velocity(log.scene, log.discs)[0] / 2
    assert t == pytest.approx(2 * energy / (3 * len(gas) - 1), rel=1e-9)
    for s, mass in enumerate(composition(gas).mass):
        assert expected.of_temperature(s, 1).value == pytest.approx(t * (1 - mass / gas.mass.sum() / 2), rel=1e-12)


def test_a_column_in_a_heat_bath(make):
    log = make("gravity={ acceleration = [0, -9] }", "thermostat={ temperature = 5, rate = 1 }")
    expected = expected_profile(log, 1, np.linspace(1.0, 3.0, 3), 0.0)
    fall = expected.density[:, 1] / expected.density[:, 0]
    assert fall == pytest.approx(np.exp(-composition(log.discs).mass * 9 / 5), rel=1e-12)
    assert expected.temperature == pytest.approx(5.0, rel=1e-12)


def test_all_commands_have_one_temperature_of_a_column(make):
    """2E/(2N) of light and heavy discs in a tall box, as each degree of freedom and each height has T/2 and T.

    Strips have the T of fixed energy, which falls by 1/N; its mean over the discs is T.
    """
    low = [f"species.{name}.{key}" for name in ("light", "heavy") for key in ("region=[0, 0, 12, 8]", "radius=0.02")]
    tall = ("box.size=[12, 400]", "run.until=5", "run.collisions_per_disc=")
    log = make("gravity={ acceleration = [0, -9] }", *tall, *low)
    gas = log.discs
    lowest = float(gas.mass @ (gas.position[:, 1] - gas.radius))
    t = (gas.kinetic_energy + 9 * lowest) / (2 * len(gas))
    result = temperature(log, start=0.0)
    assert evolution(log).law.temperature == pytest.approx(t, rel=1e-6)
    assert profile(log, start=0.0).law == f"barometric at fixed energy, T = {t:.6g} on average over the discs"
    assert result.law == f"T = {t:.6g} (of a dilute column at fixed energy)"
    for entry in result.species:
        for estimate in (entry.x, entry.y, entry.both):
            assert estimate.theory == pytest.approx(t, rel=1e-6)
            assert 0 < estimate.theory_error < 0.02 * t
    strips = expected_profile(log, 1, np.linspace(0.02, 399.98, 4001), 0.0)
    weight = strips.density / strips.density.sum(axis=1, keepdims=True)
    for mean in (weight * strips.temperature).sum(axis=1):
        assert mean == pytest.approx(t, rel=2e-3)


def test_sheared_sides_have_one_heat(make):
    """How their energy is divided between them is a convention; the sum is the work of the shear."""
    log = make(*PERIODIC[:2], "box.bottom={ shear = 0.3 }", "box.top={ shear = 0.3 }")
    result = profile(log, bins=3, start=0.0)
    time, given = log.observables["wall_energy"]
    assert result.heat.keys() == {"bottom and top"}
    assert result.heat["bottom and top"].value == pytest.approx((given[-1] - given[0])[2:].sum() / (time[-1] - time[0]))


def test_between_two_thermal_sides(make):
    assert expected_profile(make(*HOT_AND_COLD), 1, np.linspace(0, 8, 42), 0.0) is None  # light and heavy drift apart
    log = make(*HOT_AND_COLD, EQUAL)
    assert natural_axis(log) == 1
    expected = expected_profile(log, 1, np.linspace(0, 8, 42), 0.0)
    t, n = expected.temperature[0, 1:-1], expected.density[0, 1:-1]  # in the outermost the discs do not reach all
    jumps = conduct(4.0, 1.0, 8.0, 300 / 96, 0.2)
    low, high = jumps.low**1.5, jumps.high**1.5
    assert t[[0, 19, -1]] ** 1.5 == pytest.approx(low + (high - low) * np.array([1.5, 20.5, 39.5]) / 41, rel=2e-3)
    pressure = n * t * compressibility_factor(n * np.pi * 0.1**2)
    assert pressure == pytest.approx(pressure[0], rel=2e-5)  # means over strips; their curvature is 1e-5
    result = profile(log, bins=3, start=0.0)
    assert set(result.heat) == {"bottom", "top"}
    time, given = log.observables["wall_energy"]
    gain = (given[-1] - given[0]) / (time[-1] - time[0])
    assert [result.heat[name].value for name in ("bottom", "top")] == pytest.approx(gain[2:])
    flow = result.heat_flow
    assert flow.value == pytest.approx((gain[2] - gain[3]) / 2)
    dilute = 1.029 * 2 / 0.2 / np.sqrt(np.pi)  # λ₀/√T
    fall = 12 * 2 / 3 * (low - high) / 8
    assert 1.0 < flow.theory / (dilute * fall) < 1.3  # Enskog's factor at φ = 0.098
    assert 0.02 < flow.theory_error / flow.theory < 0.2
    assert "Heat flows along y at a rate of " in result.summary()
    assert profile(log, bins=3, start=0.0, along="x").heat_flow is None


def test_a_dense_gas_between_two_thermal_sides_has_one_pressure(make):
    """At φ = 0.28 n T Z is the same everywhere (series of Clisby & McCoy 2006), within 4 s.e. and theory's error.

    n T alone is not: densities that are inverse to the temperature miss three of six strips by more than that.
    """
    dense = "species=[{ name = 'gas', count = 300, radius = 0.17, temperature = 2 }]"
    log = make(*HOT_AND_COLD, dense, "run.collisions_per_disc=900")
    gas = profile(log, bins=8).species[0]
    inner = gas.density[1:-1]  # layers at the sides are in the error of the outermost
    theory, cold = (
        np.array([each.theory for each in inner]),
        1 / np.array([each.theory for each in gas.temperature[1:-1]]),
    )
    allowed = np.array([math.hypot(4 * each.standard_error, each.theory_error) for each in inner])
    off = [
        np.abs(np.array([each.value for each in inner]) - law) for law in (theory, cold * theory.mean() / cold.mean())
    ]
    assert (off[0] < allowed).all()
    assert np.count_nonzero(off[1] > allowed) >= 3


def test_layers_at_the_cold_side_are_larger(make):
    """Theory's error at each side has (1 - 1/Z) R/width with the Z that the gas has there."""
    log = make(*HOT_AND_COLD, EQUAL)
    expected = expected_profile(log, 1, np.linspace(0.1, 7.9, 11), 0.0)
    z = compressibility_factor(expected.density[0, [0, -1]] * np.pi * 0.1**2)
    assert expected.layers == pytest.approx((1 - 1 / z) * 0.1 / 0.78, rel=1e-12)
    assert expected.layers[1] > 1.5 * expected.layers[0] > 0


@pytest.mark.parametrize(
    ("override", "law"),
    [
        ("piston=[{ position = 12, mass = 5, pressure = 2 }]", None),
        ("wall=[{ from = [6, 0], to = [6, 1] }]", None),
        ("wall=[{ from = [6, 0], to = [6, 1], opens_at = 3 }]", None),
        ("wall=[{ from = [6, 0], to = [6, 1], opens_at = 1 }]", "uniform"),  # a gate that has opened is no wall
        ("rotation.roughness=0", None),
    ],
)
def test_scenes_without_a_theory_are_measured_too(make, override, law):
    result = profile(make(override), start=2.0)
    assert result.law == law
    assert all((e.theory is None) == (law is None) for e in result.species[0].density)


def test_samples_of_one_instant_have_no_heat(make, monkeypatch):
    """A run that was interrupted has its last sample twice: no time, no heat, and no warning of numpy."""
    log = make("box.left={ thermal = 1 }")
    twice = {
        name: (np.append(times, times[-1]), np.concatenate((values, values[-1:])))
        for name, (times, values) in log.observables.items()
    }
    monkeypatch.setitem(vars(log), "observables", twice)
    last = float(log.observables["wall_energy"][0][-1])
    assert profile(log, start=last * 0.999).heat == {}


def test_a_small_jump_is_the_gradient_times_so_many_mean_free_paths():
    """The other way round it is the same."""
    result = conduct(1.0, 1.01, 1000.0, 1.0, 1.0)
    jump = JUMP * mean_free_path(1.0, 1.0, 0.0) * 0.01 / 1000
    assert (result.low - 1.0, 1.01 - result.high) == pytest.approx((jump, jump), rel=0.01)
    there, back = conduct(1.0, 2.0, 20.0, 1.0, 0.1), conduct(2.0, 1.0, 20.0, 1.0, 0.1)
    assert (there.low, there.high, there.error) == pytest.approx((back.high, back.low, back.error))


def test_a_narrow_box_has_no_jumps():
    path = mean_free_path(0.1, 1.0, 0.0)
    for low, high in ((1.0, 2.0), (1.0, 100.0), (100.0, 1.0), (1.0, 1.0001)):
        assert conduct(low, high, 0.5 * path, 1.0, 0.1) is None
        wide = conduct(low, high, 100 * path, 1.0, 0.1)
        assert min(low, high) < min(wide.low, wide.high) < max(wide.low, wide.high) < max(low, high)


def test_layers_at_walls_are_part_of_the_error(make):
    """At φ = 0.4 strips at walls are denser by about a tenth (six errors), and theory has an error of that size."""
    log = make("species=[{ name = 'gas', count = 136, radius = 0.3, temperature = 1 }]", "run.collisions_per_disc=400")
    density = profile(log, "x", bins=10).species[0].density
    assert all(each.value > 1.05 * each.theory for each in (density[0], density[-1]))
    assert all(abs(each.deviation) < 4 for each in density)


COLUMN = gas(
    4, 0.05, (2, 12), "until = 20_000", region=[0, 0, 2, 2], seed=1,
    then="gravity.acceleration = [0, -1]\nlog.compression = 'none'",
)  # fmt: skip


@pytest.mark.parametrize("sides", [(), PERIODIC[:2]], ids=["walls", "periodic"])
def test_a_column_of_four_discs(sides):
    """At fixed energy they are colder the higher one of them is: eight strips within four standard errors of theory.

    It falls by more than a third among them.
    """
    result = profile(log_of(COLUMN, *sides), bins=8)
    (gas,) = result.species
    assert result.law.startswith("barometric at fixed energy")
    warm = [warmth for warmth in gas.temperature if warmth.standard_error < 0.1 * warmth.value]
    assert warm[-1].theory < 0.65 * warm[0].theory
    for estimate in (*gas.density[: len(warm)], *warm):
        assert abs(estimate.deviation) < 4, estimate


def test_there_is_no_theory_of_many_kinds():
    """The time of that of fixed energy grows as their square: 16 kinds have one, 17 have none."""
    kinds = "".join(f', {{ name = "k{k}", count = 1, radius = 0.0{k}, temperature = 1 }}' for k in range(10, 26))
    more = kinds + ', { name = "x", count = 1, radius = 0.026, temperature = 1 }'
    known, unknown = (profile(log_of(COLUMN, "run.until=300", f"species=[{s[2:]}]"), bins=2).law for s in (kinds, more))
    assert known.startswith("barometric at fixed energy")
    assert unknown is None

import math
import tracemalloc

import numpy as np
import pytest
from scipy import integrate

from idealgas.theory import enskog, hard_discs


def test_virial_series_has_the_published_coefficients():
    published = [1, 2, 3.1280, 4.2579, 5.3369]  # of powers of φ
    coefficients = [b * 2**k for k, b in enumerate(hard_discs.VIRIAL)]
    assert coefficients[:5] == pytest.approx(published, abs=5e-5)
    assert hard_discs.virial_series(0.1) == pytest.approx(sum(c * 0.1**k for k, c in enumerate(coefficients)))
    assert hard_discs.virial_series(0.0) == 1.0
    for phi in (0.01, 0.1, 0.2):  # resummed, they differ from the eleventh coefficient on, which is below 12 φ¹⁰
        series, resummed = hard_discs.virial_series(phi), hard_discs.compressibility_factor(phi)
        assert resummed == pytest.approx(series, abs=24 * phi**10 + 1e-15)


def test_henderson_is_close_below_a_half():
    phi = np.linspace(0.01, 0.5, 50)
    henderson = hard_discs.henderson_compressibility_factor(phi)
    assert np.abs(henderson / hard_discs.compressibility_factor(phi) - 1).max() < 0.005
    assert henderson == pytest.approx(1 + 2 * phi * hard_discs.contact_value(phi), rel=1e-14)


def test_closed_system_has_fewer_pairs():
    z = hard_discs.compressibility_factor
    assert (z(1e-4, 50) - 1) / (z(1e-4) - 1) == pytest.approx(1 - 1 / 50, abs=1e-4)
    # Z_N - Z = (φ/2N) d ln κ/dφ with 1/κ = d(φZ)/dφ, by finite differences
    phi, h = 0.3, 1e-4
    stiff = [math.log(((x + h) * z(x + h) - (x - h) * z(x - h)) / (2 * h)) for x in (phi - h, phi + h)]
    assert z(phi, 40) - z(phi) == pytest.approx(phi / 80 * (stiff[0] - stiff[1]) / (2 * h), rel=1e-4)


def test_the_long_time_tail():
    """1/(8π n (D + ν) t), for n = ½, D = 3 and ν = 1: 1/(16π t)."""
    tail = hard_discs.long_time_tail([1.0, 4.0], 0.5, 3.0, 1.0)
    assert tail == pytest.approx([1 / (16 * math.pi), 1 / (64 * math.pi)], rel=1e-14)


def test_mixture_of_equals_is_one_species():
    result = hard_discs.mixture_compressibility_factor([0.5], [300], 1000.0)
    two = hard_discs.mixture_compressibility_factor([0.5, 0.5], [100, 200], 1000.0)
    assert two == pytest.approx(result, rel=1e-14)
    assert result == pytest.approx(hard_discs.compressibility_factor(300 * math.pi * 0.25 / 1000), rel=1e-14)
    rates = hard_discs.mixture_collision_rate([0.5, 0.5], [2.0, 2.0], [100, 200], 1000.0, 1.5)
    alone = hard_discs.collision_rate(1.0, 0.3, 1.5, 2.0, 300 * math.pi * 0.25 / 1000)
    assert rates.sum(axis=1) == pytest.approx([alone, alone], rel=1e-14)
    unlike = hard_discs.mixture_collision_rate([0.5, 1.0], [1.0, 4.0], np.array([80, 20]), 1000.0, 1.0)
    assert 80 * unlike[0, 1] == pytest.approx(20 * unlike[1, 0], rel=1e-14)  # meetings are mutual


def test_mixtures_have_the_exact_second_virial_coefficient_and_one_equation_of_state():
    """B₂ = (π/4)(⟨σ²⟩ + ⟨σ⟩²); Z of the contact values is that of `mixture_compressibility_factor`."""
    radius, number = np.array([0.5, 1.0, 3.0]), np.array([50, 30, 20])
    square, mean = 4 * (number @ radius**2) / 100, 2 * (number @ radius) / 100
    second = math.pi / 4 * (square + mean**2)
    thin = [hard_discs.mixture_compressibility_factor(radius, number, area) - 1 for area in (1e8, 2e8)]
    assert (4 * thin[1] - thin[0]) * 1e8 / 100 == pytest.approx(second, rel=1e-5)
    chi = hard_discs.mixture_contact_value(radius, number, 900.0, hard_discs.fluid_contact_value)
    sigma = radius[:, None] + radius
    z = 1 + math.pi / 2 * (number[:, None] * number * sigma**2 * chi).sum() / (100 * 900)
    assert z == pytest.approx(hard_discs.mixture_compressibility_factor(radius, number, 900.0), rel=1e-13)
    assert np.diff(hard_discs.box_contacts([0.5, 0.5], [100, 200], (30.0, 30.0), (True, True)).sum(axis=1)) == 0


def test_nearly_equal_discs_are_those_of_one_species():
    """The limit of equal discs, of finite gases too: `box_contacts` and Z as of one radius."""
    box, number = (30.0, 30.0), np.full(32, 10)
    for periodic in ((True, True), (False, False)):
        alone = hard_discs.box_compressibility_factor([0.5], [320], box, periodic)
        spread = hard_discs.box_compressibility_factor(np.linspace(0.5, 0.5 + 1e-9, 32), number, box, periodic)
        assert spread == pytest.approx(alone, rel=1e-8)


def test_mean_free_path_is_mean_speed_over_rate():
    phi, diameter = 0.2, 0.6
    density = phi / (math.pi * diameter**2 / 4)
    path = hard_discs.mean_speed(1.7, 2.3) / hard_discs.collision_rate(diameter, density, 1.7, 2.3, phi)
    assert hard_discs.mean_free_path(diameter, density, phi) == pytest.approx(path, rel=1e-14)


def test_mean_speeds_by_quadrature():
    weight = 2.3 / 1.7
    mean = integrate.quad(lambda v: v * weight * v * math.exp(-weight * v**2 / 2), 0, np.inf)[0]
    assert hard_discs.mean_speed(1.7, 2.3) == pytest.approx(mean, rel=1e-9)
    flux = integrate.quad(lambda v: v * math.exp(-weight * v**2 / 2) * math.sqrt(weight / (2 * math.pi)), 0, np.inf)[0]
    assert hard_discs.effusion_flux(0.4, 1.7, 2.3) == pytest.approx(0.4 * flux, rel=1e-9)


@pytest.mark.parametrize("dof", [4, 10, 2000])
def test_speed_factor_at_fixed_energy(dof):
    # mean length of a two-dimensional projection of the unit sphere: its square is Beta(1, D/2 - 1)
    mean = integrate.quad(lambda s: math.sqrt(s) * (dof / 2 - 1) * (1 - s) ** (dof / 2 - 2), 0, 1)[0]
    expected = mean * math.sqrt(dof / math.pi * 2)
    assert hard_discs.finite_speed_factor(dof) == pytest.approx(expected, rel=1e-7)
    assert hard_discs.finite_speed_factor(dof) == pytest.approx(1 + 1 / (4 * dof), abs=1 / dof**2)


@pytest.mark.parametrize("box", [(5.0, 3.0), (2.1, 2.4), (2.0, 30.0)], ids=str)
@pytest.mark.parametrize("periodic", [(False, False), (True, False), (True, True)], ids=str)
@pytest.mark.parametrize("axis", [None, 0, 1])
def test_confinement_is_a_mean_over_the_contact_circle(box, periodic, axis):
    """The closed form against the sum over a million angles, also where the box is hardly wider than two discs.

    The sum misses up to h² s/16π at a kink where the slope changes by s: 7e-11 for h = 2π/10⁶ and s of 90.
    """
    radius, angle = np.array([0.1, 0.3, 0.9]), (np.arange(10**6) + 0.5) * 2e-6 * math.pi
    result = hard_discs.confinement(radius, box, periodic, axis)
    for i, j in np.ndindex(3, 3):
        share = np.ones_like(angle) if axis is None else 2 * (np.cos(angle), np.sin(angle))[axis] ** 2
        for side, wraps, along in zip(box, periodic, (np.cos(angle), np.sin(angle)), strict=True):
            a, b = side - 2 * radius[i], side - 2 * radius[j]
            inside = np.clip((a + b) / 2 - (radius[i] + radius[j]) * np.abs(along), 0, min(a, b))
            share = share if wraps else share * inside * side / (a * b)
        assert result[i, j] == pytest.approx(share.mean(), rel=1e-9, abs=7e-11)


def test_confinement_of_a_thousand_species_takes_little_memory():
    """A few arrays of 8 MB, a million pairs each; a sum over angles would take 30 GB."""
    tracemalloc.start()
    result = hard_discs.confinement(np.linspace(0.3, 0.6, 1000), (100.0, 100.0))
    assert tracemalloc.get_traced_memory()[1] < 400_000_000
    tracemalloc.stop()
    assert result[0, 999] == pytest.approx(hard_discs.confinement([0.3, 0.6], (100.0, 100.0))[0, 1], rel=1e-15)


def test_second_virial_coefficient_of_a_small_box():
    # N = 2 without approximation: PA'/NT = 1 + (π σ²/2A' - σ³(a + b)/A'² + σ⁴/2A'²)/2 to first order in 1/A',
    # from Q = A'² - π σ² A' + (4/3) σ³(a + b) - σ⁴/2; the walls' virial is homogeneous in a, b at fixed σ
    radius, box = 0.001, (1.0, 2.0)
    a, b, sigma = box[0] - 2 * radius, box[1] - 2 * radius, 2 * radius
    area = a * b
    excess = (math.pi * sigma**2 / area - 2 * sigma**3 * (a + b) / area**2 + sigma**4 / area**2) / 2
    assert hard_discs.box_compressibility_factor([radius], [2], box) - 1 == pytest.approx(excess, rel=1e-4)


def test_no_theory_beyond_its_range():
    for width, known in ((12.6, True), (12.5, False), (11.0, False)):
        assert math.isfinite(hard_discs.box_compressibility_factor([0.5], [99], (10.0, width))) == known


@pytest.mark.parametrize("phi", [0.0001, 0.1, 0.5])
def test_enskogs_coefficients_have_their_parts(phi):
    """Flights: (1 + yχ/2)²/χ and (1 + 3yχ/4)²/χ times the dilute one; collisions: ζ/2 and ζ/m. Gass has 4 digits."""
    sigma, temperature, mass, chi = 0.7, 1.3, 2.0, 1 / (1 - phi) ** 2
    state = (sigma, 4 * phi / (math.pi * sigma**2), temperature, mass, chi)
    y, unit = 2 * phi, math.sqrt(mass * temperature / math.pi) / sigma
    bulk = enskog.bulk_viscosity(*state)
    assert bulk == pytest.approx(2 / math.pi * chi * y**2 * unit)
    viscosity = 1.022 / 2 * unit / chi * (1 + y * chi / 2) ** 2 + bulk / 2
    assert enskog.viscosity(*state) == pytest.approx(viscosity, rel=1e-4)
    conductivity = 2 * 1.029 * unit / mass / chi * (1 + 3 / 4 * y * chi) ** 2 + bulk / mass
    assert enskog.conductivity(*state) == pytest.approx(conductivity, rel=1e-4)


def test_pairs_in_a_thin_gas():
    """At contact the second virial coefficient's derivative: χ = 1 + φ b, b = (B₃/B₂² of discs) · 2 = 1.5640."""
    density, diameter = 0.03, 0.7
    phi = density * math.pi * diameter**2 / 4
    at_contact, far = hard_discs.thin_pair_distribution(np.array([diameter, 2 * diameter]), diameter, density)
    assert at_contact == pytest.approx(1 + 1.5640 * phi, rel=1e-4 * phi)
    assert far == 1
    assert at_contact == pytest.approx(float(hard_discs.fluid_contact_value(phi)), abs=3 * phi**2)

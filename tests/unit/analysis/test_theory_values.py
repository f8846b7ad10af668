"""Theory with its own error: exact forms, ranges, and what the routes have in common."""

import itertools
import math

import numpy as np
import pytest

from idealgas.theory import hard_discs
from idealgas.theory.two_discs import two_discs
from idealgas.theory.values import BoxTheory, NoTheoryError, Theory, box_theory, crystal, fluid


@pytest.mark.parametrize("box", [(1.0, 1.0), (1.0, 1.7)])
@pytest.mark.parametrize("radius", [0.001, 0.1, 0.22, 0.25])
def test_two_discs_between_walls_in_closed_form(radius, box):
    """lnQ = ln(a²b² - πσ²ab + (4/3)σ³(a + b) - σ⁴/2), its slopes and Z by hand; σ ≤ min(a, b)."""
    a, b, sigma = box[0] - 2 * radius, box[1] - 2 * radius, 2 * radius
    q = a**2 * b**2 - math.pi * sigma**2 * a * b + 4 / 3 * sigma**3 * (a + b) - sigma**4 / 2
    along = (2 * a * b**2 - math.pi * sigma**2 * b + 4 / 3 * sigma**3) / q
    across = (2 * a**2 * b - math.pi * sigma**2 * a + 4 / 3 * sigma**3) / q
    result = two_discs((radius, radius), box)
    assert result.sides == pytest.approx((box[0] * along / 2, box[1] * across / 2), rel=1e-12)
    assert result.walls == pytest.approx((a * along + b * across) / 4, rel=1e-12)
    assert result.pairs == pytest.approx(result.walls, rel=1e-12)


@pytest.mark.parametrize("radius", [0.01, 0.1, 0.25])
def test_two_discs_in_a_periodic_box_in_closed_form(radius):
    """Q = A(A - πσ²), σ ≤ L/2: Z = 1 + ½πσ²/(A - πσ²)."""
    excluded = math.pi * (2 * radius) ** 2
    result = two_discs((radius, radius), (1.0, 1.3), (True, True))
    assert result.pairs == pytest.approx(1 + excluded / 2 / (1.3 - excluded), rel=1e-12)
    assert result.walls is None
    assert result.sides == (None, None)


@pytest.mark.parametrize("periodic", [(False, False), (True, False), (True, True)])
@pytest.mark.parametrize("radius", [(0.26, 0.26), (0.3, 0.1), (0.05, 0.2)])
def test_two_discs_by_counting(radius, periodic):
    """Z - 1 = -σ ∂lnQ/∂σ/4 from the number of pairs of places at random that are just far enough apart."""
    random, box = np.random.default_rng(1), np.array([1.0, 1.2])
    low = np.where(periodic, 0.0, np.array(radius)[:, None])
    places = low[:, None] + random.random((2, 4_000_000, 2)) * (box - 2 * low)[:, None]
    between = np.abs(places[0] - places[1])
    between = np.where(periodic, np.minimum(between, box - between), between)
    distance, sigma = np.hypot(*between.T), sum(radius)
    far, near = (distance > sigma * 0.99).sum(), (distance > sigma * 1.01).sum()
    slope = (far - near) / 0.02 / (distance > sigma).sum()
    result = two_discs(radius, (1.0, 1.2), periodic)
    assert result.pairs - 1 == pytest.approx(slope / 4, rel=0.02)  # 4 s.e., and the width of the shell


def test_two_unlike_discs_share_the_pressure_of_all_walls():
    """Clausius: both virials are one; unlike discs reach unlike lengths, so only forces tell of single walls."""
    narrow, result, wide = (two_discs((0.3, 0.1), (1.0 + step, 1.3)) for step in (-1e-5, 0.0, 1e-5))
    assert result.walls == pytest.approx(result.pairs, rel=1e-12)
    assert result.sides[0] > result.pairs
    assert narrow.sides[0] > result.sides[0] > wide.sides[0]


def test_two_discs_that_do_not_fit():
    assert two_discs((0.4, 0.4), (1.0, 1.0)) is None
    assert two_discs((0.4, 0.4), (1.0, 1.0), (True, True)) is None
    assert box_theory([0.4], [2], (1.0, 1.0)).pairs is None


def test_few_collisions_of_two_discs_are_those_of_the_dilute_gas():
    """Both roads to Z of two small discs meet: exact, and first order in density and walls."""
    exact = box_theory([0.005], [2], (1.0, 1.0))
    first = hard_discs.box_compressibility_factor([0.005], [2], (1.0, 1.0))
    assert exact.pairs.value - 1 == pytest.approx(first - 1, rel=1e-3)
    assert exact.contacts == pytest.approx(hard_discs.box_contacts([0.005], [2], (1.0, 1.0)), rel=1e-3)
    assert exact.pairs.error == 0


def test_errors_of_theory_are_those_of_what_follows_from_it():
    assert Theory(2.0, 0.1, "x").times(-3.0) == Theory(-6.0, pytest.approx(0.3), "x")
    assert Theory(2.0, 0.1, "x").inverse() == Theory(0.5, pytest.approx(0.025), "x")  # e/x²


def test_pressures_along_both_axes_have_the_mean_of_the_pairs():
    """In a channel the axis across it has that of the walls; a box with four walls those of its sides, on the gas."""
    nothing = np.zeros((1, 1))
    pairs, walls = Theory(1.5, 0.01, "p"), Theory(1.2, 0.02, "w")
    channel = BoxTheory(pairs, walls, (None, None), nothing, nothing)
    other = Theory(pytest.approx(1.8), pytest.approx(0.04), "p")
    radius = np.array([0.5])
    assert channel.along_axes(radius, (4.0, 8.0), (True, False)) == (other, walls)
    assert channel.along_axes(radius, (4.0, 8.0), (False, True)) == (walls, other)
    assert channel.along_axes(radius, (4.0, 4.0), (True, True)) == (pairs, pairs)
    sides = channel._replace(sides=(Theory(2.0, 0.4, "x"), Theory(4.0, 0.8, "y")))
    x, y = sides.along_axes(radius, (4.0, 8.0), (False, False))
    assert (x, y) == (Theory(1.5, pytest.approx(0.3), "x"), Theory(3.5, pytest.approx(0.7), "y"))  # 3/4 and 7/8 of it
    assert channel.along_axes(radius, (4.0, 8.0), (False, False)) == (None, None)


def test_theory_of_a_crystal():
    """Free volume, too low by 0.4 + 0.8 (φcp/φ - 1)."""
    close = math.pi / math.sqrt(12)
    result = crystal(0.8)
    assert result.value == pytest.approx(1 / (1 - math.sqrt(0.8 / close)), rel=1e-14)
    assert result.error == pytest.approx(0.4 + 0.8 * (close / 0.8 - 1), rel=1e-14)


def test_names_of_species_change_nothing():
    """Equal discs given as two species: the same Z, and all their collisions together."""
    result = box_theory([0.02], [100], (1.0, 1.0))
    two = box_theory([0.02, 0.02], [30, 70], (1.0, 1.0))
    assert two.pairs.value == pytest.approx(result.pairs.value, rel=1e-12)
    assert two.contacts == pytest.approx(np.array([[29, 70], [30, 69]]) / 99 * result.contacts, rel=1e-12)  # not itself
    pair = box_theory([0.2, 0.2], [1, 1], (1.0, 1.0))
    assert pair.contacts == pytest.approx(np.array([[0, 1], [1, 0]]) * box_theory([0.2], [2], (1.0, 1.0)).contacts)


@pytest.mark.parametrize("periodic", [(False, False), (True, True)])
def test_rates_and_pressure_are_one_theory(periodic):
    """Z = 1 + (π/4N) Σ N_i σ_ij (contacts)_ij."""
    for radius, number in (([0.02], [100]), ([0.02, 0.04], [60, 40]), ([0.2, 0.1], [1, 1])):
        theory = box_theory(radius, number, (1.0, 1.0), periodic)
        sigma = np.add.outer(radius, radius)
        z = 1 + math.pi / 4 * (np.array(number)[:, None] * sigma * theory.contacts).sum() / sum(number)
        assert z == pytest.approx(theory.pairs.value, rel=1e-12)


def test_errors_grow_with_density_and_with_fewer_discs():
    def error(n, phi):
        theory = _periodic(n, phi).pairs
        return theory.error / (theory.value - 1) if theory else math.inf

    grid = [[error(n, phi) for phi in (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.62)] for n in (3, 5, 10, 30, 100, 1000)]
    assert (np.diff(np.array(grid[3:]), axis=1) >= 0).all()
    for fewer, more in itertools.pairwise(grid):
        assert all(a >= b for a, b in zip(fewer, more, strict=True))
    assert max(grid[-1]) < 0.0025  # so that an error of 2 % of Z - 1 is found


def _periodic(number, phi, box=(1.0, 1.0)):
    return box_theory([math.sqrt(phi * box[0] * box[1] / number / math.pi)], [number], box, (True, True))


def test_no_value_beyond_the_range():
    for theory, phi, why in ((crystal, 0.71, None), (crystal, 0.91, None), (fluid, 0.63, r"above 0\.62")):
        with pytest.raises(NoTheoryError, match=why):
            theory(phi)
    for number, phi, box, why in (
        (400, 0.63, (1.0, 1.0), "above 0.62"),
        (50, 0.61, (1.0, 1.0), "too high for so few"),
        (4, 0.45, (1.0, 1.0), "off by"),
        (1, 0.1, (1.0, 1.0), "holds fewer than 3"),
        (40, 0.3, (40.0, 1.0), "holds fewer than 3"),
    ):
        assert why in _periodic(number, phi, box).reason
    assert np.isnan(_periodic(400, 0.63).contacts).all()
    assert _periodic(400, 0.61).reason == ""


@pytest.mark.parametrize(("phi", "pressure"), [(0.67, 7.98678), (0.68, 8.51325), (0.69, 8.9699), (0.7, 9.1297)])
def test_published_simulations(phi, pressure):
    theory = _periodic(870, phi)
    assert theory.pairs.value == pytest.approx(pressure * math.pi / (4 * phi), rel=1e-12)
    assert theory.pairs.error < 3e-4 * theory.pairs.value
    assert "Li et al. 2022" in theory.pairs.source
    assert _periodic(869, phi).pairs is None
    assert _periodic(870, phi, (1.0, 1.1)).pairs is None
    assert _periodic(870, phi + 0.005).pairs is None
    assert box_theory([math.sqrt(phi / 870 / math.pi)], [870], (1.0, 1.0)).pairs is None


def test_walls_tell_of_one_axis_in_a_channel():
    """Periodic along x: the virials of walls and of pairs differ, and one wall has the walls' own Z at its distance."""
    theory = box_theory([0.03], [50], (1.0, 1.0), (True, False))
    assert theory.walls.value < theory.pairs.value
    assert theory.sides[0] is None
    assert theory.sides[1].value == pytest.approx(theory.walls.value / (1 - 0.06), rel=1e-12)

"""Temperatures of every direction and species, of discs whose energies are known, and equipartition between them."""

import pytest
from helpers.logs import log_of

from idealgas.analysis.temperature import temperature

pytestmark = pytest.mark.interpreted


def values(entry):
    return [each.value for each in (entry.x, entry.y, entry.both)]


def test_energies_of_two_discs(lanes):
    """m vx², m vy² and m v²/2 of 2 at (1, ½), of 1 at (2, 1), and of both; T = 2E/D = 2 · 3.75/4."""
    result = temperature(lanes, start=20.0, end=140.0)
    assert [(entry.species, entry.number) for entry in result.species] == [("a", 1), ("b", 1), ("all discs", 2)]
    for entry, expected in zip(result.species, ([2, 0.5, 1.25], [4, 1, 2.5], [3, 0.75, 1.875]), strict=True):
        assert values(entry) == pytest.approx(expected, rel=1e-14)
        assert [each.theory for each in (entry.x, entry.y, entry.both)] == pytest.approx([1.875] * 3, rel=1e-14)
        assert entry.history == pytest.approx([expected[2]] * len(entry.history), rel=1e-12)
    assert (result.window.start, result.window.end, result.window.detected) == (20.0, 140.0, False)
    assert result.law == "T = 1.875 (2E/D with D = 4)"
    assert result.expected == pytest.approx(1.875, rel=1e-14)


@pytest.mark.usefixtures("uncompiled")
def test_a_species_has_the_mean_of_its_discs():
    """Two discs of one species and one of another in three lanes: 1 and 4 along x, and 9."""
    rows = (("a", 2, 1), ("a", 6, 2), ("b", 10, 3))
    discs = ", ".join(
        f'{{ position = [5, {y}], velocity = [{v}, 0], radius = 0.5, species = "{name}" }}' for name, y, v in rows
    )
    walls = "wall = [{ from = [0, 4], to = [10, 4] }, { from = [0, 8], to = [10, 8] }]"
    log = log_of(f"box.size = [10, 12]\nrun.until = 100\n{walls}\ndisc = [{discs}]\n")
    result = temperature(log, start=0.0)
    assert [entry.number for entry in result.species] == [2, 1, 3]
    for entry, along in zip(result.species, (2.5, 9.0, 14 / 3), strict=True):
        assert values(entry) == pytest.approx([along, 0.0, along / 2], rel=1e-12)


@pytest.mark.usefixtures("uncompiled")
def test_a_conserved_momentum_takes_its_part():
    """Along x the centre of mass, with 1/3, keeps E_x = 3/2 · 1/9: T = 2 (3 - 1/6)/3, and along x T (1 - m/M).

    Masses 1 and 2 at (-1, 1) and (1, 1) turn round at the upper and lower side and do not meet.
    """
    text = """
        box = { size = [10, 8], left = "periodic", right = "periodic" }
        run.until = 60
        disc = [
            { position = [2, 4], velocity = [-1, 1], radius = 0.5, species = "light" },
            { position = [2, 2.5], velocity = [1, 1], radius = 0.5, mass = 2, species = "heavy" },
        ]
    """
    log = log_of(text)
    result = temperature(log, start=0.0, end=4.0)
    t = 2 * (3 - 1 / 6) / 3
    light, heavy, _ = result.species
    assert result.law == f"T = {t:.6g} (2E/D with D = 3), T(1 - m/M) along x"
    assert (light.x.theory, heavy.x.theory) == pytest.approx((t * 2 / 3, t / 3), rel=1e-12)
    assert (light.y.theory, heavy.y.theory) == pytest.approx((t, t), rel=1e-12)

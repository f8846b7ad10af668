"""Gases of many species: memory grows with the number of species, not with its square."""

import shutil

import numpy as np
import pytest
from helpers.log_fuzz.commands import NAME, forms, reading_commands
from helpers.logs import log_of, species
from helpers.support import code_errors_and_memory

from idealgas.state import Gas
from idealgas.tallies.equilibrium import equipartition_violation, known_ensemble
from idealgas.tallies.impacts import Impacts


@pytest.mark.parametrize(("number", "groups"), [(32, 32), (33, 1), (1000, 1)])
def test_many_species_are_counted_with_all_discs(number, groups):
    ones, at_rest = np.ones(number), np.zeros((number, 2))
    names = tuple(f"s{k}" for k in range(number))
    gas = Gas((99.0, 99.0), at_rest, at_rest, ones, ones, np.arange(number, dtype=np.uint16), names)
    tally = Impacts()
    tally.begin(gas, np.linspace(0.0, 1.0, 513))
    assert tally.collisions.shape == (512, number, groups)
    assert gas.partners == (names if groups > 1 else ("all",))


@pytest.fixture(scope="module")
def log():
    """A thousand species of two discs each, and five events."""
    kinds = (species(f"s{k}", 2, 0.3 + 3e-4 * k, mass=1 + 1e-3 * k) for k in range(1000))
    return log_of("[box]\nsize = [100, 100]\n[run]\nevents = 5\n" + "".join(kinds))


def test_bounds_of_temperatures_contain_the_number_of_species(log):
    """Temperatures at an instant, those of two discs exponential: of 2000, 5 % are above 3 T, and none is far off."""
    of_axes = np.random.default_rng(1).exponential(known_ensemble(log).of_axes * 2)
    energies = np.broadcast_to(of_axes, (64, 1000, 2))
    assert np.count_nonzero(of_axes > 6) > 60
    assert equipartition_violation(log, energies) == ""
    hot = energies.copy()
    hot[:, 700, 1] = 2 * 15.0
    assert equipartition_violation(log, hot) == "m vy² of s700 is 15 on average, and 1 in equilibrium"


@pytest.mark.slow
@pytest.mark.parametrize("name", reading_commands())
def test_a_command_takes_less_than_a_gigabyte(log, name, tmp_path):
    """Of collisions of each pair of 1 000 species, in blocks of time, there would be 4 GB and more."""
    shutil.copyfile(log.path, tmp_path / NAME)
    for form in forms(name):
        code, errors, memory = code_errors_and_memory(*form, cwd=tmp_path)
        assert code in (0, 2), errors
        assert "Traceback" not in errors
        assert memory < 1e9, form

"""The energy account: parts, gifts and losses in numbers by hand."""

import numpy as np
import pytest
from helpers.support import gas_of

from idealgas.effects.bundle import Effects
from idealgas.physics.exact_sum import add_term, make_sums
from idealgas.physics.piston import PISTON
from idealgas.run.energy import Energy, energy_of

pytestmark = [pytest.mark.interpreted, pytest.mark.filterwarnings("ignore:overflow encountered")]


def sums(*terms):
    made = make_sums([1.0] * len(terms))
    for k, term in enumerate(terms):
        add_term(made[k : k + 1], term)
    return made


def test_the_balance_is_conserved_by_gifts_and_losses():
    """What discs and pistons have and what is lost, less what came from outside."""
    energy = Energy(kinetic=5.0, rotational=2.0, potential=-1.0, piston=4.0, given=3.0, lost=0.5)
    assert (energy.gas, energy.balance, energy.scale) == (6.0, 7.5, 5.0)


def test_walls_give_and_pistons_with_a_mass_do_not():
    """Walls gave 1, 2, 4, 8; the bath 16, steps 32. Discs lost 0.5, hits of walls 1/4, 1/8, 1/16, 1/32.

    A piston with a mass at the right side is counted itself: what it gave is none of it, and hits of it lose energy.
    """
    gas = gas_of((10, 8), [(1, 1), (2, 2)], [(1, 0), (0, 2)], 0.1)
    pistons = np.zeros(1, PISTON).view(np.recarray)
    pistons.m, pistons.v, pistons.x, pistons.a, pistons.wall, pistons.outward = 2.0, 3.0, 9.0, -1.0, 1, 1.0
    given, lost = sums(1.0, 2.0, 4.0, 8.0), sums(0.5, 0.25, 0.125, 0.0625, 0.03125)
    effects = Effects(wall_energy=given, dissipated=lost, bath_energy=sums(16.0), step_energy=sums(32.0))
    assert energy_of(gas, effects) == Energy(kinetic=2.5, given=63.0, lost=0.5)
    assert energy_of(gas, effects._replace(piston=pistons)) == Energy(
        kinetic=2.5, piston=2 * (4.5 + 9.0), given=61.0, lost=0.625
    )
    pistons.m = 0.0  # of a given velocity
    assert energy_of(gas, effects._replace(piston=pistons)) == Energy(kinetic=2.5, given=63.0, lost=0.5)

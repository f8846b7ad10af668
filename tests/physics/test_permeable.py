"""Walls that let discs pass: a demon's door, and the osmotic pressure of hard discs."""

import math

import numpy as np
import pytest
from helpers.logs import log_of
from scipy.integrate import quad
from scipy.optimize import brentq

from idealgas import evolution, pressure
from idealgas.columns import Kind
from idealgas.theory.hard_discs import compressibility_factor, fluid_contact_value


def rows_of(text):
    (rows,) = log_of(text).chunks()
    return rows


DOOR = "wall = [{ from = [5, 0], to = [5, 10], permeable_from = 'left' }]"


@pytest.mark.usefixtures("uncompiled")
def test_a_disc_passes_once():
    """From x = 2 at speed 1 with radius 0.5: to the right side, and back and forth between it and the door."""
    disc = "disc = [{ position = [2, 5], velocity = [1, 0], radius = 0.5 }]"
    rows = rows_of(f"box.size = [10, 10]\n{DOOR}\n{disc}\nrun.events = 4")
    assert rows.time.tolist() == [7.5, 11.5, 15.5, 19.5]
    assert rows.position[:, 0].tolist() == [9.5, 5.5, 9.5, 5.5]
    assert rows.partner.tolist() == [-2, -5, -2, -5]


@pytest.mark.usefixtures("uncompiled")
def test_a_disc_that_is_hit_back_in_the_middle_stays():
    """It starts in the wall, its centre 0.25 beyond, is hit by a disc from the right, and bounces at x = 5."""
    discs = (
        """disc = [{ position = [5.25, 5], radius = 0.5 }, { position = [6.5, 5], velocity = [-1, 0], radius = 0.5 }]"""
    )
    rows = rows_of(f"box.size = [10, 10]\n{DOOR}\n{discs}\nrun.events = 2")
    assert rows.kind.tolist() == [Kind.DISC, Kind.DISC, Kind.WALL]
    assert rows.time.tolist() == [0.25, 0.25, 0.5]
    assert rows.position[-1].tolist() == [5.0, 5.0]
    assert rows.velocity[-1].tolist() == [1.0, 0.0]


@pytest.mark.usefixtures("uncompiled")
def test_a_gap_narrower_than_a_disc_keeps_it():
    """The door is 0.75 from the right side: the centre of the disc goes between them, from 9.25 to 9.5."""
    text = f"box.size = [10, 10]\n{DOOR.replace('[5,', '[9.25,')}\nrun.events = 5\n"
    rows = rows_of(text + "disc = [{ position = [2, 5], velocity = [1, 0], radius = 0.5 }]")
    assert rows.position[:, 0].tolist() == [9.5, 9.25, 9.5, 9.25, 9.5]
    assert np.diff(rows.time).tolist() == [0.25] * 4


def test_a_door_lets_discs_pass_at_the_rate_of_effusion():
    """Each disc on the left passes at the rate k = (w - 2R)⟨v⟩/πA; the door is a tenth of the mean free path wide.

    A disc that passes takes 3T/2 with it, where T is the mean: T ~ √N on the left, so dN/dt = -k N (N/N₀)^¼.
    """
    settings = ["species.gas.count=2000", "species.gas.radius=0.005", "run.until=400", "species.gas.region=[0,0,10,10]"]
    door = ["wall.0.to=[10,4.9]", "wall.door.from=[10,4.9]", "wall.door.to=[10,5.1]", "wall.2.from=[10,5.1]"]
    log = log_of("demon", *settings + door)
    beyond = evolution(log).beyond["gas"]
    passed = 1 - (1 + 0.19 * math.sqrt(math.pi / 2) / (math.pi * 9.99 * 9.99) * 400 / 4) ** -4
    assert (np.diff(beyond) >= 0).all()
    assert abs(beyond[-1] - passed) < 3 * math.sqrt(passed * (1 - passed) / 2000)


def osmotic_pressure(area, solvent, solute, radius):
    """Π/T of equal discs, from equal activity of the solvent on both sides, each of an area that centres reach.

    Of one equation of state Z: ln z = ln n + ∫ (Z - 1) dφ/φ + Z - 1 and p = n T Z.
    """
    covered = math.pi * radius**2
    z = lambda n: float(compressibility_factor(n * covered))  # noqa: E731
    excess = lambda n: 2 * quad(fluid_contact_value, 1e-9, n * covered)[0] + z(n) - 1  # noqa: E731
    u = solute / area[1]

    def unequal(left):
        right = (solvent - left * area[0]) / area[1]
        return math.log(left / right) + excess(left) - excess(right + u)

    left = brentq(unequal, 0.3 * solvent / sum(area), 0.99 * solvent / area[0])
    right = (solvent - left * area[0]) / area[1] + u
    return right * z(right) - left * z(left), left * area[0] / solvent


def of_wall(result, name):
    return next(wall.pressure for wall in result.mechanical.walls if wall.name == name)


@pytest.fixture(scope="module")
def osmosis():
    return log_of("osmosis")


def test_the_solute_presses_on_the_membrane_as_if_it_were_alone(osmosis):
    """Van 't Hoff to the second virial coefficient, n T (1 + 2πR² n), n = 100/9.9²: 3 standard errors.

    Centres reach 9.9 of the membrane, on whose whole length of 10 the pressure is measured.
    """
    result = pressure(osmosis)
    membrane = of_wall(result, "membrane, right")
    n = 100 / 9.9**2
    assert abs(membrane.value - 0.99 * n * (1 + 2 * math.pi * 0.05**2 * n)) < 3 * membrane.standard_error
    assert membrane.standard_error < 0.05 * n
    assert of_wall(result, "membrane, left").value == 0


def test_the_momentum_of_the_gas_balances_all_walls(osmosis):
    """Pressure on the right less that on the left is that on the membrane, up to the momentum that the gas has."""
    gas, velocity, given = osmosis.discs, osmosis.discs.velocity.copy(), np.zeros(2)
    for rows in osmosis.chunks():
        for disc, partner, new in zip(rows.disc, rows.partner, rows.velocity, strict=True):
            if partner < 0:
                given += gas.mass[disc] * (velocity[disc] - new)
            velocity[disc] = new
    change = gas.mass @ (gas.velocity - osmosis.state_at(osmosis.end_time).velocity)
    assert np.abs(given - change).max() < 1e-9
    result = pressure(osmosis, start=0.0)
    difference = of_wall(result, "right wall").value - of_wall(result, "left wall").value
    duration = result.window.end - result.window.start
    assert abs(difference - of_wall(result, "membrane, right").value) < 2 * np.abs(change[0]) / (10 * duration) + 1e-9


def test_fractions_by_chamber(osmosis):
    """The solute stays on the right; what it leaves of the room there is that of the solvent."""
    result = evolution(osmosis)
    assert (result.beyond["solute"] == 1).all()
    n = len(result.time)
    _, left = osmotic_pressure((9.9 * 9.95, 9.9 * 9.95), 400, 100, 0.05)
    independent = result.beyond["solvent"][:: n // 20]
    error = independent.std(ddof=1) / math.sqrt(len(independent))
    assert abs(independent.mean() - (1 - left)) < 3 * error


@pytest.mark.slow
def test_osmotic_pressure_has_the_correction_of_hard_discs():
    """Equal discs at φ = 0.07 on the right, 0.025 on the left: the equation of state within 3 standard errors."""
    settings = ["species.solvent.count=160", "species.solute.count=160", "species.solute.mass=1", "run.until=5000"]
    settings += ["species.solvent.radius=0.1", "species.solute.radius=0.1", "log.events=false", "log.pressure=true"]
    log = log_of("osmosis", *settings)
    membrane = of_wall(pressure(log), "membrane, right")
    expected, _ = osmotic_pressure((9.8 * 9.9, 9.8 * 9.8), 160, 160, 0.1)
    assert abs(membrane.value - 0.98 * expected) < 3 * membrane.standard_error
    assert abs(membrane.value - 160 / (9.8 * 10)) > 5 * membrane.standard_error

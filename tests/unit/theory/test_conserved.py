"""Motion of the gas as a whole, and gases that do not reach all states: scenes with them and without."""

import numpy as np
import pytest
from helpers.logs import PERIODIC, gas

from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene
from idealgas.theory import conserved
from idealgas.theory.forecast import forecast

TWO = gas(2, 0.2, (4, 3), "events = 100")
FLOW = "species = [{ name = 'gas', count = 4, radius = 0.2, velocities = [[3.1, 0], [2.9, 0], [3, 0.1], [3, -0.1]] }]"
ALONG = ", ".join(f"{{position = [{2 * k + 1}, 5], velocity = [3, {(-1) ** k / 10}], radius = 0.2}}" for k in range(20))
STREAM = f"""
box.size = [40, 40]
disc = [{ALONG}]
run.events = 100
"""


def made(text, *overrides):
    scene = parse_scene(text, overrides=overrides)
    return scene, make_gas(scene)


def test_two_discs_without_momentum_between_walls_are_not_ergodic():
    scene, gas = made(TWO)
    assert not conserved.is_ergodic(scene, gas)
    (sentence,) = conserved.caveats(scene, gas)
    assert sentence.startswith("Two equal discs with zero total momentum between walls")
    assert forecast(scene, gas).caveats == (sentence,)


@pytest.mark.parametrize(
    "overrides",
    [
        ("species.gas.count=3",),
        ("species.gas.temperature=", "species.gas.velocities=[[1, 0.5], [0.3, -0.7]]"),
        PERIODIC,
        ("box.left={thermal = 1}",),
        ("gravity.acceleration=[0, -1]",),
        ("wall=[{from=[2, 0], to=[2, 1]}]",),
    ],
)
def test_other_few_discs_are_ergodic(overrides):
    scene, gas = made(TWO, *overrides)
    assert conserved.is_ergodic(scene, gas)
    assert conserved.caveats(scene, gas) == ()


def test_a_flow_that_nothing_stops_is_no_temperature():
    """Of m⟨v²⟩/2 = 4.505 the share 4.5 is a flow at 3; the rest is (0.1² · 4)/(2 · 4).

    In equilibrium the 6 degrees of freedom that are no flow share it.
    """
    scene, gas = made(TWO, *PERIODIC, FLOW)
    assert conserved.centre_of_mass_velocity(scene, gas) == pytest.approx([3, 0])
    assert gas.temperature == pytest.approx(4.505)
    result = forecast(scene, gas)
    assert result.species[0].temperature == pytest.approx(0.005, rel=1e-9)
    assert result.temperature == pytest.approx(0.04 / 6, rel=1e-9)
    (sentence,) = result.caveats
    assert "moves as a whole with velocity (3, 0), 99.9% of its kinetic energy" in sentence


def test_unequal_discs_have_a_centre_of_mass_and_a_fixed_disc_takes_momentum():
    """3 (2, 1) + (-2, 5) = 4 (1, 2). Beside a fixed disc the other has both of its degrees of freedom."""
    pair = "species=[{{name='a', mass={}, velocities=[[2, 1]], {n}}}, {{name='b', velocities=[[-2, 5]], {n}}}]"
    scene, gas = made(TWO, *PERIODIC, pair.format(3, n="count=1, radius=0.2"))
    assert conserved.centre_of_mass_velocity(scene, gas) == pytest.approx([1, 2])
    assert conserved.degrees_of_freedom(scene, gas) == 2
    assert conserved.degrees_of_freedom(*made(TWO, *PERIODIC, pair.format(1e12, n="count=1, radius=0.2"))) == 2
    for unit in (0.1, 1.0, 10.0):
        assert conserved.are_fixed(unit * np.array([1e12, 0.9e12, 1.0])).tolist() == [True, False, False]


def test_a_flow_that_walls_stop_becomes_heat():
    scene, gas = made(STREAM)
    assert conserved.centre_of_mass_velocity(scene, gas).tolist() == [0, 0]
    result = forecast(scene, gas)
    assert result.species[0].temperature == pytest.approx(0.005, rel=1e-9)
    assert result.temperature == pytest.approx(4.505, rel=1e-9)
    (sentence,) = result.caveats
    assert "starts with a common velocity (3, 0), 99.9% of its kinetic energy" in sentence
    assert "becomes heat at the walls" in sentence
    (sentence,) = forecast(*made(STREAM, "thermostat={ temperature = 0.1, rate = 1 }", "run.events=10000")).caveats
    assert "is lost to the heat bath" in sentence


@pytest.mark.parametrize("overrides", [(), PERIODIC], ids=["walls", "periodic"])
@pytest.mark.parametrize("seed", range(5))
def test_motion_by_chance_is_not_mentioned(overrides, seed):
    start = ("species.gas.count=200", "species.gas.temperature=", "species.gas.speed=2", "species.gas.radius=0.01")
    scene, gas = made(TWO, *overrides, *start, f"scene.seed={seed}")
    share = conserved.share_of_motion(gas, gas.mass @ gas.velocity / gas.mass.sum())
    assert 0 < share < 12 / 200
    assert forecast(scene, gas).caveats == () or (overrides and share > conserved.SAID_FROM)
    if not overrides:
        assert np.array_equal(conserved.motion_at_start(scene, gas), [0, 0])
        assert forecast(scene, gas).species[0].temperature == pytest.approx(2.0, rel=1e-12)

"""Discs that do not interact: each moves, bit for bit, as if it were alone in the box."""

from dataclasses import replace

import numpy as np
import pytest
from helpers.support import record, same_rows

from idealgas.columns import IMAGE
from idealgas.engine.epoch import encounters_of_effects, epoch_length
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop
from idealgas.initial.build import make_gas
from idealgas.run.effects import make_effects
from idealgas.scene import parse_scene
from idealgas.state import Gas

pytestmark = pytest.mark.interpreted

FOUR_SIDES = 'left = "periodic", right = "periodic", bottom = "periodic", top = "periodic"'
SCENES = {
    "box": "box.size = [6, 4]",
    "Lorentz gas": f"""
        box = {{ size = [3, 2.5], {FOUR_SIDES} }}
        disc = [{{ position = [0, 0], radius = 1, fixed = true }}]
    """,
    "holes, gate and arc": """
        box = { size = [8, 6] }
        [[wall]]
        from = [2, 2]
        to = [4, 2]
        via = [3, 3]
        [[wall]]
        from = [6, 1]
        to = [6, 1.05]
        absorbing = true
        [[wall]]
        from = [5, 3]
        to = [5, 5]
        closes_at = 30
    """,
}
DISCS = """
    run.until = 1
    interactions.discs = false
    species = [{ name = "a", count = 6, radius = 0.01, speed = 0.7 }]
"""


def gas_and_effects(text: str, *overrides: str):
    scene = parse_scene(text, overrides=overrides)
    gas = make_gas(scene)
    return gas, lambda: make_effects(scene, gas)


def only(gas: Gas, k: int) -> Gas:
    """The gas of disc k alone."""
    names = ("position", "velocity", "radius", "mass", "species")
    return replace(gas, **{name: getattr(gas, name)[k : k + 1] for name in names})


def rows_of(batch, k: int):
    return type(batch)(*(None if column is None else column[batch.disc == k] for column in batch))


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize(("name", "time"), [("box", 600.0), ("Lorentz gas", 150.0), ("holes, gate and arc", 600.0)])
def test_discs_of_one_speed_move_as_in_runs_of_one_disc_each(name, time):
    gas, effects = gas_and_effects(DISCS + SCENES[name])
    together = Simulation(gas, EventDriven(), effects())
    stop = Stop(time=time)
    events = record(together, stop)
    assert together.epoch >= 2  # rounding at the ends of epochs matters too
    assert len(events.time) > 250
    for k in range(len(gas)):
        own = effects()
        if own.periodic is not None:
            own = own._replace(periodic=own.periodic._replace(image=np.zeros((1, 2), IMAGE.dtype)))
        alone = record(Simulation(only(gas, k), EventDriven(), own), stop)
        expected = rows_of(events, k)
        assert same_rows(alone._replace(disc=expected.disc), expected)


DRIVEN = """
    run.until = 1
    interactions.discs = false
    box = { size = [8, 6], left = { thermal = 2 }, bottom = { vibrating = { amplitude = 0.1, frequency = 1.4 } } }
    gravity.acceleration = [0.1, -0.4]
    thermostat = { temperature = 1.5, rate = 0.1 }
    species = [
        { name = "a", count = 6, radius = 0.1, temperature = 1 },
        { name = "b", count = 2, radius = 0.4, speed = 3 },
    ]
    wall = [{ from = [3, 3], to = [3.1, 3.1], absorbing = true }]
    [rotation]
    [restitution]
    wall = 0.9
"""


@pytest.mark.usefixtures("uncompiled")
def test_whatever_their_speeds_if_epochs_are_equal(monkeypatch):
    """Random numbers belong to ids, so all discs but one have left the gas from the start."""
    monkeypatch.setattr("idealgas.engine.simulation.epoch_length", lambda *_: 2.0)
    gas, effects = gas_and_effects(DRIVEN)
    stop = Stop(time=50.0)
    events = record(Simulation(gas, EventDriven(), effects()), stop)
    assert len(events.time) > 120
    assert {-1, -3} <= set(events.partner.tolist())  # the thermal and the vibrating side
    for k in range(len(gas)):
        others = np.arange(len(gas)) != k
        position, velocity = gas.position.copy(), gas.velocity.copy()
        position[others], velocity[others] = np.nan, 0.0
        alone = Simulation(replace(gas, position=position, velocity=velocity), EventDriven(), effects())
        assert same_rows(record(alone, stop), rows_of(events, k))


def length_of_epoch(gas: Gas, effects, speed: float = 1.0) -> float:
    gas = replace(gas, velocity=speed * gas.velocity)
    return epoch_length(gas, encounters_of_effects(gas, effects), interacting=False)


def test_epochs_depend_neither_on_the_number_of_discs_nor_on_the_last_digits_of_their_speeds():
    gas, effects = gas_and_effects(DISCS + SCENES["Lorentz gas"])
    lengths = {length_of_epoch(only(gas, k), effects()) for k in range(len(gas))}
    assert lengths == {length_of_epoch(gas, effects())}
    # per length: hits on the scatterer, whose perimeter is 2π, in the area that is left, and crossings of the sides
    met = 2 / (7.5 - np.pi) + (2 / 2.98 + 2 / 2.48) / np.pi
    assert 32 <= lengths.pop() * 0.7 * met <= 64
    box, effects = gas_and_effects(DISCS + SCENES["box"])
    scale = 64 * np.pi / (2 / 5.98 + 2 / 3.98) / 0.7 / 2**8  # at this speed the length is 2^8, up to rounding
    assert {length_of_epoch(box, effects(), scale * factor) for factor in (1 - 1e-12, 1, 1 + 1e-12)} == {2.0**8}
    assert length_of_epoch(box, effects(), scale * (1 + 1e-5)) == 2.0**7
    at_rest = replace(box, velocity=np.where(np.arange(6)[:, None] < 4, 0.0, box.velocity))
    assert length_of_epoch(at_rest, effects()) == length_of_epoch(box, effects())

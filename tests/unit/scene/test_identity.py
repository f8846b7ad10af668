"""Which scenes are the same run, and which the same gas."""

import pytest

from idealgas.scene import parse_scene
from idealgas.scene.scene import describe_gas, draws_random_numbers, gas_digest, gas_kind, is_mixture, run_digest

GAS = """
scene.seed = 3
box.size = [8, 6]
species = [{name = "gas", count = 30, radius = 0.2, temperature = 1.0}]
run.events = 100
"""
DISCS = """
box.size = [8, 6]
disc = [{position = [1, 1], velocity = [1, 0], radius = 0.2}, {position = [3, 1], radius = 0.2}]
run.events = 100
"""


def scene(*overrides, text=GAS):
    return parse_scene(text, overrides=overrides)


@pytest.mark.parametrize(
    ("digest", "overrides"),
    [
        (run_digest, ("run.events=900",)),
        (run_digest, ("scene.title=again",)),
        (run_digest, ("log.compression=none",)),
        (run_digest, ("run.method=brute_force",)),
        (gas_digest, ("scene.seed=4", "run.events=900")),
        (gas_digest, ("species.gas.temperature=2",)),
        (gas_digest, ("species.gas.temperature=", "species.gas.speed=2")),
        (gas_digest, ("species.gas.name=air",)),
        (gas_digest, ("species.gas.placement=lattice",)),
    ],
)
def test_the_same(digest, overrides):
    assert digest(scene(*overrides)) == digest(scene())


@pytest.mark.parametrize(
    ("digest", "overrides"),
    [
        (run_digest, ("scene.seed=4",)),
        (run_digest, ("species.gas.temperature=2",)),
        (run_digest, ("species.gas.count=31",)),
        (run_digest, ("box.size=[8, 7]",)),
        (run_digest, ("gravity.acceleration=[0, -1]",)),
        (gas_digest, ("species.gas.count=31",)),
        (gas_digest, ("species.gas.radius=0.21",)),
        (gas_digest, ("species.gas.mass=2",)),
        (gas_digest, ("box.size=[8, 7]",)),
        (gas_digest, ("box.left=periodic", "box.right=periodic")),
        (gas_digest, ("box.left={thermal = 1}",)),
        (gas_digest, ("gravity.acceleration=[0, -1]",)),
        (gas_digest, ("wall=[{from=[4, 0], to=[4, 3]}]",)),
    ],
)
def test_another(digest, overrides):
    assert digest(scene(*overrides)) != digest(scene())


def test_seeds_without_draws_and_other_temperatures_of_walls():
    assert draws_random_numbers(scene())
    assert not draws_random_numbers(scene(text=DISCS))
    assert run_digest(scene("scene.seed=9", text=DISCS)) == run_digest(scene(text=DISCS))
    hot = "box.left={thermal = 1}"
    assert run_digest(scene(hot, "scene.seed=9", text=DISCS)) != run_digest(scene(hot, text=DISCS))
    assert gas_digest(scene("box.left={thermal = 1}")) == gas_digest(scene("box.left={thermal = 2}"))
    piston = "piston=[{mass = 2, pressure = 1, position = %g}]"
    assert gas_digest(scene(piston % 6)) == gas_digest(scene(piston % 7))


def test_words():
    assert describe_gas(scene()) == "N = 30 in 8 × 6, equal discs, reflecting box"
    assert gas_kind(scene("species.gas.count=60", "box.size=[80, 60]")) == gas_kind(scene())
    two = '[{name="a", count=30, radius=0.1, speed=1}, {name="b", count=10, radius=0.2, speed=1}]'
    mixture = scene(f"species={two}", "gravity.acceleration=[0, -1]")
    assert gas_kind(mixture) == "mixture (0.75 of radius 1, 0.25 of radius 2), gravity"
    assert is_mixture(mixture)
    assert not is_mixture(scene())

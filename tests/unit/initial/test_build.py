import numpy as np
import pytest

from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene
from idealgas.state import rng

BOX_AND_RUN = "box.size = [10, 10]\nrun.until = 1\n"


def species(name, **keys):
    return f'[[species]]\nname = "{name}"\n' + "".join(f"{key} = {value}\n" for key, value in keys.items())


def gas_of(*tables, overrides=()):
    return make_gas(parse_scene(BOX_AND_RUN + "".join(tables), overrides=overrides))


def disc(x, y, radius=0.5, mass=1.0):
    return f"[[disc]]\nposition = [{x}, {y}]\nvelocity = [{x}, -1]\nradius = {radius}\nmass = {mass}\n"


A = species("a", count=50, radius=0.1, temperature=1.5, mass=2)
B = species("b", count=30, radius=0.2, speed=3)


def test_explicit_discs_come_first_then_species_in_order():
    gas = gas_of(B, A, disc(1, 1), disc(5, 5))
    assert gas.species_names == ("disc", "b", "a")
    assert gas.species.tolist() == [0] * 2 + [1] * 30 + [2] * 50
    assert gas.position[:2].tolist() == [[1, 1], [5, 5]]
    assert gas.velocity[:2].tolist() == [[1, -1], [5, -1]]
    assert gas.radius[[0, 2, 32]].tolist() == [0.5, 0.2, 0.1]
    assert gas.mass[[0, 2, 32]].tolist() == [1, 1, 2]
    gas = gas_of(disc(1, 1), disc(3, 1, radius=0.3), disc(5, 1), disc(7, 1, mass=2), A)
    assert gas.species_names == ("disc", "a")
    assert gas.species[:5].tolist() == [0, 0, 0, 0, 1]
    assert gas.radius[:4].tolist() == [0.5, 0.3, 0.5, 0.5]
    assert gas.mass[:4].tolist() == [1, 1, 1, 2]
    gas = gas_of(A, disc(1, 1))
    arrays = (gas.position, gas.velocity, gas.radius, gas.mass, gas.species)
    assert [array.dtype.str for array in arrays] == ["<f8"] * 4 + ["<u2"]
    assert [array.shape for array in arrays] == [(51, 2), (51, 2), (51,), (51,), (51,)]


def test_a_temperature_is_exact_means_gaussian_velocities_and_carries_no_momentum():
    gas = gas_of(A)
    assert gas.temperature == pytest.approx(1.5, rel=1e-15)
    assert np.abs(gas.velocity.sum(axis=0)).max() < 1e-13
    assert gas_of(species("a", count=1, radius=0.1, temperature=2)).kinetic_energy == pytest.approx(2, rel=1e-15)
    # Kurtosis 3 of both components, within 4 standard errors √(24/n).
    v = gas_of(species("a", count=20_000, radius=0.01, temperature=1)).velocity
    kurtosis = (v**4).mean(axis=0) / (v**2).mean(axis=0) ** 2
    assert np.abs(kurtosis - 3).max() < 4 * np.sqrt(24 / len(v))


def test_speeds_and_velocities_as_told():
    """The mean direction of n random ones has length 1/√n; twice that allows for 98 % of seeds."""
    v = gas_of(species("a", count=1000, radius=0.05, speed=3)).velocity
    assert np.hypot(*v.T) == pytest.approx(3, rel=1e-15)
    assert np.hypot(*v.mean(axis=0)) < 2 * 3 / np.sqrt(1000)
    v = gas_of(species("a", count=2, radius=0.1, velocities="[[1, 0], [0.1, -2]]")).velocity
    assert v.tolist() == [[1, 0], [0.1, -2]]


@pytest.mark.parametrize("motion", [{"temperature": 0}, {"speed": 0}])
def test_at_rest(motion):
    assert not gas_of(species("a", count=10, radius=0.1, **motion)).velocity.any()


def test_seeds_and_streams():
    result, same = gas_of(A, B), gas_of(A, B)
    other = gas_of(A, B, overrides=["scene.seed=1"])
    assert (result.position == same.position).all()
    assert (result.velocity == same.velocity).all()
    assert not (result.position == other.position).any()
    assert not (result.velocity == other.velocity).any()
    alone, behind = gas_of(A), gas_of(B, A, disc(5, 5))
    assert (behind.velocity[behind.species == 2] == alone.velocity).all()
    first = {rng(seed, use).random() for seed in (0, 1) for use in ("placement", "velocities a", "velocities b")}
    assert len(first) == 6


def test_discs_stand_in_their_region_and_before_the_piston():
    for placement in ('"random"', '"lattice"'):
        gas = gas_of(species("a", count=40, radius=0.1, speed=1, region="[2, 3, 4, 9]", placement=placement))
        assert (gas.position >= [2.1, 3.1]).all()
        assert (gas.position <= [3.9, 8.9]).all()
    for side, low, high in (("right", [0, 0], [4, 10]), ("left", [4, 0], [10, 10]), ("top", [0, 0], [10, 4])):
        piston = f"piston=[{{ side = '{side}', position = 4, mass = 1, pressure = 1 }}]"
        for placement in ("random", "lattice"):
            gas = gas_of(species("a", count=40, radius=0.3, speed=1, placement=f'"{placement}"'), overrides=[piston])
            assert (gas.position >= np.add(low, 0.3)).all()
            assert (gas.position <= np.subtract(high, 0.3)).all()


def test_lattices_are_shared_at_random_and_leave_out_what_is_taken():
    gas = gas_of(*(species(n, count=50, radius=0.3, speed=1, placement='"lattice"') for n in "ab"))
    assert len(np.unique(gas.position, axis=0)) == 100
    assert len(np.unique(gas.position[:, 1])) == 10
    for kind in (0, 1):
        assert len(np.unique(gas.position[gas.species == kind, 1])) > 5
    gas = gas_of(disc(5, 5, radius=2), species("a", count=60, radius=0.3, speed=1, placement='"lattice"'))
    assert np.hypot(*(gas.position[1:] - 5).T).min() >= 2.3
    # Two walls cross the box; what does not fit into the rows between them goes elsewhere.
    walls = "wall=[{ from = [0, 5], to = [10, 5] }, { from = [5, 0], to = [5, 10] }]"
    gas = gas_of(species("a", count=80, radius=0.3, speed=1, placement='"lattice"'), overrides=[walls])
    assert np.abs(gas.position - 5).min() >= 0.3
    assert len(np.unique(gas.position, axis=0)) == 80


def test_random_discs_avoid_lattices_and_explicit_discs_of_any_size():
    gas = gas_of(
        species("dust", count=500, radius=0.02, speed=1),
        species("stones", count=20, radius=0.5, speed=1),
        species("grid", count=49, radius=0.1, speed=1, placement='"lattice"'),
        disc(5, 5, radius=2),
    )
    dx = gas.position[:, None] - gas.position
    reach = gas.radius[:, None] + gas.radius
    overlap = (dx**2).sum(axis=2) < reach**2
    assert overlap.sum() == len(gas)  # every disc with itself


def test_discs_of_a_periodic_box_stand_anywhere_in_it():
    """Centres nearer to the sides than a radius, on all four, and none beyond."""
    periodic = [f"box.{side}=periodic" for side in ("left", "right", "bottom", "top")]
    position = gas_of(species("a", count=200, radius=0.3, speed=1), overrides=periodic).position
    assert ((position >= 0) & (position < 10)).all()
    for axis in range(2):
        assert position[:, axis].min() < 0.3
        assert position[:, axis].max() > 9.7


def test_sheared_sides_add_their_flow_to_velocities_that_are_drawn():
    """At y the flow is 0.5 (y - 5); given velocities are as they are given, of a species too."""
    scene = parse_scene("""
        box.size = [10, 10]
        box.left = "periodic"
        box.right = "periodic"
        box.bottom = { shear = 0.5 }
        box.top = { shear = 0.5 }
        run.until = 1
        species = [
            { name = "given", count = 1, radius = 0.5, velocities = [[0.25, 0]], region = [1, 8, 3, 9.5] },
            { name = "drawn", count = 1, radius = 0.5, speed = 1e-9, region = [1, 1, 3, 2.5] },
        ]
    """)
    gas = make_gas(scene)
    assert gas.velocity[0].tolist() == [0.25, 0.0]
    assert gas.velocity[1, 0] == pytest.approx(0.5 * (gas.position[1, 1] - 5), abs=1e-8)

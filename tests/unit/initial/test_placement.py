import hashlib
import math

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.distance import pdist

from idealgas.initial import placement
from idealgas.initial.build import make_gas
from idealgas.initial.lattices import make_lattice
from idealgas.initial.room import make_room
from idealgas.scene import parse_scene

LOW, HIGH = np.array([1.0, 2.0]), np.array([9.0, 7.0])


def inside(sites, low=LOW, high=HIGH):
    return bool(((sites >= low) & (sites <= high)).all())


@pytest.mark.parametrize("number", [1, 2, 3, 7, 20, 40])
def test_a_lattice_has_sites_enough_that_keep_their_distance(number):
    sites = make_lattice(LOW, HIGH, 1.0, number)
    assert len(sites) >= number
    assert inside(sites)
    assert len(sites) == 1 or pdist(sites).min() >= 1.0


def test_a_square_lattice_can_be_filled_to_the_last_site():
    low, high = np.array([0.5, 0.5]), np.array([9.5, 4.5])
    sites = make_lattice(low, high, 1.0, 50)
    assert len(sites) == 50
    assert inside(sites, low, high)
    assert pdist(sites).min() == 1.0
    assert make_lattice(LOW, HIGH, 1.0, 80) is None


@pytest.mark.parametrize(("side", "number"), [(40.0, 1711), (31.94, 1000)])
def test_beyond_the_square_lattice_comes_the_triangular_one(side, number):
    low, high = np.array([0.5, 0.5]), np.array([side - 0.5, side - 0.5])
    sites = make_lattice(low, high, 1.0, number)
    assert number > int(side) ** 2
    assert len(sites) >= number
    assert inside(sites, low, high)
    assert pdist(sites).min() >= 1.0
    assert make_lattice(low, high, 1.0, int(0.9069 * side**2 / (math.pi / 4))) is None


def placed_at_random(number, packing, seed=0):
    """Positions of discs of diameter 1 in a square box, and its side."""
    radius = np.full(number, 0.5)
    side = math.sqrt(number * math.pi / 4 / packing)
    position = np.empty((number, 2))
    bounds = np.tile([0.5, 0.5, side - 0.5, side - 0.5], (number, 1))
    ids, rng = np.arange(number), np.random.default_rng(seed)
    room = make_room((side, side), radius)
    assert placement.place_at_random(room, position, radius, bounds, ids[:0], ids, rng, 10**7) == number
    return position, side


@pytest.mark.parametrize("packing", [0.01, 0.3, 0.5, 0.6])
def test_random_discs_do_not_overlap(packing):
    position, side = placed_at_random(2_000, packing)
    assert inside(position, 0.5, side - 0.5)
    assert pdist(position).min() >= 1.0


def test_dilute_discs_are_spread_evenly():
    """Counts in 10 × 10 cells: their variance over mean is 1 for ideal, about 1 - 4φ for hard discs (S(0), B2)."""
    position, side = placed_at_random(20_000, 0.01, seed=3)
    cells = np.minimum((10 * (position - 0.5) / (side - 1)).astype(int), 9)
    counts = np.bincount(10 * cells[:, 0] + cells[:, 1], minlength=100)
    expected, standard_error = 1 - 4 * 0.01, math.sqrt(2 / 99)
    assert abs(counts.var(ddof=1) / counts.mean() - expected) < 4 * standard_error


def test_dense_discs_are_near_equilibrium():
    """Pairs near contact at φ = 0.5, against χ = 3.125 (Henderson); pure random addition has no such state at all.

    Discs were moved only while others were added, so this is no equilibrium: 10 % are allowed.
    """
    position, side = placed_at_random(20_000, 0.5)
    width = 0.02
    pairs = cKDTree(position).query_pairs(1 + width, output_type="ndarray")
    deep = ((position > 3) & (position < side - 3)).all(axis=1)
    neighbours = np.bincount(pairs.ravel(), minlength=len(position))[deep].mean()
    near_contact = neighbours / (len(position) / side**2 * math.pi * ((1 + width) ** 2 - 1))
    assert near_contact == pytest.approx(3.125, rel=0.1)


@pytest.mark.parametrize("few", [0, 10**6])
def test_random_placement_gives_up(monkeypatch, few):
    monkeypatch.setattr(placement, "FEW", few)
    radius, ids = np.full(3, 0.5), np.arange(3)
    room = make_room((1.95, 1.9), radius)
    bounds = np.tile([0.5, 0.5, 1.45, 1.4], (3, 1))
    rng, nobody = np.random.default_rng(0), ids[:0]
    assert placement.place_at_random(room, np.empty((3, 2)), radius, bounds, nobody, ids, rng, 1_000) == 2


MIXTURE = """
box = { size = [10, 8], left = "periodic", right = "periodic" }
run.until = 1
species = [
  { name = "large", count = 20, radius = 0.4, speed = 1, placement = "random" },
  { name = "even", count = 30, radius = 0.1, speed = 1, placement = "lattice", region = [1, 1, 9, 7] },
  { name = "small", count = 700, radius = 0.1, speed = 1, placement = "random" },
]
disc = [{ position = [5, 4], radius = 1 }]
wall = [
  { from = [1, 1], to = [2, 3] },
  { from = [7, 2], to = [9, 2], via = [8, 3] },
  { from = [3, 6], to = [3, 6], via = [4, 6], solid = "inside" },
]
"""


@pytest.mark.parametrize("few_refusals", [10**9, 100])
def test_python_and_compiled_code_place_discs_alike(monkeypatch, few_refusals):
    """Bit for bit, all in one of them or the rest after some refusals."""
    positions = []
    for few in (0, 10**6):
        monkeypatch.setattr(placement, "FEW", few)
        monkeypatch.setattr(placement, "FEW_REFUSALS", few_refusals)
        positions.append(make_gas(parse_scene(MIXTURE)).position)
    assert positions[0].tobytes() == positions[1].tobytes()


def test_a_seed_gives_the_same_gas_as_ever():
    position = make_gas(parse_scene(MIXTURE)).position
    assert hashlib.sha256(position.tobytes()).hexdigest()[:16] == "a90c622c4310f29a"


def test_discs_that_do_not_interact_are_spread_evenly_over_the_room_between_walls():
    """Discs as wide as half the box, where pairs would fit side by side only: distances to walls stay, overlaps too."""
    scene = parse_scene("""
        run.until = 1
        interactions.discs = false
        box.size = [4, 4]
        wall = [{ from = [3, 0], to = [3, 4] }]
        disc = [{ position = [0, 2], radius = 0.5, fixed = true }]
        species = [{ name = "gas", count = 4000, radius = 0.4, speed = 1 }]
    """)
    x, y = make_gas(scene).position.T
    assert (np.hypot(x, y - 2) >= 0.9).all()
    right, left = x > 3, x < 3
    assert x[left].max() <= 2.6
    assert x[right].min() >= 3.4
    # the centres reach (2.6 - 0.4) 3.2 less a segment of the circle of 0.9, and 0.2 × 3.2
    segment = 0.81 * math.acos(0.4 / 0.9) - 0.4 * math.sqrt(0.81 - 0.16)
    share = 0.64 / (2.2 * 3.2 - segment + 0.64)
    assert right.mean() == pytest.approx(share, abs=3.5 * math.sqrt(share * (1 - share) / 4000))
    upper = np.count_nonzero(y > 2) / 4000
    assert upper == pytest.approx(0.5, abs=3.5 * math.sqrt(0.25 / 4000))

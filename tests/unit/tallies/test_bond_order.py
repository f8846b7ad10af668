"""Order of neighbours: perfect lattices, cells cut out by hand, and fluids."""

import itertools
import math

import numpy as np
import pytest
from helpers.logs import gas, raised

from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene
from idealgas.tallies import bond_order as module
from idealgas.tallies.bond_order import bond_order


def triangular(columns, rows):
    """Sites of a triangular lattice of spacing 1, and the periodic box that it fits into."""
    column, row = (axis.ravel() for axis in np.meshgrid(np.arange(columns), np.arange(rows)))
    return np.column_stack((column + row % 2 / 2, row * math.sqrt(3) / 2)), (columns, rows * math.sqrt(3) / 2)


@pytest.mark.parametrize("shape", [(1, 2), (2, 2), (4, 6), (3, 40), (29, 30)])
def test_a_triangular_lattice_has_order_1(shape):
    sites, box = triangular(*shape)
    result = bond_order((sites + 0.3) % box, box, (True, True))
    assert result.value == pytest.approx(1.0, abs=1e-9)
    assert (result.neighbours == 6).all()
    turned = bond_order(sites[:, ::-1], box[::-1], (True, True))  # neighbours above and below instead of beside
    assert turned.value == pytest.approx(-1.0, abs=1e-9)


def test_a_square_lattice_has_none():
    sites = np.array(list(itertools.product(range(5), range(4)))) + 0.5
    result = bond_order(sites, (5, 4), (True, True))
    assert np.abs(result.value).max() < 1e-9
    assert (result.neighbours == 4).all()  # and not those across corners, where four cells meet


def cut(polygon, middle, normal):
    """Part of a polygon behind a line; corners (C, 3) with a mark of an edge that begins there, nan at the cut."""
    side = (polygon[:, :2] - middle) @ normal
    actual = []
    for k in range(len(polygon)):
        after = (k + 1) % len(polygon)
        if side[k] <= 0:
            actual.append(polygon[k])
        if (side[k] <= 0) != (side[after] <= 0):
            at = polygon[k, :2] + side[k] / (side[k] - side[after]) * (polygon[after, :2] - polygon[k, :2])
            actual.append((*at, math.nan if side[k] <= 0 else polygon[k, 2]))  # the edge that starts here is the cut
    return np.array(actual)


def by_hand(position, box, periodic):
    """ψ₆ of every disc from its cell, which the bisectors to all others, images included, cut out of the box."""
    shifts = list(itertools.product(*([-2, -1, 0, 1, 2] if wrapped else [0] for wrapped in periodic)))
    order = []
    for i, centre in enumerate(position):
        low = np.where(periodic, centre - box, 0.0)
        high = np.where(periodic, centre + box, box)
        cell = np.array([(low[0], low[1], -1), (high[0], low[1], -1), (high[0], high[1], -1), (low[0], high[1], -1)])
        others = [q + np.array(s) * box for j, q in enumerate(position) for s in shifts if j != i or any(s)]
        for k, other in enumerate(others):
            cell = cut(cell, (centre + other) / 2, other - centre)
            cell[:, 2] = np.where(np.isnan(cell[:, 2]), k, cell[:, 2])
        edges = np.hypot(*(np.roll(cell[:, :2], -1, axis=0) - cell[:, :2]).T)
        bonds = [(edge, others[int(k)] - centre) for edge, k in zip(edges, cell[:, 2], strict=True) if k >= 0]
        total = sum(edge * np.exp(6j * math.atan2(y, x)) for edge, (x, y) in bonds)
        order.append(total / sum(edge for edge, _ in bonds) if bonds else 0.0)
    return np.array(order)


@pytest.mark.parametrize("periodic", [(True, True), (True, False), (False, True), (False, False)])
@pytest.mark.parametrize("number", [1, 2, 3, 7, 40])
def test_cells_cut_out_by_hand(number, periodic):
    box = np.array((1.5, 1.0))
    position = np.random.default_rng(number).random((number, 2)) * box
    result = bond_order(position, tuple(box), periodic)
    assert result.value == pytest.approx(by_hand(position, box, periodic), abs=1e-9)


def test_few_discs_in_a_long_box_have_neighbours_far_away():
    position = np.random.default_rng(3).random((20, 2)) * (100, 0.1)
    result = bond_order(position, (100, 0.1), (True, True))
    assert result.neighbours.mean() == 6  # Euler's formula on a torus
    assert np.abs(result.value).max() <= 1 + 1e-12


def test_order_does_not_depend_on_where_the_box_is_cut():
    position = np.random.default_rng(5).random((50, 2))
    first, moved = (bond_order((position + shift) % 1, (1, 1), (True, True)) for shift in (0.0, (0.37, 0.81)))
    assert first.value == pytest.approx(moved.value, abs=1e-9)


def test_100_states_of_a_fluid_have_no_common_direction():
    """√N |⟨ψ₆⟩| is below 4 where directions are independent: their sum is a walk of N steps of less than 1."""
    actual = []
    for seed in range(100):
        made = make_gas(parse_scene(gas(400, 0.01545096808, (1, 1), "until = 1", periodic="xy", seed=seed)))
        actual.append(20 * abs(bond_order(made.position, made.box, (True, True)).value.mean()))
    assert made.packing_fraction == pytest.approx(0.3, abs=1e-6)
    assert np.mean(actual) < 4
    assert np.mean(actual) > 0.3  # and they have an order, each of its own


def test_an_uneven_gas_needs_no_images(monkeypatch):
    """Cells that sides cut off are those of the discs and four points around them, found once."""
    points, voronoi = [], module.Voronoi
    monkeypatch.setattr(module, "Voronoi", lambda sites: points.append(len(sites)) or voronoi(sites))
    rng = np.random.default_rng(1)
    uneven = np.column_stack((rng.uniform(0, 10, 1000), np.minimum(rng.exponential(5.0, 1000), 60.0)))
    bond_order(uneven, (10.0, 60.0), (False, False))
    assert points == [1004]


def test_discs_at_one_place_or_outside_the_box_are_refused():
    raised("same position", bond_order, np.full((3, 2), math.nan), (1, 1), (True, True))
    inside = np.random.default_rng(1).random((20, 2))
    for beyond in ((0.5, 3.0), (-0.2, 0.5)):
        raised("outside the box", bond_order, np.vstack((inside, beyond)), (1, 1), (False, False))

"""Triangular lattices in a periodic box: their shape, their strain, and the box without any."""

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

from idealgas.initial.build import make_gas
from idealgas.initial.lattices import lattice_sites
from idealgas.scene import parse_scene
from idealgas.scene.lattice import triangular_lattice


def test_870_discs_in_a_square_are_strained_and_an_odd_number_has_no_lattice():
    result = triangular_lattice(870, (1.0, 1.0))
    assert {result.columns, result.rows} == {29, 30}
    assert result.strain == pytest.approx(29 / 30 / (math.sqrt(3) / 2) - 1)  # 11.6 %
    width, height = result.unstrained
    assert width * height == pytest.approx(1.0)
    assert triangular_lattice(870, (width, height)).strain == pytest.approx(0.0, abs=1e-12)
    assert triangular_lattice(29, (1.0, 1.0)) is None


@pytest.mark.parametrize(
    ("number", "size"), [(480, (24, 17.3)), (480, (17.3, 24)), (2, (1, 1.7)), (12, (1, 9)), (870, (1, 1))]
)
def test_sites_are_as_far_apart_as_said(number, size):
    lattice = triangular_lattice(number, size)
    sites = lattice_sites(lattice)
    assert len(sites) == number
    assert (sites >= 0).all()
    assert (sites < size).all()
    images = np.concatenate([sites + np.array(size) * (i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    assert cKDTree(images).query(sites, k=2)[0][:, 1] == pytest.approx(lattice.nearest)


def test_discs_start_on_the_lattice_up_to_a_packing_fraction_of_0_9():
    sides = "".join(f"box.{side} = 'periodic'\n" for side in ("left", "right", "bottom", "top"))
    species = "[[species]]\nname='{}'\ncount=240\nradius=0.49805\ntemperature=1\nplacement='triangular'\n"
    box = f"box.size = [24, {10 * math.sqrt(3)!r}]\nrun.until = 1\n{sides}"
    gas = make_gas(parse_scene(box + species.format("a") + species.format("b")))
    assert gas.packing_fraction > 0.8996
    mixed = cKDTree(gas.position, boxsize=gas.box).query(gas.position, k=7)[1][:, 1:] >= 240
    assert 0.4 < mixed.mean() < 0.6  # the two species share the sites at random

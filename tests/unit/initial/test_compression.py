"""Compression of discs to a dense state: no overlap, the right size, the same every time; and when they jam."""

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

from idealgas.initial import compression
from idealgas.initial.build import make_gas
from idealgas.initial.compression import GAP, _grow, _synchronised, compress
from idealgas.scene import SceneError, parse_scene

PERIODIC = "".join(f"box.{side} = 'periodic'\n" for side in ("left", "right", "bottom", "top"))


def scene(packing_fraction, count=100, seed=1, more=""):
    radius = math.sqrt(packing_fraction / count / math.pi)
    species = f"[[species]]\nname='gas'\ncount={count}\nradius={radius!r}\ntemperature=1\nplacement='compressed'\n"
    return parse_scene(f"scene.seed={seed}\nbox.size=[1, 1]\n{PERIODIC}run.until=1\n{species}{more}")


def gaps(gas):
    """Distance of each disc to the nearest, over two radii, less 1."""
    return cKDTree(gas.position, boxsize=gas.box).query(gas.position, k=2)[0][:, 1] / (2 * gas.radius) - 1


@pytest.mark.parametrize("packing_fraction", [0.4, 0.7, 0.78])
def test_discs_reach_their_size_and_touch_nobody(packing_fraction):
    gas = make_gas(scene(packing_fraction))
    assert gas.packing_fraction == pytest.approx(packing_fraction)
    assert (gas.position >= 0).all()
    assert (gas.position < 1).all()
    assert gaps(gas).min() > 0
    again, other = make_gas(scene(packing_fraction)), make_gas(scene(packing_fraction, seed=2))
    assert np.array_equal(gas.position, again.position)
    assert not np.array_equal(gas.position, other.position)


def test_two_sizes_are_compressed_together():
    more = "[[species]]\nname='small'\ncount=40\nradius=0.02\ntemperature=1\nplacement='compressed'\n"
    gas = make_gas(scene(0.65, more=more))
    apart = gas.position[:, None] - gas.position
    apart -= np.round(apart)
    distance = np.hypot(*np.moveaxis(apart, 2, 0)) + 9 * np.eye(len(gas))
    assert (distance > gas.radius[:, None] + gas.radius).all()
    assert gas.packing_fraction == pytest.approx(0.65 + 40 * math.pi * 0.02**2)


def test_no_two_discs_overlap_on_the_way():
    """After every collision, all pairs are apart by the radii of that time; one touches."""
    rng, rate, scale, touching = np.random.default_rng(1), 0.3, 0.5, 0
    radius, box = np.full(16, 0.1), np.array((1.0, 1.0))
    now, velocity = (np.array([(x, y) for x in range(4) for y in range(4)]) + 0.5) / 4, rng.standard_normal((16, 2))
    for _ in range(12):
        discs, hits, time = _synchronised(now % 1, velocity, radius, box, 0.4), 1, 0.0
        while hits and scale + rate * time < 0.9:
            before = discs.collisions.copy()
            hits, time = _grow(discs, scale, rate, 0.1, 1.0, 1)
            now = discs.position + discs.velocity * (time - discs.time)[:, None]
            apart = now[:, None] - now
            apart -= np.round(apart)
            gap = np.hypot(*np.moveaxis(apart, 2, 0)) - 0.2 * (scale + rate * time) + 9 * np.eye(16)
            assert gap.min() > -1e-12
            for i, j in [np.flatnonzero(discs.collisions > before)] * hits:
                touching += 1
                assert gap[i, j] == pytest.approx(0, abs=1e-12)
        scale += rate * time
    assert touching > 20


def test_discs_that_jam_say_where(monkeypatch):
    monkeypatch.setattr(compression, "MAX_COLLISIONS", 20)
    with pytest.raises(
        SceneError, match=r"no room for all discs by compression \(got jammed at a packing fraction of 0.[5-7]"
    ):
        make_gas(scene(0.85))


def test_loose_discs_stay_where_they_are():
    position = np.array([[0.2, 0.2], [0.7, 0.7]])
    assert compress(position, np.array([0.1, 0.1]), (1.0, 1.0), 1 + GAP, np.random.default_rng(1)) == 1
    assert position.tolist() == [[0.2, 0.2], [0.7, 0.7]]

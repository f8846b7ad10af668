"""Discs lie in the box and apart, whatever the species, or the scene is refused."""

import math
from itertools import product

import numpy as np
from helpers.random_walls import distances
from hypothesis import given, settings
from hypothesis import strategies as st

from idealgas.columns import SIDES
from idealgas.initial.build import make_gas
from idealgas.scene import SceneError, parse_scene
from idealgas.toml.dump import toml_value
from idealgas.toml.table import SMALLEST

SIDE = 10.0


@st.composite
def scenes(draw):
    tables = []
    for k in range(draw(st.integers(1, 4))):
        radius = draw(st.floats(0.02, 0.6))
        x0, y0 = (draw(st.just(0.0) | st.floats(SMALLEST, 3)) for _ in range(2))
        region = [x0, y0, draw(st.floats(x0 + 4, SIDE)), draw(st.floats(y0 + 4, SIDE))]
        table = {
            "name": f"s{k}",
            "count": draw(st.integers(1, max(1, int(5 / radius**2 / 4)))),
            "radius": radius,
            "speed": 1,
            "placement": draw(st.sampled_from(["random", "lattice"])),
        }
        tables.append(table | ({"region": region} if draw(st.booleans()) else {}))
    discs = [{"position": [SIDE / 2, SIDE / 2], "radius": draw(st.floats(0.1, 2))}] if draw(st.booleans()) else []
    return f"box.size = [{SIDE}, {SIDE}]\nrun.until = 1\nspecies = {toml_value(tables)}\ndisc = {toml_value(discs)}"


ends = st.tuples(st.floats(0.1, 9.9), st.floats(0.1, 9.9))
walls = st.just([]) | st.lists(st.tuples(ends, ends).filter(lambda pair: math.dist(*pair) > 0.1), max_size=6)


@settings(max_examples=200)
@given(scenes(), st.integers(0, 100), walls, st.tuples(st.booleans(), st.booleans()))
def test_discs_are_clear_of_walls_and_of_all_images_of_each_other(text, seed, walls, periodic):
    """Distances are recomputed here: between all pairs, and from all images of the discs to each wall."""
    sides = [f"box.{side}=periodic" for side, on in zip(SIDES, np.repeat(periodic, 2), strict=True) if on]
    tables = [{"from": list(start), "to": list(end)} for start, end in walls]
    gas, refused = None, []
    try:
        gas = make_gas(parse_scene(f"wall = {toml_value(tables)}\n{text}", overrides=[f"scene.seed={seed}", *sides]))
    except SceneError as refusal:
        refused = refusal.errors
    assert all(any(what in error for what in ("too many discs", "no room", "overlaps wall")) for error in refused)
    if gas is None:
        return
    for axis in range(2):
        margin = 0.0 if periodic[axis] else gas.radius
        assert (gas.position[:, axis] >= margin).all()
        assert (gas.position[:, axis] <= SIDE - margin).all()
    first, second = np.triu_indices(len(gas), 1)
    apart = gas.position[first] - gas.position[second]
    reach = gas.radius[first] + gas.radius[second]
    assert ((apart**2).sum(axis=1) >= reach * reach).all()
    nearest = apart - np.where(periodic, SIDE * np.round(apart / SIDE), 0.0)
    assert (np.hypot(*nearest.T) >= reach * (1 - 1e-12)).all()
    images = [(-SIDE, 0.0, SIDE) if joined else (0.0,) for joined in periodic]
    for shift in product(*images):
        gaps = distances(gas.position + shift, np.array(walls).reshape(-1, 2, 2))
        assert (gaps >= gas.radius[:, None] * (1 - 1e-12)).all()

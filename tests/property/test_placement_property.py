"""Discs lie in the box and apart, whatever the species, or the scene is refused."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from idealgas.gas import make_gas
from idealgas.scene import SceneError, parse_scene
from idealgas.scene.dump import toml_value

SIDE = 10.0


@st.composite
def scenes(draw):
    tables = []
    for k in range(draw(st.integers(1, 4))):
        radius = draw(st.floats(0.02, 0.6))
        x0, y0 = draw(st.floats(0, 3)), draw(st.floats(0, 3))
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


@given(scenes(), st.integers(0, 100))
def test_discs_are_in_the_box_and_never_overlap(text, seed):
    gas, refused = None, []
    try:
        gas = make_gas(parse_scene(text, overrides=[f"scene.seed={seed}"]))
    except SceneError as refusal:
        refused = refusal.errors
    assert all("too many discs" in error or "no room" in error for error in refused)
    if gas is None:
        return
    radius = gas.radius[:, None]
    assert (gas.position >= radius).all()
    assert (gas.position <= SIDE - radius).all()
    order = np.triu_indices(len(gas), 1)
    dx, dy = (gas.position[order[0]] - gas.position[order[1]]).T
    reach = gas.radius[order[0]] + gas.radius[order[1]]
    assert (dx * dx + dy * dy >= reach * reach).all()

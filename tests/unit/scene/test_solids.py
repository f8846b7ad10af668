"""Closed curves of walls: their area, what is in them, and one line for each mistake."""

import math

import numpy as np
import pytest
from helpers.support import refused

from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene
from idealgas.scene.solids import enclosed

HEXAGON = [[5 + 2 * math.cos(math.pi * k / 3), 5 + 2 * math.sin(math.pi * k / 3)] for k in range(6)]
SIDES = [[HEXAGON[k], HEXAGON[(k + 1) % 6]] for k in range(6)]


def walls(solid: str, ends, via=()) -> str:
    """Tables of walls, of which some are arcs."""
    rows = []
    for k, (start, end) in enumerate(ends):
        bend = f", via = {list(via[k])}" if k < len(via) and via[k] is not None else ""
        rows.append(f'{{ solid = "{solid}", from = {list(start)}, to = {list(end)}{bend} }},\n')
    return "".join(rows)


def text_of(walls: str, rest: str) -> str:
    return f"box.size = [10, 10]\nrun.events = 10\nwall = [\n{walls}]\n{rest}\n"


def scene(walls: str, rest: str = 'species = [{ name = "gas", count = 200, radius = 0.15, speed = 1 }]'):
    return parse_scene(text_of(walls, rest))


def test_no_disc_is_in_a_polygon():
    """Of 200 discs some 10 % would be in the hexagon; its walls may run in any direction."""
    turned = [side[::-1] if k % 2 else side for k, side in enumerate(SIDES)]
    result = scene(walls("inside", turned))
    area = 6 * math.sqrt(3)  # of a hexagon of radius 2
    assert result.solids.area == pytest.approx(area, rel=1e-14)
    gas = make_gas(result)
    assert gas.area == pytest.approx(100 - area, rel=1e-14)
    assert gas.packing_fraction == pytest.approx(200 * math.pi * 0.15**2 / (100 - area), rel=1e-12)
    angle = np.arctan2(*(gas.position - 5).T[::-1]) % (math.pi / 3) - math.pi / 6
    assert (np.hypot(*(gas.position - 5).T) * np.cos(angle) > math.sqrt(3)).all()
    on_lattice = make_gas(scene(walls("inside", SIDES), LATTICE))
    assert not result.solids.contain(on_lattice.position).any()


LATTICE = 'species = [{ name = "gas", count = 300, radius = 0.15, speed = 1, placement = "lattice" }]'


def test_areas_of_arcs_and_of_nested_curves():
    """A stadium with a hole, whose other half circle bulges into it; all areas by hand."""
    stadium = walls("outside", [([3, 1], [7, 1]), ([7, 1], [7, 5]), ([7, 5], [3, 5]), ([3, 1], [3, 5])],
                    [None, [9, 3], None, [1, 3]])  # fmt: skip
    notched = walls("inside", [([4, 2], [6, 2]), ([4, 2], [4, 4]), ([4, 4], [6, 4]), ([6, 4], [6, 2])],
                    [None, [5, 3], None, None])  # fmt: skip
    result = scene(stadium + notched, "species = [{ name = 'gas', count = 100, radius = 0.1, speed = 1 }]")
    covered = 4 - math.pi / 2
    assert result.solids.area == pytest.approx(100 - 16 - 4 * math.pi + covered, rel=1e-14)
    points = np.array([[5, 4.5], [4.5, 3], [5.5, 3], [1.5, 1.5], [1.2, 3], [8.9, 3], [9.5, 3], [5, 0.5], [4.1, 2.9]])
    there = [False, False, True, True, False, False, True, True, False]
    assert result.solids.contain(points).tolist() == there
    position = make_gas(result).position
    assert not result.solids.contain(position).any()
    ring = walls("outside", [([1, 5], [1, 5]), ([3, 5], [3, 5])], [[9, 5], [7, 5]])
    assert scene(ring).solids.area == pytest.approx(100 - 16 * math.pi + 4 * math.pi, rel=1e-14)
    a, b, small, large = ([5 + 3 * math.cos(t), 5 + 3 * math.sin(t)] for t in (0.3, 2.0, 1.15, 1.15 + math.pi))
    result = scene(walls("inside", [(a, b), (b, a)], [small, large]))
    assert result.solids.area == pytest.approx(9 * math.pi, rel=1e-12)


def test_the_ray_through_a_corner():
    """Points level with corners count as all others do."""
    diamond = scene(walls("inside", [([2, 5], [5, 2]), ([5, 2], [8, 5]), ([8, 5], [5, 8]), ([5, 8], [2, 5])]))
    x = np.linspace(0.05, 9.95, 100)
    inside = enclosed(np.column_stack((x, np.full(100, 5.0))), diamond.wall)
    assert (inside == (np.abs(x - 5) < 3)).all()
    half = scene(walls("inside", [([2, 5], [8, 5]), ([8, 5], [2, 5])], [None, [5, 8]]))
    for y, width in ((5.0, None), (5.0 + 1e-9, 3.0), (8.0, 0.0), (6.5, math.sqrt(9 - 1.5**2))):
        inside = enclosed(np.column_stack((x, np.full(100, y))), half.wall)
        if width is not None:
            assert (inside == (np.abs(x - 5) < width)).all()


CROSS = [([1, 4], [9, 4]), ([9, 4], [9, 6]), ([9, 6], [1, 6]), ([1, 6], [1, 4])]
ROUND = '{{ from = [1, 5], to = [1, 5], via = [9, 5], solid = "{}" }},'
ONE = 'species = [{{ name = "gas", count = 1, radius = 0.05, speed = 1 }}]'
INSIDE = "disc = [{ position = [5, 5], radius = 0.5, velocity = [1, 0] }]"


@pytest.mark.parametrize(
    ("text", "rest", "message"),
    [
        (walls("inside", SIDES[:5]), "", 'wall.0.solid: curve not closed (got an end at [7.0, 5.0]; allowed exactly'),
        (walls("inside", SIDES) + walls("inside", CROSS), "", "curves that cross (got wall 6; allowed curves"),
        (walls("inside", SIDES), INSIDE, "disc.0.position: in a solid (got [5.0, 5.0]; allowed a position outside)"),
        (walls("inside", SIDES).replace(" }", ", opens_at = 1 }", 1), "", 'a solid that opens (got "inside" and a'),
        (ROUND.format("inside") + ROUND.format("outside"), "", "wall.0.solid: no area is left (got solids everywhere"),
        ("{ from = [1, 1], to = [3, 3], via = [2, 2] },", "", "no arc through these points (got [1.0, 1.0] via [2.0"),
        ("{ from = [1, 1], to = [3, 1], via = [2, -1] },", "", "wall not in the box (got [1.0, 1.0] via [2.0, -1.0]"),
        ("{ from = [1, 1], to = [1, 1], via = [1, 1] },", "", "no arc through these points"),
    ],
)  # fmt: skip
def test_one_line_for_each_mistake(text, rest, message):
    rest = rest or 'species = [{ name = "gas", count = 9, radius = 0.1, speed = 1 }]'
    assert message in "\n".join(refused(text_of(text, rest)))


SCATTERER = "disc = [{{ position = [{}, {}], radius = {}, fixed = true }}]\n" + ONE


@pytest.mark.parametrize(
    ("solid", "disc", "got"),
    [
        (walls("inside", SIDES), (5, 5, 0.1), "[5.0, 5.0]; allowed 0.1 or more from it)"),
        (walls("inside", SIDES), (5, 8, 1.5), "[5.0, 8.0]; allowed 1.5 or more from it)"),
        (walls("outside", SIDES), (9, 9, 0.5), "[9.0, 9.0]; allowed 0.5 or more from it)"),
        (walls("outside", SIDES), (5, 5, 2), "[5.0, 5.0]; allowed 2.0 or more from it)"),
        (walls("inside", SIDES), (5, 5 + math.sqrt(3) + 1, 1), ""),
        (walls("outside", SIDES), (5, 5, math.sqrt(3)), ""),
        ("", (5, 5, 8), "disc.0.fixed: no area is left (got fixed discs everywhere; allowed room for the gas)"),
    ],
    ids=["in it", "at its edge", "outside", "all around", "touching", "inscribed", "everywhere"],
)
def test_fixed_discs_are_apart_from_solids_and_leave_area(solid, disc, got):
    if not got:
        assert scene(solid, SCATTERER.format(*disc)).solids.area > math.pi * disc[2] ** 2
        return
    (line,) = refused(text_of(solid, SCATTERER.format(*disc)))
    assert got in line


def test_a_fixed_disc_outside_the_box_covers_nothing_of_it():
    (line,) = refused(text_of("", SCATTERER.format(20, 20, 1)))
    assert "fixed disc not in the box (got [20.0, 20.0]" in line


DISC = "{{ position = [{}, {}], radius = {}, fixed = true }},\n"
SIDES_JOINED = 'box = {size=[10, 10], left="periodic", right="periodic", bottom="periodic", top="periodic"}'
LENS = 2 * math.pi / 3 - math.sqrt(3) / 2
"""Area that two circles of radius 1 share whose centres are 1 apart."""


@pytest.mark.parametrize(
    ("discs", "joined", "covered"),
    [
        (((5, 5, 2), (2, 2, 1)), False, 5 * math.pi),
        (((4, 5, 1), (5, 5, 1)), False, 2 * math.pi - LENS),
        (((4, 4, 1), (4, 5, 1), (4, 4, 0.5)), False, 2 * math.pi - LENS),
        (((0, 5, 2), (10, 10, 2)), False, 3 * math.pi),
        (((10, 4, 1), (10, 5, 1), (5, 5, 2), (5, 6, 3)), False, 10 * math.pi - LENS / 2),
        (((0, 5, 2), (10, 10, 2)), True, 8 * math.pi),
        (((0.5, 5, 1), (9.5, 5, 1)), True, 2 * math.pi - LENS),
    ],
    ids=["apart", "overlapping", "nested", "at sides", "one in another", "at periodic sides", "overlapping across"],
)
def test_fixed_discs_leave_less_area(discs, joined, covered):
    """N, φ and A are those of the discs that move: areas by hand."""
    text = "".join(DISC.format(*each) for each in discs)
    rest = 'species = [{ name = "gas", count = 10, radius = 0.1, speed = 1 }]'
    text = f"box.size = [10, 10]\nrun.events = 10\ndisc = [\n{text}]\n{rest}\n"
    result = parse_scene(text, overrides=[SIDES_JOINED] * joined)
    gas = make_gas(result)
    assert gas.area == pytest.approx(100 - covered, rel=1e-14)
    assert gas.packing_fraction == pytest.approx(10 * math.pi * 0.01 / (100 - covered), rel=1e-12)

"""Polygonal lines: one table, the same gas as its pieces written one by one, and the user's text everywhere."""

import math
from itertools import pairwise

import numpy as np
import pytest
from helpers.support import called, logged, output_of, refused

from idealgas import load_scene, open_log, parse_scene
from idealgas.log.digest import digest
from idealgas.log.start import continued_scene
from idealgas.physics.arc_geometry import arc_through
from idealgas.scene.changes import SceneChange, changed_scene
from idealgas.scene.scene import gas_digest, run_digest
from idealgas.scene.walls import number_walls
from idealgas.sweep.plan import load_sweep
from idealgas.toml.dump import dump_document

HEXAGON = [[5 + 2 * math.cos(math.pi * k / 3), 5 + 2 * math.sin(math.pi * k / 3)] for k in range(6)]
GAS = """
scene.seed = 4
box.size = [10, 10]
species = [{{ name = "gas", count = 20, radius = 0.3, temperature = 1 }}]
run.events = 120
run.until = 20
wall = [
    {{ from = [1, 1], to = [1, 3] }},
{}]
"""
PARTITION = """
scene.seed = 4
box.size = [12, 10]
wall = [{ name = "door", points = [[6, 0], [7, 5], [6, 10]], opens_at = 3, closes_at = 5 }]
species = [{ name = "gas", count = 12, radius = 0.2, temperature = 1, region = [0, 0, 5, 10] }]
run.until = 4
"""


def table(keys: str, points=HEXAGON) -> str:
    return GAS.format(f"    {{ points = {points}, {keys} }},\n")


def singles(keys: str, points) -> str:
    rest = "".join(f", {key}" for key in keys.split(", ") if not key.startswith("closed "))
    return GAS.format("".join(f"    {{ from = {a}, to = {b}{rest} }},\n" for a, b in pairwise(points)))


CLOSED = [*HEXAGON, HEXAGON[0]]


@pytest.mark.parametrize(
    ("keys", "points", "single"),
    [
        ('solid = "inside", closed = true', HEXAGON, CLOSED),
        ("closed = true", HEXAGON, CLOSED),
        ("temperature = 2, closed = false", HEXAGON, HEXAGON),
        ("absorbing = true", HEXAGON[:2], HEXAGON[:2]),
        ("opens_at = 1.5", HEXAGON[:3], HEXAGON[:3]),
        ('permeable_to = ["gas"], permeable_from = "right"', [[5, 2], [6, 5], [5, 8]], [[5, 2], [6, 5], [5, 8]]),
    ],
)
@pytest.mark.usefixtures("uncompiled")
def test_the_same_log_as_with_its_pieces_one_by_one(tmp_path, keys, points, single):
    one_table = parse_scene(table(keys, points))
    one_by_one = parse_scene(singles(keys, single))
    assert (len(one_table.wall), len(one_table.pieces)) == (2, len(one_by_one.wall))
    assert number_walls(one_table)[5:] == [wall._replace(label="") for wall in number_walls(one_by_one)[5:]]
    assert run_digest(one_table) == run_digest(one_by_one)
    assert gas_digest(one_table) == gas_digest(one_by_one)
    assert one_table.solids.area == one_by_one.solids.area
    with logged(one_table, tmp_path / "table.h5") as log, logged(one_by_one, tmp_path / "singles.h5") as other:
        assert digest(log) == digest(other)
        assert log.walls == other.walls
        assert {-k - 1 for k in range(5, 5 + len(points))} & set(np.concatenate([b.partner for b in log.chunks()]))


def test_every_piece_has_a_name_and_the_first_one_a_label():
    scene = parse_scene(table('closed = true, name = "hexagon"'), overrides=["scene.seed=1"])
    names = [f"hexagon {k}" for k in range(6)]
    walls = number_walls(scene)
    assert [wall.name for wall in walls[4:]] == ["wall 4", *names]
    assert [wall.label for wall in walls[5:11]] == ["hexagon", *5 * [""]]
    assert [wall.label for wall in number_walls(parse_scene(table("closed = true")))[4:]] == ["wall 4", *6 * [""]]
    ends = [(wall.start, wall.end) for wall in walls[5:11]]
    assert ends == [(tuple(a), tuple(b)) for a, b in pairwise(CLOSED)]


@pytest.mark.usefixtures("uncompiled")
def test_logs_and_scenes_made_from_them_contain_the_text_of_the_user(tmp_path):
    scene, path = parse_scene(PARTITION), tmp_path / "run.h5"
    text = dump_document(scene)
    assert "points = [[6.0, 0.0], [7.0, 5.0], [6.0, 10.0]]" in text
    assert "from" not in text
    assert parse_scene(text) == scene
    with logged(scene, path) as log:
        assert log.scene == scene
        assert [wall.name for wall in log.walls[4:]] == ["door 0", "door 1"]
    with open_log(path) as log:
        assert [wall.absences for wall in log.scene.pieces] == 2 * [((3.0, 5.0),)]
        later = continued_scene(log, 3.5, str(path))
    assert "points = [[6.0, 0.0], [7.0, 5.0], [6.0, 10.0]]" in later
    (tmp_path / "next.toml").write_text(later)
    next_scene = load_scene(tmp_path / "next.toml", ["run.until=2"])
    assert [wall.absences for wall in next_scene.pieces] == 2 * [((0.0, 1.5),)]
    output_of("scene", path, "--at", 3.5, "-o", tmp_path / "written.toml")
    assert later[later.index("[[wall]]") : later.index("[run]")] in (tmp_path / "written.toml").read_text()
    opened = load_scene(tmp_path / "next.toml", ["run.until=2", "wall.door.closes_at=", "wall.door.opens_at=0.5"])
    with logged(opened, tmp_path / "next.h5") as log:
        assert "wall" not in continued_scene(log, 1.0, "next.h5").replace("[wall]", "")


@pytest.mark.usefixtures("uncompiled")
def test_a_resumed_run_is_the_same_as_a_whole_one(tmp_path):
    path = tmp_path / "run.h5"
    with logged(parse_scene(PARTITION), tmp_path / "whole.h5") as log:
        whole = digest(log)
    with logged(parse_scene(PARTITION, overrides=["run.until=2"]), path):
        pass
    assert called("resume", path, "--until", 4).returncode == 0
    with open_log(path) as log:
        assert digest(log) == whole


def test_a_change_during_a_run_concerns_all_pieces():
    scene = parse_scene(table('closed = true, name = "hexagon", temperature = 1'))
    changed = changed_scene(scene, SceneChange(2.0, "wall.hexagon.open=true"))
    assert [wall.absences for wall in changed.pieces[1:]] == 6 * [((2.0, math.inf),)]
    warmer = changed_scene(scene, SceneChange(2.0, "wall.hexagon.temperature=3"))
    assert {wall.temperature for wall in warmer.pieces[1:]} == {((0.0, 1.0), (2.0, 3.0))}


def test_set_and_sweeps_reach_the_table_and_its_points(tmp_path):
    text = table('closed = true, name = "hexagon"')
    moved = parse_scene(text, overrides=["wall.hexagon.points.2=[4, 7]", "wall.hexagon.closed="])
    assert (moved.pieces[2].end, len(moved.pieces)) == ((4.0, 7.0), 6)
    assert refused(text, "wall.hexagon.points=[[1, 1]]") == [
        "--set wall.hexagon.points=[[1, 1]]: wall.hexagon.points: too few points (got 1; allowed >= 3)"
    ]
    assert refused(text, "wall.hexagon.points.2=[5, 50]") == [
        "--set wall.hexagon.points.2=[5, 50]: wall.hexagon.points.2: point not in the box (got [5.0, 50.0]; "
        "allowed 0 <= x <= 10.0 and 0 <= y <= 10.0)"
    ]
    (tmp_path / "gas.toml").write_text(text)
    axis = 'sweep.scene = "gas.toml"\naxis = [{ key = "wall.hexagon.temperature", values = [1, 2] }]\n'
    (tmp_path / "sweep.toml").write_text(axis)
    points = load_sweep(tmp_path / "sweep.toml").points
    assert [[wall.temperature for wall in point.scene.pieces[1:]] for point in points] == [6 * [1.0], 6 * [2.0]]


@pytest.mark.parametrize(("n", "distance", "angle"), [(8, 7.7e-3, 16.3), (16, 7.9e-4, 3.19), (32, 1.12e-4, 0.462)])
def test_arcs_follow_an_ellipse_as_the_page_of_the_scenes_says(n, distance, angle):
    """The largest distance is that of points on the ellipse from the circle of their arc; semi-axes 2 and 1."""
    point = [np.array([2 * math.cos(math.pi * k / n), math.sin(math.pi * k / n)]) for k in range(2 * n + 1)]
    off, centres = [], []
    for k in range(n):
        arc = arc_through(*(tuple(p.tolist()) for p in point[2 * k : 2 * k + 3]))
        centres.append(point[2 * k] + arc[:2])
        t = math.pi * (2 * k + np.linspace(0, 2, 2001)) / n
        off.append(np.abs(np.hypot(*(np.column_stack((2 * np.cos(t), np.sin(t))) - centres[k]).T) - arc.radius).max())
    towards = [(point[2 * k] - centres[k], point[2 * k] - centres[k - 1]) for k in range(n)]
    turns = [math.asin(abs(a @ (b[1], -b[0])) / math.hypot(*a) / math.hypot(*b)) for a, b in towards]
    assert max(off) / 2 == pytest.approx(distance, rel=0.01)
    assert math.degrees(max(turns)) == pytest.approx(angle, rel=0.01)


def test_pieces_count_as_walls():
    points = [[5 + 4 * math.cos(t), 5 + 4 * math.sin(t)] for t in np.linspace(0, 6, 10_001).tolist()]
    assert refused(table("closed = true", points), "species.gas.count=1") == [
        "<scene>:7: wall: too many walls (got 10,002; allowed <= 10,000)"
    ]
    assert len(parse_scene(table("closed = false", points[:9_999])).pieces) == 9_999

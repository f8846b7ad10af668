"""Poincaré sections: points of motions in closed form, and shares of regions whose areas are known."""

import json
import math

import numpy as np
import pytest
from helpers.logs import log_of, raised

from idealgas import combine, section
from idealgas.analysis import registry
from idealgas.analysis.section import UNEQUAL, PoincareSection, SectionAnalysis, share_visited
from idealgas.analysis.section.points import POINT
from idealgas.report.picture import html_pictures
from idealgas.report.sections import make_sections

pytestmark = pytest.mark.usefixtures("uncompiled")

CIRCLE = """
box.size = [10, 10]
wall = [{ name = "rim", from = [0, 5], to = [0, 5], via = [10, 5] }]
disc = [{ position = [5, 3], velocity = [0.8, 0.6], radius = 0.5 }]
run.events = 500
"""
BOX = """
box.size = [4, 3]
disc = [{ position = [1, 1], velocity = [0.6, 0.8], radius = 0.25 }]
run.until = 100
"""


def test_a_circle():
    """The angular momentum L = 1.6 is kept: the sine is L/S, and chords advance by 2 arccos(L/S), S = 5 - 0.5."""
    points = section(log_of(CIRCLE)).points
    assert len(points) == 500
    assert points["sine"] == pytest.approx(1.6 / 4.5, abs=1e-12)
    advance = np.diff(points["position"]) % (2 * math.pi * 5)
    assert advance == pytest.approx(5 * 2 * math.acos(1.6 / 4.5), abs=1e-9)
    assert (points["side"] == 1).all()  # the circle runs counterclockwise, so that its inside is on the left
    s = 1.2 + math.sqrt(1.2**2 + 4.5**2 - 4)  # path up to the first hit, |(0.8 s, 0.6 s - 2)| = 4.5
    first = np.array([0.8 * s, 0.6 * s - 2])
    angle = (math.atan2(first[1], first[0]) - math.pi) % (2 * math.pi)  # from the start of the wall at (0, 5)
    assert points["position"][0] == pytest.approx(5 * angle, abs=1e-12)


def test_a_rectangle():
    """Components of the velocity keep their sizes; sides run from left to right and upwards, one after the other."""
    result = section(log_of(BOX))
    rows = result.rows()
    vertical, horizontal = np.isin(rows["wall"], ("left", "right")), np.isin(rows["wall"], ("bottom", "top"))
    assert np.abs(rows["sine"][vertical]) == pytest.approx(0.8, abs=1e-14)
    assert np.abs(rows["sine"][horizontal]) == pytest.approx(0.6, abs=1e-14)
    assert list(result.starts) == [0, 3, 6, 10, 14]
    # The disc reaches y = 2.75 after 1.75/0.8 and x = 3.75 after 2.75/0.6, where y = 1 + 0.8 t reflected at 2.75.
    assert (rows["wall"][0], rows["wall"][1]) == ("top", "right")
    assert rows["time"][:2] == pytest.approx([1.75 / 0.8, 2.75 / 0.6], rel=1e-14)
    assert rows["position"][0] == pytest.approx(10 + 1 + 0.6 * 1.75 / 0.8, rel=1e-14)
    assert rows["position"][1] == pytest.approx(3 + 5.5 - 1 - 0.8 * 2.75 / 0.6, rel=1e-13)
    assert rows["sine"][1] == pytest.approx(-0.8)
    assert {name: set(rows["side"][rows["wall"] == name].tolist()) for name in ("left", "right", "bottom", "top")} == {
        "left": {-1}, "right": {1}, "bottom": {1}, "top": {-1}
    }  # fmt: skip


def test_chosen_walls_are_in_the_order_of_their_names():
    result = section(log_of(BOX), walls="top, left")
    whole = section(log_of(BOX)).rows()
    assert result.lengths == {"top": 4.0, "left": 3.0}
    assert (result.rows()["wall"] == whole["wall"][np.isin(whole["wall"], ("top", "left"))]).all()
    assert result.rows()["position"][0] == pytest.approx(1 + 0.6 * 1.75 / 0.8, rel=1e-14)


def test_ends_arcs_fixed_discs_and_pieces_of_lines():
    text = """
        box.size = [10, 10]
        wall = [
            { name = "arc", from = [1, 5], to = [3, 5], via = [2, 4] },
            { name = "line", points = [[6, 1], [6, 3], [8, 3]] },
        ]
        disc = [
            { position = [2, 8], velocity = [0, -1], radius = 0.25 },
            { position = [1.125, 9], velocity = [0, -1], radius = 0.25 },
            { position = [9.75, 3.125], velocity = [-1, 0], radius = 0.25 },
            { position = [7, 8], velocity = [0, -1], radius = 0.25 },
            { position = [4, 2], velocity = [1, 0], radius = 0.25 },
            { position = [7, 5], radius = 0.5, fixed = true },
        ]
        run.until = 6
    """
    result = section(log_of(text), walls="arc, line, fixed disc 5")
    assert [*result.lengths] == ["arc", "line 0", "line 1", "fixed disc 5"]
    assert [*result.lengths.values()] == pytest.approx([math.pi, 2, 2, math.pi])
    points = {int(row["disc"]): row for row in result.points[::-1]}  # the first hit of each disc
    below, end, corner, scatterer, side = (points[k] for k in range(5))
    assert below["position"] == pytest.approx(math.pi / 2, abs=1e-14)  # the lowest point of the half circle
    assert (below["sine"], below["side"]) == (pytest.approx(0, abs=1e-14), 1)
    assert end["position"] == 0.0  # the first end of the arc, at (1, 5)
    # The normal at the end is (0.5, √0.75); the velocity (0, -1) becomes (2 √0.75/2, -1 + 2 · 0.75).
    assert end["sine"] == pytest.approx(-0.5, abs=1e-14)  # along the tangent of the arc there, (0, -1)
    assert corner["position"] == 2.0  # the second end of line 1, at (8, 3)
    assert scatterer["position"] == pytest.approx(0.5 * math.pi / 2)  # the top of the fixed disc
    assert side["position"] == pytest.approx(1.0)
    assert (side["side"], side["sine"]) == (1, pytest.approx(0, abs=1e-15))


@pytest.mark.parametrize(("first", "last"), [([1, 5], [3, 5]), ([3, 5], [1, 5])])
def test_arcs_in_both_directions(first, last):
    """A disc falls into a half circle at x = 2.4, where its centre is 0.75 from that of the arc, (2, 5)."""
    wall = f'wall = [{{ name = "arc", from = {first}, to = {last}, via = [2, 4] }}]'
    disc = "disc = [{ position = [2.4, 8], velocity = [0, -1], radius = 0.25 }]"
    log = log_of(f"box.size = [10, 10]\n{wall}\n{disc}\nrun.until = 6")
    point, angle = section(log, walls="arc").points[0], math.acos(0.4 / 0.75)  # below +x
    assert point["position"] == pytest.approx(angle if first == [3, 5] else math.pi - angle, abs=1e-14)
    # The tangent is (-sin, -cos) of the angle from (3, 5) on, and along it the velocity (0, -1) is kept.
    assert point["sine"] == pytest.approx(math.cos(angle) * (1 if first == [3, 5] else -1), abs=1e-14)
    assert point["side"] == (-1 if first == [3, 5] else 1)


def test_walls_across_periodic_sides():
    """A disc that touches the fixed disc through the right side, at the angle 0 - π/4 from +x."""
    text = """
        box = { size = [8, 8], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic" }
        disc = [
            { position = [0.5, 1], radius = 0.75, fixed = true },
            { position = [4, 5], velocity = [1, 1], radius = 0.25 },
        ]
        run.until = 6
    """
    point = section(log_of(text)).points[0]
    # Along y = x + 1 the disc passes (7.5, 8.5) = (-0.5, 0.5) at the distance 1/2 √2 from the centre (0.5, 1).
    contact = np.array([-0.5, 0.5]) - (0.5, 1.0)
    along = contact @ np.array([1, 1]) / math.sqrt(2)
    across = contact - along * np.array([1, 1]) / math.sqrt(2)
    place = across - math.sqrt(1 - across @ across) * np.array([1, 1]) / math.sqrt(2)
    assert point["position"] == pytest.approx(0.75 * (math.atan2(place[1], place[0]) % (2 * math.pi)), abs=1e-13)


def test_crossings_of_a_line_in_straight_flight():
    """Along y = 1.5 the disc flies up and down: times and places of a triangle wave."""
    result = section(log_of(BOX), line="0,1.5,4,1.5")
    period = 2 * 2.5 / 0.8
    up, down = 0.5 / 0.8 + period * np.arange(16), (1.75 + 1.25) / 0.8 + period * np.arange(16)
    times = np.sort([*up, *down])
    times = times[times < 100]
    assert result.points["time"] == pytest.approx(times, rel=1e-13)
    x = np.abs((0.75 + 0.6 * times + 3.5) % 7 - 3.5) + 0.25
    assert result.points["position"] == pytest.approx(x, abs=1e-12)
    assert result.points["side"].tolist() == [1 if k % 2 == 0 else -1 for k in range(len(times))]
    assert np.abs(result.points["sine"]) == pytest.approx(0.6)
    assert section(log_of(BOX), line="4,1.5,0,1.5").points["side"].tolist() == (-result.points["side"]).tolist()


@pytest.mark.parametrize(("acceleration", "line"), [((0, -0.5), "0,1,4,2"), ((0.3, -0.4), "0.5,0,3,3")])
def test_crossings_of_a_line_under_gravity(acceleration, line):
    """All roots of the quadratic equation for each flight, by an independent routine."""
    log = log_of(BOX, f"gravity.acceleration={list(acceleration)}", "run.until=150")
    x0, y0, x1, y1 = map(float, line.split(","))
    length = math.hypot(x1 - x0, y1 - y0)
    tx, ty = (x1 - x0) / length, (y1 - y0) / length
    expected = []
    for flights in log.flights():
        for k in range(len(flights.disc)):
            (px, py), (vx, vy), (gx, gy) = flights.position[k], flights.velocity[k], acceleration
            quadratic = [(tx * gy - ty * gx) / 2, tx * vy - ty * vx, tx * (py - y0) - ty * (px - x0)]
            for t in np.roots(quadratic):
                if abs(t.imag) < 1e-12 and 0 < t.real <= flights.end[k] - flights.start[k]:
                    t = float(t.real)
                    u = tx * (px + vx * t + gx * t * t / 2 - x0) + ty * (py + vy * t + gy * t * t / 2 - y0)
                    wx, wy = vx + gx * t, vy + gy * t
                    if 0 <= u <= length:
                        turn = 1 if tx * wy - ty * wx > 0 else -1
                        expected.append((flights.start[k] + t, u, (tx * wx + ty * wy) / math.hypot(wx, wy), turn))
    expected = np.array(sorted(expected))
    result = section(log, line=line)
    assert len(expected) > 30
    ends = np.concatenate([flights.end for flights in log.flights()])
    assert 2 in np.bincount(ends.searchsorted(expected[:, 0]))  # some flights cross twice
    for name, column in zip(("time", "position", "sine", "side"), expected.T, strict=True):
        assert result.points[name] == pytest.approx(column, abs=1e-10), name
    assert UNEQUAL in result.caveats


def test_crossings_of_the_images_of_a_line():
    """A disc that crosses the sides of a periodic box crosses each image of a line within it."""
    text = """
        box = { size = [2, 3], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic" }
        disc = [{ position = [0.5, 0.5], velocity = [1, 0.75], radius = 0.1 }]
        run.until = 40
    """
    points = section(log_of(text), line="1,0,1,3").points
    assert points["time"] == pytest.approx(0.5 + 2 * np.arange(20))
    assert points["position"] == pytest.approx((0.5 + 0.75 * (0.5 + 2 * np.arange(20))) % 3, abs=1e-12)
    assert points["sine"] == pytest.approx(0.6)
    short = section(log_of(text), line="1,0.5,1,1.5").points
    assert len(short) == (points["position"] < 1.5).sum() == 10


def test_trajectories_that_have_no_points():
    """Of three discs that fly along x or y, two never hit the top and one never crosses a short line."""
    discs = ", ".join(
        f"{{ position = [{x}, {y}], velocity = [{vx}, {vy}], radius = 0.1 }}"
        for x, y, vx, vy in ((1, 1, 1, 0), (1, 2, -1, 0), (3, 3, 0, 1))
    )
    log = log_of(f"box.size = [4, 4]\ndisc = [{discs}]\ninteractions.discs = false\nrun.until = 20")
    result = section(log, walls="top")
    assert result.never.value == pytest.approx(2 / 3)
    assert result.never.standard_error == pytest.approx(math.sqrt(3 * 2 / 5**2 / 6))  # of the beta distribution (3, 2)
    assert "trajectories that never hit these walls" in str(result)
    assert section(log, line="2,0,2,4").never.value == pytest.approx(1 / 3)
    assert section(log).never is None


def test_several_logs_are_one_section():
    logs = [log_of(BOX), log_of(BOX, "disc.0.velocity=[0.8, 0.6]")]
    results = [section(log) for log in logs]
    both = combine(results)
    assert both.discs == (1, 1)
    assert len(both.points) == sum(len(result.points) for result in results)
    for k, result in enumerate(results):
        own = both.points[both.points["log"] == k]
        assert (own["trajectory"] == k).all()
        assert (own["position"] == result.points["position"]).all()
        assert (result.points["log"] == 0).all()  # not changed
    assert "points" not in json.loads(json.dumps(both.as_dict()))
    other = section(log_of(BOX.replace("[4, 3]", "[4, 5]")))
    raised("different walls", combine, [results[0], other])
    lines = [section(log, line=line) for log, line in zip(logs, ("3,0,3,2", "0,1,2,1"), strict=True)]  # of one length
    raised("different walls", combine, lines)


def test_what_is_refused():
    log = log_of(BOX)
    raised('unknown reflecting wall, did you mean "left"', section, log, walls="lft")
    joined = log_of(BOX, 'box.bottom="periodic"', 'box.top="periodic"')
    raised("allowed left, right", section, joined, walls="top")
    raised("walls and line cannot be combined", section, log, walls="left", line="0,0,1,1")
    for line in ("0,0,1", "a,b,c,d", "1,1,1,1", "0,0,inf,1", ""):
        raised("line: not a line", section, log, line=line)
    hole = BOX + 'wall = [{ name = "hole", from = [3, 1], to = [3, 2], absorbing = true }]\n'
    raised("unknown reflecting wall", section, log_of(hole.replace("run", "\nrun")), walls="hole")
    stored = SectionAnalysis.restored(section(log).as_dict(), section(log).origin)
    assert str(stored) == str(section(log))
    raised("results of a sweep contain no points", stored.rows)
    other = section(log_of(BOX, "disc.0.velocity=[0.8, 0.6]"))
    raised("results of a sweep contain no points", combine, [stored, other])
    raised("given twice", combine, [section(log), section(log)])


def test_a_report_contains_it_only_if_the_scene_asks_for_it(monkeypatch):
    monkeypatch.setattr(registry, "analyses", lambda: (SectionAnalysis,))
    assert make_sections(log_of(BOX)) == []
    (shown,) = make_sections(log_of(BOX, 'scene.shows=["section"]'))
    assert (shown.title, shown.left_out) == ("Poincaré section", None)
    assert shown.words == "49 points from 1 trajectory. Theory is not available."
    assert len(html_pictures(shown.picture, shown.caption, "p")) < 30_000


def test_a_figure_of_many_points_is_thinned_by_trajectories():
    points = np.zeros(100_000, POINT)
    points["trajectory"] = points["disc"] = np.arange(100_000) % 1000
    points["position"], points["sine"] = np.random.default_rng(1).uniform(-1, 1, (2, 100_000))
    figure = PoincareSection(
        "hit walls", {"a": 1.0}, {"a": 100_000}, np.array([0.0, 1.0]), (1000,), None, (), None, points
    )
    drawn = [line.get_xdata() for line in figure.figure().axes[0].lines]
    assert sum(map(len, drawn)) == 20_000
    assert np.isin(points["position"], np.concatenate(drawn)).reshape(100, 1000).sum(axis=0).max() == 100
    assert len(html_pictures(figure.figure(), "", "p")) < 400_000
    points["trajectory"] = points["disc"] = 999  # all others are never at a wall
    assert sum(len(line.get_xdata()) for line in figure.figure().axes[0].lines) == 20_000


def region(kind, points, rng):
    """Uniform points in a set of area 0.37."""
    x, y = rng.random((2, 12 * points))
    if kind == "disc":
        inside = (x - rng.uniform(0.45, 0.55)) ** 2 + (y - rng.uniform(0.45, 0.55)) ** 2 < 0.37 / math.pi
    elif kind == "stripes":
        low = rng.uniform(0.2, 0.3)
        inside = (y > low) & (y < low + 0.37)
    else:  # outside of |sine| < 0.63, as in a mushroom
        inside = np.abs(2 * y - 1) > 0.63
    return x[inside][:points], y[inside][:points]


def test_shares_of_regions_of_known_area():
    """Deviations from the area have an rms of one standard error; 45 of them tell it to 11 %."""
    rng = np.random.default_rng(7)
    kinds = ("disc", "stripes", "mushroom")
    runs = [share_visited(*region(kind, 8_000, rng)) for kind in kinds for _ in range(15)]
    deviations = np.array([(run.value - 0.37) / run.standard_error for run in runs])
    assert 0.7 < np.sqrt((deviations**2).mean()) < 1.4
    assert np.mean([run.standard_error for run in runs]) < 0.0015


def test_shares_of_curves_of_the_whole_and_of_few_points():
    rng = np.random.default_rng(8)
    whole = share_visited(*rng.random((2, 5_000)))
    assert whole.value == pytest.approx(1, abs=3 * whole.standard_error)
    assert whole.standard_error < 0.002
    curve = share_visited(rng.random(5_000), np.full(5_000, 0.7))
    assert curve.value == pytest.approx(0, abs=3 * curve.standard_error)
    assert curve.standard_error < 0.005
    assert share_visited(*rng.random((2, 511))) is None

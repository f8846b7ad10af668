"""Arcs: stadium and round box against exact results."""

import math
import tomllib

import numpy as np
import pytest
from helpers.logs import log_of, streamed
from helpers.support import ROOT
from scipy.stats import qmc

from idealgas import Scene, evolution, open_log, section, simulate
from idealgas.analysis.section import share_visited
from idealgas.columns import Kind
from idealgas.tallies.walls import WallImpulses


def test_chords_of_a_round_box():
    """A disc keeps its angular momentum L: all chords take 2 √(S² v² - L²)/v², S the radius less its own."""
    text = """
        box.size = [10, 10]
        wall = [{ from = [0, 5], to = [0, 5], via = [10, 5] }]
        disc = [{ position = [5, 3], velocity = [0.8, 0.6], radius = 0.5 }]
        run.events = 2000
    """
    log = log_of(text)
    (rows,) = log.chunks()
    momentum = (rows.position - 5)[:, 0] * rows.velocity[:, 1] - (rows.position - 5)[:, 1] * rows.velocity[:, 0]
    assert momentum == pytest.approx(1.6, abs=1e-12)
    assert np.diff(rows.time) == pytest.approx(2 * math.sqrt(4.5**2 - 1.6**2), abs=1e-11)
    assert (rows.kind == Kind.WALL).all()
    assert (rows.partner == -5).all()
    impulses = streamed(log, np.array([rows.time[0], rows.time[-1]]), WallImpulses(log))
    push = impulses.faces[0, 4] / (rows.time[-1] - rows.time[0])
    normal = 1 / 4.5  # v² less L²/S², over S: twice the normal velocity in the time of a chord
    assert push == pytest.approx(np.array([[normal, 0], [0, 0]]), abs=1e-12)


def test_the_section_of_a_round_box():
    """The sine of the angle of reflection is L/(v S), with S = 4.5, to 1e-12 over 10 000 hits."""
    text = """
        box.size = [10, 10]
        wall = [{ from = [0, 5], to = [0, 5], via = [10, 5] }]
        disc = [{ position = [5, 3], velocity = [0.8, 0.6], radius = 0.5 }]
        run.events = 10_000
    """
    points = section(log_of(text)).points
    assert len(points) == 10_000
    assert np.abs(points["sine"] - 1.6 / 4.5).max() < 1e-12
    advance = np.diff(points["position"]) % (2 * math.pi * 5)
    assert advance == pytest.approx(5 * 2 * math.acos(1.6 / 4.5), abs=1e-11)


@pytest.mark.slow
def test_the_two_kinds_of_motion_in_the_mushroom():
    """Discs in the cap whose paths pass its centre at p > r never hit the stem and keep |sine| = p/R > 1/2; others
    never reach 1/2, and almost all of them enter the stem. The centres reach the brims only within the radius 1e-8 of
    a disc, so that p may change by twice as much at every hit."""
    log = log_of("mushroom", "species.starts.count=1000", "run.until=200")
    (x, y), (vx, vy) = (log.discs.position - (2.5, 2)).T, log.discs.velocity.T
    momentum = np.abs(x * vy - y * vx)
    regular = (y > 0) & (momentum > 1)
    stem, cap = section(log, walls="stem"), section(log, walls="cap").points
    entered = np.isin(np.arange(1000), stem.points["disc"])
    assert not (entered & regular).any()
    assert (~entered & ~regular).sum() < 10
    assert stem.never.value == (~entered).mean()
    share = (4 * math.acos(1 / 2) - math.sqrt(3)) / (2 * math.pi + 3)
    assert share == pytest.approx(0.26464, abs=1e-5)
    assert abs(regular.mean() - share) < 4 * math.sqrt(share * (1 - share) / 1000)
    sine, disc = np.abs(cap["sine"]), cap["disc"]
    assert sine[~regular[disc]].max() < 0.5
    assert np.abs(sine - momentum[disc] / 2)[regular[disc]].max() < 2e-8 * 200


@pytest.mark.slow
def test_the_regular_share_of_the_mushroom_to_half_a_percent(tmp_path):
    """Of 10 000 starts at scrambled Sobol points of the mushroom and of the directions, the share that never leaves the
    cap differs from the share by geometry by 0.5 % or less (rms of eight scrambles). The mouth of the stem absorbs
    discs, so that only those that are regular, or enter the stem after t = 1000, are followed to the end."""
    share = (4 * math.acos(1 / 2) - math.sqrt(3)) / (2 * math.pi + 3)
    document = tomllib.loads((ROOT / "configs" / "mushroom.toml").read_text(encoding="utf-8"))
    mouth = {"name": "mouth", "from": [1.5, 2], "to": [3.5, 2], "absorbing": True}
    tables = {"box": document["box"], "wall": [*document["wall"], mouth], "interactions": {"discs": False}}
    deviations = []
    for seed in range(8):
        x, y, turn = qmc.Sobol(3, seed=seed).random(2**15).T
        x, y = 4 * x - 2, 3.5 * y - 1.5
        cap = (y > 1e-6) & (np.hypot(x, y) < 2 - 1e-6)
        chosen = np.flatnonzero(cap | ((y < -1e-6) & (y > 1e-6 - 1.5) & (np.abs(x) < 1 - 1e-6)))[:10_000]
        angle, position = 2 * math.pi * turn[chosen], np.column_stack((x, y))[chosen] + (2.5, 2)
        velocity = np.column_stack((np.cos(angle), np.sin(angle)))
        discs = {"position": position, "velocity": velocity, "radius": np.full(10_000, 1e-8)}
        simulate(Scene(discs=discs, run={"until": 1000}, **tables), tmp_path / "starts.h5", force=True)
        with open_log(tmp_path / "starts.h5") as log:
            deviations.append((cap[chosen] & log.state_at(1000).inside).mean() / share - 1)
    assert np.sqrt(np.mean(np.square(deviations))) < 0.005


@pytest.mark.slow
def test_the_chaotic_share_of_the_section_of_the_mushroom():
    """Regular are |sine| > r/R on the cap and |sine| < √(1 - r²/ρ²) on the brims, at ρ from the centre of the cap. Each
    start has only some hits up to t = 10, so that the points are nearly independent."""
    log, radius, width, height = log_of("mushroom", "run.until=10"), 2.0, 1.0, 1.5
    result = section(log)
    (x, y), (vx, vy) = (log.discs.position - (2.5, 2)).T, log.discs.velocity.T
    chaotic = ((y < 0) | (np.abs(x * vy - y * vx) < width))[result.points["disc"]]
    length = math.pi * radius + 2 * (radius - width) + 2 * height + 2 * width
    assert result.starts[-1] == pytest.approx(length)
    brims = 4 * (math.sqrt(radius**2 - width**2) - width * math.acos(width / radius))
    regular = (2 * math.pi * (radius - width) + brims) / (2 * length)
    position, sine = (result.rows()[name][chaotic] for name in ("position", "sine"))
    share = share_visited(position / length, (1 + sine) / 2)
    assert abs(share.value - (1 - regular)) < 4 * share.standard_error
    assert share.standard_error < 0.001


@pytest.fixture(scope="module")
def stadium():
    return log_of("stadium")


def test_the_mean_time_between_hits_of_the_stadium(stadium):
    """π A/(v P) of the region of the centre (Chernov, J. Stat. Phys. 88, 1 (1997)); within 3 s.e. of 100 discs."""
    radius = 2 - 1e-6
    area, perimeter = math.pi * radius**2 + 8 * radius, 2 * math.pi * radius + 8
    assert math.pi * area / perimeter == pytest.approx(4.3636, abs=5e-5)
    disc, kind = (np.concatenate([getattr(b, name) for b in stadium.chunks()]) for name in ("disc", "kind"))
    rate = np.bincount(disc[kind != Kind.DISC], minlength=100) / stadium.end_time  # the speed is 1
    error = rate.std(ddof=1) / 10
    assert abs(rate.mean() - perimeter / (math.pi * area)) < 3 * error
    assert error < 0.01 * rate.mean()


def test_the_stadium_is_filled(stadium):
    """No disc is outside of it, and A is that of the stadium; discs start everywhere in it alike."""
    area = 4 * math.pi + 16
    assert stadium.discs.area == pytest.approx(area, rel=1e-14)
    for state in (stadium.discs, stadium.state_at(stadium.end_time)):
        x, y = np.abs(state.position - (4.5, 2.5)).T
        assert (np.hypot(np.maximum(x - 2, 0), y) < 2).all()
    x = np.abs(stadium.discs.position[:, 0] - 4.5)
    assert abs((x < 2).mean() - 16 / area) < 3 * math.sqrt(16 / area * (1 - 16 / area) / 100)


def test_the_pressure_in_a_stadium_is_that_of_its_own_walls(stadium):
    """No disc reaches the sides of the box: the picture has the four walls inside."""
    result = evolution(stadium)
    assert result.pressure.shown == ("wall 4, up", "wall 5, inside", "wall 6, down", "wall 7, inside")

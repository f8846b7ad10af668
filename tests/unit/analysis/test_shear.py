"""Shear flow: a single disc, whose motion relative to the flow is known, and integrals along flights."""

import math

import numpy as np
import pytest
from helpers.logs import log_of
from scipy.integrate import quad

from idealgas import Scene
from idealgas.analysis.shear import _caveats, _product, shear
from idealgas.columns import SIDES
from idealgas.log.start import continued_scene

pytestmark = [pytest.mark.interpreted, pytest.mark.usefixtures("uncompiled")]

SCENE = """
box = { size = [8, 4], left = "periodic", right = "periodic", bottom = { shear = 0.5 }, top = { shear = 0.5 } }
run.until = 40
disc = [
    { position = [2, 2], velocity = [0.25, 1], radius = 0.01, mass = 3 },
    { position = [6.6, 2], velocity = [0.25, -1], radius = 0.01, mass = 3 },
]
"""


def test_two_discs_that_the_flow_leaves_behind():
    """c = (-t/2, 1) and (t/2, -1): integrals of 3 c c over blocks, over the area 32; they do not meet.

    Their common motion along x, ¼, lasts and is no heat.
    """
    log = log_of(SCENE)
    result = shear(log, start=9.0, end=33.0)
    assert log.summary["disc_collisions"] == 0
    edges = result.window.edges
    width = edges[1] - edges[0]
    xx, yy = np.diff(edges**3 / 2) / width, 6.0
    xy = 3 * np.diff(-(edges**2) / 2) / width
    temperatures, viscosities = (xx + yy) / 4, -xy / 32 / 0.5
    assert result.temperatures == pytest.approx(temperatures, rel=1e-10)
    assert result.viscosities == pytest.approx(viscosities, rel=1e-10)
    t = temperatures.mean()
    assert result.temperature.value == pytest.approx(t, rel=1e-10)
    reduced = (viscosities / np.sqrt(temperatures)).mean()
    assert result.viscosity.value == pytest.approx(reduced * math.sqrt(t), rel=1e-10)
    assert result.pressure.value == pytest.approx(2 * t / 32, rel=1e-10)  # P A = N T
    assert result.normal_stress.value == pytest.approx((xx - yy).mean() / (2 * t), rel=1e-9)
    assert (result.rate, result.reduced_rate, result.window.first) == (0.5, math.inf, 0)
    assert result.y == pytest.approx(np.arange(0.1, 4, 0.2))
    assert result.viscosity.theory is None
    assert [sentence.split(" of ")[0] for sentence in result.caveats] == [
        f"The temperature changes from {temperatures[:8].mean():.4g} to {temperatures[-8:].mean():.4g} in the window, "
        "as shear heats the gas: the viscosity is that at the mean temperature, as it is proportional to √T.",
        "The shear rate is inf",
    ]


GAS = """
box = {{ size = [9, 7], left = "periodic", right = "periodic", bottom = {{ shear = 0.3 }}, top = {{ shear = 0.3 }} }}
run.until = 6
species = [{{ name = "gas", count = 8, radius = 0.4, placement = "lattice", velocities = {} }}]
"""


@pytest.mark.parametrize("motion", [(0.0, 1.7), (2.5, 0.0), (2.5, -3.1)])
def test_a_common_motion_changes_nothing_else(motion):
    """The images move in the same way, so that the gas has the same collisions, and its flow moves with it."""
    velocities = np.random.default_rng(1).normal(size=(8, 2))
    results = []
    for common in ((0.0, 0.0), motion):
        log = log_of(GAS.format((velocities + common).tolist()))
        assert log.counts["disc_collisions"] == 5
        results.append(shear(log, start=0.0, end=5.5))
    rest, moving = results
    assert moving.temperatures == pytest.approx(rest.temperatures, rel=1e-9)
    assert moving.viscosities == pytest.approx(rest.viscosities, rel=1e-9)
    assert moving.pressure.value == pytest.approx(rest.pressure.value, rel=1e-9)
    assert moving.normal_stress.value == pytest.approx(rest.normal_stress.value, rel=1e-9)


def test_slope_and_profile_of_a_flow_that_moves_with_the_gas():
    """The two discs, on their way up at ¾ in addition: at height h from the middle v - w t/2 = c + h/2."""
    log = log_of(SCENE.replace("0.25, 1]", "0.5, 1.75]").replace("0.25, -1]", "0, -0.25]"))
    result = shear(log, start=9.0, end=33.0)

    def motion(time):
        h = np.remainder(np.multiply.outer([1.75, -0.25], time) + 2, 4) - 2
        return h, 0.25 * np.array([[1], [-1]]) + np.multiply.outer([-0.5, 0.5], time)

    h, c = motion(np.linspace(9, 33, 2_000_001)[:-1] + 6e-6)
    assert result.slope.value == pytest.approx(1 + (h * c).mean() / (0.5 * (h**2).mean()), abs=1e-5)
    h, c = motion(np.linspace(9, 33, 200))
    strip = ((h + 2) * 5).astype(int).ravel()
    expected = np.bincount(strip, (c + h / 2).ravel(), 20) / np.bincount(strip, minlength=20)
    assert result.velocity == pytest.approx(expected, abs=1e-12)


CROSSING = """
box = { size = [8, 8], left = "periodic", right = "periodic", bottom = { shear = 0.5 }, top = { shear = 0.5 } }
run.until = 60
disc = [
    { position = [2, 6], velocity = [1, -3], radius = 0.5 },
    { position = [6, 4.5], velocity = [0.5, 2], radius = 0.5 },
]
"""


def test_states_at_the_times_of_events_are_those_after_them():
    """Also that of a disc that leaves through the bottom: it is at the top then, and as fast as discs are there."""
    log = log_of(CROSSING)
    (rows,) = log.chunks()
    down = np.flatnonzero(rows.partner == -1 - SIDES.index("bottom"))
    assert len(down) > 10
    assert (rows.partner == -1 - SIDES.index("top")).sum() > 10
    for k, i in enumerate(rows.disc):
        state = log.state_at(rows.time[k])
        assert np.array_equal(state.position[i], rows.position[k])
        assert np.array_equal(state.velocity[i], rows.velocity[k])
    edges = rows.time[down]
    pieces = list(log.flights(edges, columns=("disc", "start", "position", "velocity")))
    at = {(f.disc[k], f.start[k]): (*f.position[k], *f.velocity[k]) for f in pieces for k in range(len(f.disc))}
    for k in down[:-1]:
        assert at[rows.disc[k], rows.time[k]] == (*rows.position[k], *rows.velocity[k])
    time = rows.time[down[3]]
    now, later = (shear(log, start=start, end=25.0).temperatures for start in (time, time + 1e-9))
    assert now == pytest.approx(later, rel=1e-6)


def test_a_start_at_the_time_of_a_crossing():
    """At t = 2 the images are above each other, and a disc has just left through the bottom: the motion goes on."""
    log = log_of(CROSSING)
    (rows,) = log.chunks()
    assert log.state_at(2.0).position[0, 1] == 8.0
    following = log_of(continued_scene(log, 2.0, str(log.path)))
    assert following.scene.explicit_discs.position[0].tolist() == [4, 0]
    assert following.scene.explicit_discs.velocity[0].tolist() == [1, -3]  # 5 at the top
    (later,) = following.chunks()
    rows = rows._make(column if column is None else column[rows.time >= 2] for column in rows)
    assert later.partner[:20].tolist() == rows.partner[:20].tolist()
    assert later.time[:20] + 2 == pytest.approx(rows.time[:20], abs=1e-9)
    assert later.velocity[:20] == pytest.approx(rows.velocity[:20], abs=1e-9)


@pytest.mark.parametrize("images", [-3, -1, 0, 1, 2])
def test_a_disc_that_is_given_beyond_sheared_sides_has_the_velocity_of_its_image(images):
    """Image k of a disc is 8 k above it and faster by 4 k."""
    discs = {"position": [[2, 6 + 8 * images]], "velocity": [[1 + 4 * images, -3]], "radius": 0.5}
    side = {"shear": 0.5}
    box = {"size": (8.0, 8.0), "left": "periodic", "right": "periodic", "bottom": side, "top": side}
    scene = Scene(box=box, run={"until": 10.0}, discs=discs)
    assert (scene.explicit_discs.position.tolist(), scene.explicit_discs.velocity.tolist()) == ([[2, 6]], [[1, -3]])


def test_integrals_along_a_flight():
    a, da, b, db, t = 0.7, -1.3, 2.1, 0.4, 1.7
    expected = quad(lambda s: (a + da * s) * (b + db * s), 0, t, epsabs=1e-14)[0]
    assert _product(*map(np.float64, (a, da, b, db, t))) == pytest.approx(expected, rel=1e-13)


def test_caveats():
    steady, warmer = np.full(8, 2.0), np.array([1.0, 1.0, 1, 1, 1, 1, 1.2, 1.2])
    assert _caveats(steady, False, 0.05, True) == ()
    assert len(_caveats(warmer, False, 0.05, True)) == 1
    assert len(_caveats(steady, False, 0.2, True)) == 1

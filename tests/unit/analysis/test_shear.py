"""Shear flow: a single disc, whose motion relative to the flow is known, and integrals along flights."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from idealgas import parse_scene, simulate
from idealgas.analysis.shear import _caveats, _product, shear
from idealgas.errors import NotApplicableError
from idealgas.log import open_log

pytestmark = [pytest.mark.interpreted, pytest.mark.usefixtures("uncompiled")]

SCENE = """
box = { size = [8, 4], left = "periodic", right = "periodic", bottom = { shear = 0.5 }, top = { shear = 0.5 } }
run.until = 40
disc = [
    { position = [2, 2], velocity = [0.25, 1], radius = 0.01, mass = 3 },
    { position = [6.6, 2], velocity = [0.25, -1], radius = 0.01, mass = 3 },
]
"""


def test_two_discs_that_the_flow_leaves_behind(tmp_path):
    """c = (¼ - t/2, 1) and (¼ + t/2, -1): integrals of 3 c c over blocks, over the area 32; they do not meet."""
    simulate(parse_scene(SCENE), tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        found = shear(log, start=9.0, end=33.0)
        assert log.summary["disc_collisions"] == 0
    edges = found.window.edges
    width = edges[1] - edges[0]
    up, down = (0.25 - edges / 2) ** 3 / -1.5, (0.25 + edges / 2) ** 3 / 1.5
    xx, yy = 3 * np.diff(up + down) / width, 6.0
    xy = 3 * np.diff(-(edges**2) / 2) / width
    temperatures, viscosities = (xx + yy) / 4, -xy / 32 / 0.5
    assert found.temperatures == pytest.approx(temperatures, rel=1e-10)
    assert found.viscosities == pytest.approx(viscosities, rel=1e-10)
    t = temperatures.mean()
    assert found.temperature.value == pytest.approx(t, rel=1e-10)
    reduced = (viscosities / np.sqrt(temperatures)).mean()
    assert found.viscosity.value == pytest.approx(reduced * math.sqrt(t), rel=1e-10)
    assert found.pressure.value == pytest.approx(2 * t / 32, rel=1e-10)  # P A = N T
    assert found.normal_stress.value == pytest.approx((xx - yy).mean() / (2 * t), rel=1e-9)
    assert (found.rate, found.reduced_rate, found.window.first) == (0.5, math.inf, 0)
    assert found.y == pytest.approx(np.arange(0.1, 4, 0.2))
    assert found.viscosity.theory is None
    assert [sentence.split(" of ")[0] for sentence in found.caveats] == [
        f"The temperature changes from {temperatures[:8].mean():.4g} to {temperatures[-8:].mean():.4g} in the window, "
        "as shear heats the gas: the viscosity is that at the mean temperature, as it is proportional to √T.",
        "The shear rate is inf",
    ]


def test_there_is_none_without_sheared_sides(tmp_path):
    plain = SCENE.replace(", bottom = { shear = 0.5 }, top = { shear = 0.5 }", "")
    simulate(parse_scene(plain), tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log, pytest.raises(NotApplicableError, match="requires sheared sides"):
        shear(log)


def test_integrals_along_a_flight():
    a, da, b, db, t = 0.7, -1.3, 2.1, 0.4, 1.7
    expected = quad(lambda s: (a + da * s) * (b + db * s), 0, t, epsabs=1e-14)[0]
    assert _product(*map(np.float64, (a, da, b, db, t))) == pytest.approx(expected, rel=1e-13)


def test_caveats():
    steady, warmer = np.full(8, 2.0), np.array([1.0, 1.0, 1, 1, 1, 1, 1.2, 1.2])
    assert _caveats(steady, False, 0.05, True) == ()
    assert len(_caveats(warmer, False, 0.05, True)) == 1
    assert len(_caveats(steady, False, 0.2, True)) == 1

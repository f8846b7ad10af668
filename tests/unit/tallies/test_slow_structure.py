"""A gas whose structure relaxes more slowly than its log can show says so; `calibration.csv` has the errors of each."""

import math

import pytest
from helpers.logs import log_of, species
from helpers.support import ROOT

from idealgas import analyse
from idealgas.analysis.caveats import window_caveats
from idealgas.columns import SIDES
from idealgas.tallies.equilibration import Window
from idealgas.tallies.exchange import INDEPENDENT, Exchange


def equal(number, phi):
    return species("gas", number, math.sqrt(phi / (number * math.pi)))


def mixture(number, phi):
    """Half of the discs 1.6 times as large and three times as heavy as the others."""
    radius = math.sqrt(2 * phi / (number * math.pi * (1 + 1.6**2)))
    return species("light", number // 2, radius) + species("heavy", number // 2, 1.6 * radius, mass=3)


PERIODIC = "".join(f'{side} = "periodic"\n' for side in SIDES)
WALLS = "".join(f"{side} = {{ thermal = 1 }}\n" for side in SIDES)
GRAVITY = "[gravity]\nacceleration = [0, -2]\n"
LOSSES = "[restitution]\nnormal = 0.9\n"

SLOW = {  # rms of deviations over errors of collision rates: 2.6, 2.2, 2.1, 1.4, 1.7, 1.3
    "20 discs, 0.45": (mixture(20, 0.45), 300),
    "40 discs, 0.45": (mixture(40, 0.45), 300),
    "100 discs, 0.45": (mixture(100, 0.45), 300),
    "20 discs, 0.3": (mixture(20, 0.3), 300),
    "40 discs, 0.3": (mixture(40, 0.3), 300),
    "30 equal discs, 0.6": (equal(30, 0.6), 300),
    "40 discs, 0.45, long": (mixture(40, 0.45), 2000),  # 1.5
    "20 discs, 0.3, long": (mixture(20, 0.3), 2000),  # 1.1
    "40 discs, 0.3, long": (mixture(40, 0.3), 2000),
    "30 equal discs, 0.6, long": (equal(30, 0.6), 2000),
    # 1.2 of the pressure
    "40 discs between thermal walls": (WALLS + equal(40, 0.2), 300),
    "40 grains between thermal walls": (WALLS + equal(40, 0.2) + LOSSES, 300),
    "40 discs under gravity": (equal(40, 0.2) + GRAVITY, 300),
}
FAST = {  # 1.0
    "20 discs, 0.05": (mixture(20, 0.05), 300),
    "50 equal discs, 0.2": (equal(50, 0.2), 300),
    "64 equal discs, 0.3, periodic": (PERIODIC + equal(64, 0.3), 300),
    "40 discs between thermal walls, long": (WALLS + equal(40, 0.2), 2000),
    "40 grains between thermal walls, long": (WALLS + equal(40, 0.2) + LOSSES, 2000),
    "40 discs under gravity, long": (equal(40, 0.2) + GRAVITY, 2000),
}


@pytest.mark.parametrize("name", [*SLOW, *FAST])
@pytest.mark.parametrize("start", [None, pytest.param(0.5, marks=pytest.mark.slow)])
def test_slow_structure_is_said(name, start):
    discs, collisions = (SLOW | FAST)[name]
    log = log_of(f"scene.seed = 1\n[box]\nsize = [1, 1]\n{discs}[run]\ncollisions_per_disc = {collisions}\n")
    actual = [analyse(log, analysis, start=start) for analysis in ("pressure", "histogram")]
    for result in actual:
        said = [sentence for sentence in result.caveats if "relaxes slowly" in sentence]
        assert bool(said) == (name in SLOW)
        assert all(f"in t = {result.window.slowest.time:.2g}" in sentence for sentence in said)


def test_window_of_many_relaxation_times_needs_no_caveat():
    edges = [0.0, 100.0]
    assert window_caveats(Window(edges, 0, True, slowest=Exchange(2.3, "heat crosses the gas"))) == ()
    (said,) = window_caveats(Window(edges, 0, True, slowest=Exchange(10.0, "heat crosses the gas")))
    assert "heat crosses the gas in t = 10, and the window is only 10 times as long" in said
    assert f"the window is {INDEPENDENT:g} times as long" in said
    assert f"{INDEPENDENT:g} times as long" in (ROOT / "idealgas" / "analysis" / "README.md").read_text()

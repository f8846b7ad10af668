"""A piston between two gases: exact hits; equilibrium and relaxation against theory."""

import math

import numpy as np
import pytest
from helpers.against_theory import agrees, of_runs
from helpers.logs import log_of, raised
from helpers.support import ROOT
from scipy import integrate

from idealgas import evolution, pressure
from idealgas.analysis import registry
from idealgas.columns import Kind
from idealgas.statistics.estimates import estimate, mean
from idealgas.theory.adiabatic_piston import heat_flow, relaxation

ADIABATIC = ROOT / "configs" / "adiabatic-piston.toml"
HANDS = """
box.size = [10, 2]
piston = [{{ inner = "x", position = 4, mass = {mass} {velocity} }}]
disc = [
    {{ position = [2, 1], velocity = [2, 0], radius = 0.5 }},
    {{ position = [8, 1], velocity = [-1, 0], radius = 0.5 }},
]
run.events = 2
log.pressure = true
"""


@pytest.mark.usefixtures("uncompiled")
def test_hits_by_hand():
    """Of equal masses, velocities are exchanged: the piston takes on 2 at t = 3/4, meets the other disc at t = 5/3."""
    log = log_of(HANDS.format(mass=1, velocity=""))
    (rows,) = log.chunks()
    assert rows.time.tolist() == pytest.approx([0.75, 0.75 + (7.5 - 0.75 - 4) / 3], rel=1e-14)
    assert rows.position[:, 0].tolist() == pytest.approx([3.5, 8 - 0.75 - 2.75 / 3], rel=1e-14)
    assert rows.velocity.tolist() == [[0, 0], [2, 0]]
    assert (rows.kind.tolist(), rows.partner.tolist()) == ([Kind.PISTON] * 2, [-5, -5])
    assert (log.walls[4].name, log.walls[4].start, log.walls[4].end) == ("piston", (4, 0), (4, 2))
    observed = {name: values[-1] for name, (_, values) in log.observables.items()}
    assert observed["face_hits"].tolist() == [0, 0, 0, 0, 1, 1]
    assert observed["face_normal_impulse"].tolist() == pytest.approx([0, 0, 0, 0, 2, 3], abs=1e-14)
    assert observed["wall_energy"].tolist() == pytest.approx([0, 0, 0, 0, -2 + 1.5], abs=1e-14)
    assert observed["piston_velocity"] == -1


@pytest.mark.usefixtures("uncompiled")
def test_it_is_reflected_at_a_side():
    """In an empty part of the box the piston goes on to its end and comes back."""
    alone = HANDS.format(mass=1e6, velocity=", velocity = -1").replace("events = 2", "until = 7").splitlines()
    log = log_of("\n".join(line for line in alone if "[2, 1]" not in line))
    assert log.observables["piston_position"][1][-1] == pytest.approx(3, abs=1e-4)
    assert log.observables["piston_velocity"][1][-1] == pytest.approx(1, abs=1e-4)


def test_what_an_analysis_tells():
    """Pressure on both faces, over the area of both gases; temperatures of each; no heat capacity."""
    log = log_of(ADIABATIC, "run.until=60")
    result, mechanical = evolution(log, 20.0), pressure(log, 20.0).mechanical
    assert {"piston, left", "piston, right"} <= {wall.name for wall in mechanical.walls}
    assert result.pressure.shown == ("piston, left", "piston, right")
    assert result.pressure.area[0] == 200
    left, right = (wall.pressure for wall in mechanical.walls if wall.name.startswith("piston"))
    assert left.value - right.value == pytest.approx(0, abs=4 * math.hypot(left.standard_error, right.standard_error))
    assert result.chambers.keys() == {"left", "right"}
    assert result.temperature == pytest.approx((result.chambers["left"] + 2 * result.chambers["right"]) / 3)
    assert evolution(log).chambers["left"][0] == pytest.approx(3)
    assert evolution(log).law.chambers == {}  # the pressures differ at the start
    assert result.law.chambers["left"][0] == result.chambers["left"][0]
    assert result.law.piston == pytest.approx(0.1 + 19.8 * 101 / 302)
    raised(
        "the heat capacity requires at most one piston, with gas on one side of it",
        registry.analyse,
        log,
        "heat_capacity",
    )


def test_the_heat_flow_is_that_of_single_hits():
    """Twice integrated over velocities of disc and piston, both with Maxwell's distribution: energy of all hits."""
    m, mass, hot, cold, force = 1.0, 4.0, 1.5, 0.7, 2.0
    of_left, of_right = heat_flow(np.array([hot, cold]), force, m, mass)
    assert of_left == pytest.approx(-of_right, rel=1e-9)

    def given(t, of_piston):
        def hits(piston, disc):
            weight = math.exp(-m * disc**2 / (2 * t) - mass * piston**2 / (2 * of_piston))
            weight *= math.sqrt(m * mass / (t * of_piston)) / (2 * math.pi)
            after = disc - 2 * mass / (m + mass) * (disc - piston)
            return force / t * (disc - piston) * weight * m * (after**2 - disc**2) / 2

        return integrate.dblquad(hits, -12, 12, -6, lambda disc: disc)[0]

    low, high = cold, hot
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (low, middle) if given(hot, middle) + given(cold, middle) > 0 else (middle, high)
    assert of_left == pytest.approx(given(hot, low), rel=1e-5)


def test_relaxation_keeps_the_energy():
    time = np.linspace(0, 4000, 101)
    t = relaxation(np.array([2.0, 1.0]), np.array([100, 200]), 1.0, 20.0, 1.0, 20.0, time)
    assert np.array([100, 200]) @ t == pytest.approx(400, rel=1e-12)
    assert t[:, -1] == pytest.approx(4 / 3, rel=1e-3)


GASES = """
scene.seed = {seed}
box.size = [20, 10]
piston = [{{ inner = "x", mass = {mass} {position} }}]
species = [
    {{ name = "a", count = {a}, radius = {radius}, temperature = {hot}, region = [0, 0, {place}, 10] }},
    {{ name = "b", count = {b}, radius = {radius}, temperature = {cold}, region = [{place}, 0, 20, 10] }},
]
log.events = false
log.snapshot_every = {every}
run.until = {until}
"""


@pytest.mark.slow
def test_equilibrium():
    """At fixed energy the place has the weight X^a (L - X)^b, the piston's energy a Beta law of 1/2 and N.

    L is what is left to centres: 20 - 4 R. For Beta(1/2, N) the mean is 1/(2N + 1).
    """
    log = log_of(
        GASES.format(
            seed=2, mass=1.5, position="", a=3, b=5, radius=0.02, hot=1, cold=1, place=10, every=20, until=60_000
        )
    )
    place = (log.observables["piston_position"][1][5:, 0] - 0.04) / (20 - 0.08)
    agrees(mean(place, 4 / 10), 0.03)
    centred = place - 0.4
    agrees(estimate(lambda s, square: square - s**2, centred, centred**2, theory=0.4 * 0.6 / 11), 0.1)
    energy = 0.75 * log.observables["piston_velocity"][1][5:, 0] ** 2
    agrees(mean(energy / 8, 1 / 17), 0.05)


@pytest.mark.slow
@pytest.mark.parametrize("mass", [8, pytest.param(30, marks=pytest.mark.long)])
def test_relaxation(mass):
    """Temperatures of two gases of equal pressure against the law of single hits, in the mean of runs.

    200 and 400 discs at temperatures 2 and 1, so that the piston begins in the middle. Difference of the temperatures
    after a quarter, a half and about the whole of the time in which a small one falls to 1/e.
    """
    tau = 9.6 * mass
    times, runs = np.array([0.25, 0.5, 1.0]) * tau, []
    for seed in range(1, 13):
        text = GASES.format(
            seed=seed, mass=mass, position="", a=200, b=400, radius=0.04, hot=2, cold=1, place=10, every=tau / 2,
            until=1.01 * tau,
        )  # fmt: skip
        result = evolution(log_of(text.replace("log.events = false", "")))
        runs.append(np.interp(times, result.time, result.chambers["left"] - result.chambers["right"]))
    law = result.law.chambers["left"] - result.law.chambers["right"]
    for k, time in enumerate(times):
        agrees(of_runs(np.array(runs)[:, k], np.interp(time, result.time, law)), 0.12)


@pytest.mark.slow
def test_szilard():
    """The work of a slow expansion is T ln (L - 2R)/(L/2 - 2R), in the mean of runs; their spread is 0.04."""
    works = []
    for seed in range(100, 124):
        faster = "piston.velocity=0.000244140625", "run.until=4096", "log.events=false"
        log = log_of("szilard", f"scene.seed={seed}", *faster)
        assert abs(log.summary["energy_drift"]) < 1e-12
        works.append(-log.observables["wall_energy"][1][-1][4])
    agrees(of_runs(works, math.log((2 - 0.002) / (1 - 0.002))), 0.02)

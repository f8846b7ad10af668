"""Mechanical pressure against what must hold without an equation of state: balances of forces, and exact ideal gases.

The seeds are fixed. Every comparison is within STANDARD_ERRORS of the estimate's own, which must be small enough that
the comparison can fail. Discs of radius 0.001 to 0.02 are nearly points; what their size adds is said where it counts.
"""

import math

import numpy as np
import pytest
from helpers.against_theory import LEAST_P, STANDARD_ERRORS
from helpers.logs import log_of

from idealgas import evolution, histogram
from idealgas.analysis.pressure.measure import pressure
from idealgas.tallies.equilibration import measure

SCENE = "scene.seed = 11\nbox.size = [10, 10]\nrun.until = 1"


def run_with(*overrides):
    return log_of(SCENE, *overrides)


def species(count, radius, more=""):
    return f'species=[{{ name = "gas", count = {count}, radius = {radius}, temperature = 1{more} }}]'


def walls(result):
    return {wall.name: wall.pressure for wall in result.mechanical.walls}


def agrees(result, expected, resolution):
    """Whether an estimate is what is expected, and its error bar at most a part `resolution` of that."""
    assert result.standard_error < resolution * abs(expected)
    return abs(result.value - expected) < STANDARD_ERRORS * result.standard_error


def test_between_walls_of_one_temperature():
    """P on each wall is N T Z/A with A the area that centres reach, within 4 s.e. of 3 %."""
    sides = "box={ size = [10, 10], " + ", ".join(
        f"{s} = {{ thermal = 1.5 }}" for s in ("left", "right", "bottom", "top")
    )
    log = run_with(sides + " }", species(100, 0.02), "run.until=1200")
    result = pressure(log)
    assert result.temperature == 1.5
    z = 1 + 2 * math.pi * 0.02**2  # B2 of 100 discs in 100
    for route in result.routes[:4]:
        assert agrees(route.pressure, 100 * 1.5 * z / (10 * 9.96), 0.03), route.name


def test_the_floor_carries_the_column():
    """P_bottom - P_top = N m g/L, and left and right are alike: momentum balance, whatever the density profile."""
    log = run_with("box.size=[10, 15]", species(200, 0.1), "gravity.acceleration=[0, -0.3]", "run.until=1500")
    result = pressure(log)
    measured, forces = walls(result), result.mechanical.forces[-1]
    below, above = measured["bottom wall"], measured["top wall"]
    difference, error = below.value - above.value, math.hypot(below.standard_error, above.standard_error)
    assert error < 0.02 * 6
    assert abs(difference - 200 * 0.3 / 10) < STANDARD_ERRORS * error
    assert above.value > 10 * above.standard_error  # the lid counts
    assert forces.y.theory == pytest.approx(-60)
    assert agrees(forces.y, -60, 0.002)
    assert abs(forces.x.deviation) < STANDARD_ERRORS
    assert agrees(measured["left wall"], measured["right wall"].value, 0.03)


def test_a_piston_is_held_by_the_gas():
    """Its mean force is P L, and in a dilute gas the walls beside it have N/(N + 1) of its pressure.

    The force on them is N T/L, whatever the area, and the mean area at the pressure P is (N + 1) T/P.
    """
    log = run_with(
        "box.size=[40, 10]", species(100, 0.02), "run.until=8000", "piston=[{ position = 10, mass = 5, pressure = 1 }]"
    )
    result = walls(pressure(log))
    assert result["right wall"].theory == 1.0
    assert agrees(result["right wall"], 1.0, 0.001)  # its momentum is bounded, so that its mean force is exact in time
    assert agrees(result["bottom wall"], 100 / 101, 0.03)
    assert agrees(result["top wall"], 100 / 101, 0.03)
    assert agrees(result["left wall"], 1.0, 0.003)  # it takes what the piston does not, and both are held together


def test_a_gas_of_unknown_temperature_forgets_its_start():
    """It cools from 1 to what the floor gives and losses take; the force on all walls is its weight from then on."""
    log = run_with(
        "box={ size = [10, 10], bottom = { thermal = 1 } }",
        species(60, 0.3),
        "gravity.acceleration=[0, -0.3]",
        "restitution={ normal = 0.95, wall = 0.9 }",
        "run.until=200",
    )
    window = measure(log, [])
    assert 10 < window.start < 100  # energy has a correlation time of two to four
    force = pressure(log).mechanical.forces[-1].y
    assert agrees(force, -18, 0.01)


def test_a_plate_in_a_gas_has_its_pressure_on_both_faces():
    """A plate in an ideal gas: N T/A on each face, with A the area that centres reach; no net force."""
    log = run_with("wall=[{ from = [3, 4], to = [6, 8], name = 'plate' }]", species(400, 0.002), "run.until=1000")
    result = pressure(log)
    measured = walls(result)
    assert set(measured) > {"plate, left", "plate, right"}
    for name in ("plate, left", "plate, right", "left wall", "top wall"):
        assert agrees(measured[name], 4.0 / 0.9996**2, 0.03), name
    plate = next(force for force in result.mechanical.forces if force.name == "plate")
    for component in (plate.x, plate.y):
        assert component.standard_error < 0.05 * 20  # of the force on one face
        assert abs(component.value) < STANDARD_ERRORS * component.standard_error


def test_a_gate_counts_while_it_is_there():
    """Gas on the left alone: the gate has N T/A of that side while it is there, and nothing on its right."""
    gate = "wall=[{ from = [5, 0], to = [5, 10], opens_at = 200, name = 'gate' }]"
    log = run_with(gate, species(200, 0.002, ", region = [0, 0, 5, 10]"), "run.until=260")
    result = walls(pressure(log, start=10.0))
    assert agrees(result["gate, left"], 4.0 / (0.9996 * 0.9992), 0.03)
    assert result["gate, right"].value == 0.0


@pytest.mark.slow
def test_heat_flows_but_forces_balance():
    """Between walls of two temperatures the steady gas presses alike on both."""
    sides = "left = { thermal = 2 }, right = { thermal = 1 }, top = 'periodic', bottom = 'periodic'"
    log = run_with(f"box={{ size = [10, 10], {sides} }}", species(200, 0.05), "run.until=1500")
    result = pressure(log, start=50.0)
    measured = walls(result)
    assert set(measured) == {"left wall", "right wall"}
    assert measured["left wall"].standard_error < 0.02 * measured["left wall"].value
    assert abs(result.mechanical.forces[-1].x.deviation) < STANDARD_ERRORS


def test_a_slow_compression_follows_the_adiabat():
    """P(A) of 200 nearly pointlike discs: N T₀ A₀/A² within 4 s.e. in 95 % of 64 bins, and chi² within its 4 s.d.

    The error of a bin has some five degrees of freedom; Student's t is then beyond 4 in 1 % of all bins, and 5 % are
    four standard deviations more.
    """
    log = run_with("box.size=[20, 10]", species(200, 0.02), "piston=[{ velocity = -0.0125 }]", "run.until=800")
    course = evolution(log).pressure
    assert course.shown == ("right wall",)
    p, error = course.pressure["right wall"], course.error["right wall"]
    assert course.area[0] == pytest.approx(200 - 0.125 * 800 / len(p) / 2, rel=1e-12)
    assert course.lines.adiabat == pytest.approx(200 * 200 / course.lines.area**2, rel=0.02)  # 2 φ and walls: 1.5 %
    expected = np.interp(course.area, course.lines.area, course.lines.adiabat)
    off = (p - expected) / error
    assert np.median(error / p) < 0.1
    assert (np.abs(off) < STANDARD_ERRORS).mean() > 0.95
    assert (off**2).mean() < 1 + 4 * math.sqrt(2 / len(off))
    isotherm = np.interp(course.area, course.lines.area, course.lines.isotherm)
    assert (((p - isotherm) / error)[-8:] > 4).all()


@pytest.mark.parametrize(
    ("overrides", "wall"),
    [
        (("run.until=700",), "all sides"),
        (("box.size=[40, 10]", "piston=[{ position = 10, mass = 5, pressure = 1 }]", "run.until=700"), "right wall"),
    ],
    ids=["box", "piston"],
)
def test_error_bars_of_bins(overrides, wall):
    """Bins of a stationary gas scatter about their mean by their error bars: rms 0.8 to 1.2 of 64 bins.

    By chance alone the rms of 64 bins is within 1 ± 0.09 (one s.d.). On a piston bins are anticorrelated, as its
    momentum is bounded, and the error bars 6 % too large.
    """
    course = evolution(run_with(species(100, 0.02), *overrides)).pressure
    p, error = course.pressure[wall], course.error[wall]
    assert len(p) == 64
    some = slice(8, None)  # from equilibrium on
    weighted = np.average(p[some], weights=error[some] ** -2)
    assert 0.8 < math.sqrt((((p[some] - weighted) / error[some]) ** 2).mean()) < 1.2


@pytest.mark.parametrize("quantity", ["speed", "vx", "vy", "energy"])
def test_maxwell_holds_at_all_heights(quantity):
    """Under gravity velocities follow Maxwell and Boltzmann's law: Kolmogorov-Smirnov, p > 0.001."""
    log = run_with("box.size=[10, 30]", species(400, 0.05), "gravity.acceleration=[0, -0.2]", "run.until=150")
    (gas,) = histogram(log, quantity, start=30.0).distributions
    assert gas.samples >= 250  # independent, as all discs share a temperature that fluctuates
    assert [test.p_value > LEAST_P for test in gas.tests] == [True]


@pytest.mark.slow
def test_a_cooling_gas_has_no_law_and_would_fail_one():
    """What would be tested: speeds of the whole cooling are not Maxwell's at any one temperature."""
    log = run_with(species(200, 0.1), "restitution.normal=0.9", "run.until=60")
    result = histogram(log)
    assert "loses energy" in result.no_law
    speeds = result.distributions[0]
    middle = (speeds.edges[1:] + speeds.edges[:-1]) / 2
    weight = speeds.density * np.diff(speeds.edges)
    kurtosis = (weight * middle**4).sum() / (weight * middle**2).sum() ** 2
    assert kurtosis > 2.5  # 2 by Maxwell and Boltzmann

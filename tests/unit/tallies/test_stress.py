"""Pressure tensor in strips: sums by hand and of the whole gas, mechanical equilibrium, gravity and shear."""

import numpy as np
import pytest
from helpers.logs import PERIODIC, gas, log_of, streamed

from idealgas import profile, shear
from idealgas.analysis.pressure.measure import pressure
from idealgas.tallies.currents import PASSED_ON, XX, XY, YY, Currents
from idealgas.tallies.stream import stream
from idealgas.tallies.stress import PassedOn

GAS = gas(60, 0.4, (12, 8), "collisions_per_disc = 300", seed=4)

STANDARD_ERRORS = 4


def far(estimates, expected):
    """Largest deviation in standard errors."""
    return max(
        abs(e.value - x) / e.standard_error
        for e, x in zip(estimates, np.broadcast_to(expected, len(estimates)), strict=True)
    )


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("bins", [1, 3, 200])
@pytest.mark.parametrize("sides", [PERIODIC, ()], ids=["periodic", "walls"])
def test_strips_together_have_what_collisions_pass_on(make, axis, bins, sides):
    log = make(*sides)
    times, size = np.linspace(0, log.end_time, 5), log.box[axis]
    reach = 0.0 if sides else 0.4
    passed_on = PassedOn(axis, np.linspace(reach, size - reach, bins + 1), log.periodic)
    currents = Currents(log.periodic)
    stream(log, times, [passed_on, currents])
    whole = currents.flow[:, PASSED_ON]
    result = passed_on.stress.sum(axis=1)
    assert result == pytest.approx(np.stack((whole[:, XX], whole[:, YY], whole[:, XY]), axis=1), abs=1e-9)
    assert (np.abs(passed_on.stress[:, :, :2]).sum(axis=(0, 2)) > 0).all()


def test_a_line_of_centres_is_shared_by_its_strips():
    """Discs of radius 1 meet head-on at x = 5.5 and 7.5, each with Δp = 2: the strips between 4 and 10 share 2 · 2."""
    discs = ", ".join(f"{{ position = [{x}, 3], velocity = [{u}, 0], radius = 1 }}" for x, u in ((3.5, 1), (9.5, -1)))
    log = log_of(f"box.size = [14, 6]\ndisc = [{discs}]\nrun.until = 3")
    passed_on = streamed(log, np.array([0.0, 3.0]), PassedOn(0, np.array([1.0, 4.0, 7.0, 10.0, 13.0]), (False, False)))
    assert passed_on.stress[0, :, 0] == pytest.approx([0, 3, 1, 0])
    across = streamed(log, np.array([0.0, 3.0]), PassedOn(1, np.array([1.0, 3.5, 5.0]), (False, False)))
    assert across.stress[0, :, 0] == pytest.approx([4, 0])
    assert across.stress[0, :, 1:] == pytest.approx(0)


def test_a_periodic_gas_has_one_pressure(make):
    """That of the virial, everywhere and in both directions; 4 standard errors of 24 strips."""
    log = make(*PERIODIC, "run.collisions_per_disc=600")
    result, (route, *_) = profile(log, "y", bins=8).pressure, pressure(log).routes
    assert max(e.standard_error for e in result["yy"]) < 0.1 * route.pressure.value
    assert far(result["xx"], route.pressure.value) < STANDARD_ERRORS
    assert far(result["yy"], route.pressure.value) < STANDARD_ERRORS
    assert far(result["xy"], 0.0) < STANDARD_ERRORS


def test_walls_hold_the_gas_in_every_strip(make):
    """The component along the axis is the force on the sides across it, over their length, in layers at walls too.

    That across is smaller, as Σ m y v_y stays bounded: strips have no momentum flow within a radius of the other sides.
    Their carried part is from frames, in which the 60 discs have Σ m v_y² = 60 ± √120.
    """
    log = make("run.collisions_per_disc=600")
    strips, routes = profile(log, "x", bins=12), {r.name: r for r in pressure(log).routes}
    result = strips.pressure
    left = routes["left wall"].pressure
    assert max(e.standard_error for e in result["xx"]) < 0.1 * left.value
    assert far(result["xx"], left.value) < STANDARD_ERRORS
    assert far(result["xy"], 0.0) < STANDARD_ERRORS
    bottom = routes["bottom wall"].pressure.times(12 / 11.2 * 7.2 / 8)
    error = np.hypot(bottom.standard_error, np.sqrt(120 / strips.frames) / (11.2 * 8))
    assert abs(np.mean([e.value for e in result["yy"]]) - bottom.value) < STANDARD_ERRORS * error


def test_under_gravity_the_pressure_carries_the_weight_above(make):
    """dP_yy/dy = -m g n: means of two strips differ by the weight, of which each height counts by a triangle.

    Densities are from strips a sixteenth as wide; their errors add up as if they were the same everywhere.
    """
    log = make("gravity={ acceleration = [0, -0.2] }", "run.collisions_per_disc=1000")
    result, (fine,) = profile(log, bins=8), profile(log, bins=128).species
    assert result.axis == "y"
    pressures, width = result.pressure["yy"], float(result.edges[1] - result.edges[0])
    triangle = 1 - np.abs((np.arange(32) + 0.5) / 16 - 1)
    for k in range(7):
        some, (low, high) = fine.density[16 * k : 16 * k + 32], pressures[k : k + 2]
        weight, off = (
            0.2 * width / 16 * triangle @ [getattr(e, name) for e in some] for name in ("value", "standard_error")
        )
        error = np.sqrt(low.standard_error**2 + high.standard_error**2 + off**2)
        assert abs(low.value - high.value - weight) < STANDARD_ERRORS * error
    assert pressures[0].value - pressures[-1].value > 8 * pressures[0].standard_error


@pytest.mark.slow
def test_a_sheared_gas_has_one_stress():
    """P_xy is that of the analysis `shear` in every strip, P_xx and P_yy too."""
    log = log_of("shear", "run.until=200")
    whole, result = shear(log, start=20.0), profile(log, bins=6, start=20.0)
    assert (result.axis, result.law) == ("y", None)
    assert "up to 1.4 times too small" in result.caveats[-1]
    assert far(result.pressure["xy"], -whole.viscosity.value * whole.rate) < STANDARD_ERRORS
    assert max(e.value + 3 * e.standard_error for e in result.pressure["xy"]) < 0
    for name in ("xx", "yy"):
        assert far(result.pressure[name], whole.pressure.value) < STANDARD_ERRORS
    (gas,) = result.species
    assert far(gas.temperature, whole.temperature.value) < STANDARD_ERRORS

"""Flow along thermal sides by theory: a parabola with slip."""

import math

import numpy as np
import pytest

from idealgas.analysis.profile.flow import LAW, expected_flow
from idealgas.analysis.profile.strips import collect
from idealgas.theory import enskog, hard_discs

pytestmark = [pytest.mark.interpreted, pytest.mark.usefixtures("uncompiled")]

GAS = """
box = { size = [20, 41], left = "periodic", right = "periodic", bottom = { thermal = 2 }, top = { thermal = 2 } }
gravity.acceleration = [0.001, 0]
species = [{ name = "gas", count = 200, radius = 0.5, mass = 3, temperature = 2, placement = "lattice" }]
run.events = 1
"""


def test_a_parabola_with_slip(make):
    """u = ρg/2η (y (H - y) + sH), H = 40 between centres; s = 1.016 ℓ, ℓ = 1.022 · 2/√π free paths."""
    edges = np.linspace(0, 41, 4101)
    result = expected_flow(make(), 1, edges)
    density = 200 / (20 * 40)
    phi = density * math.pi / 4
    chi = hard_discs.fluid_contact_value(phi)
    viscosity = enskog.viscosity(1.0, density, 2.0, 3.0, chi)
    slip = 1.016 * 1.022 * 2 / math.sqrt(math.pi) * hard_discs.mean_free_path(1.0, density, phi)
    y = np.array([0.005, 10.005, 20.005])  # middles of strips
    expected = 3 * density * 0.001 / (2 * viscosity) * (y * (40 - y) + slip * 40)
    velocity = np.array([each.value for each in result.velocity])
    assert velocity[[50, 1050, 2050]] == pytest.approx(expected, rel=1e-5)
    assert velocity[::-1] == pytest.approx(velocity, rel=1e-9)
    assert result.relaxation == pytest.approx(1600 / math.pi**2 * 3 * density / viscosity, rel=1e-12)
    assert {each.source for each in result.velocity} == {LAW}
    assert 0.02 < result.velocity[2050].error / velocity[2050] < 0.1


def test_energy_and_stress_of_strips_are_relative_to_their_flow(make):
    log = make()
    times = np.array([0.0, log.end_time])
    sums, carried, _ = collect(log, 1, 0, times, np.linspace(0, 41, 5), None)
    states = list(log.frames(times))
    for k in range(4):
        velocity = np.concatenate([state.velocity[state.position[:, 1] // 10.25 == k] for state in states])
        x, y = (velocity - [velocity[:, 0].mean(), 0]).T
        assert abs(velocity[:, 0].mean()) > 0.01
        assert sums[:, 0, k, 1].sum() == pytest.approx(1.5 * (x @ x + y @ y), rel=1e-12)
        assert carried[:, k].sum(axis=0) == pytest.approx([3 * x @ x, 3 * y @ y, 3 * x @ y], rel=1e-10)
    sheared = "box={ size=[20, 41], left='periodic', right='periodic', bottom={ shear=0.1 }, top={ shear=0.1 } }"
    log = make(sheared, "gravity=")
    sums, _, _ = collect(log, 1, None, np.zeros(1), np.linspace(0, 41, 5), None)
    height = log.discs.position[:, 1]
    velocity = log.discs.velocity - [[0.1, 0]] * (height[:, None] - 20.5)
    velocity -= velocity.mean(axis=0)
    expected = [1.5 * (velocity[height // 10.25 == k] ** 2).sum() for k in range(4)]
    assert sums[0, 0, :, 1] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    "override",
    [
        "gravity.acceleration=[0.001, -0.1]",
        "gravity.acceleration=[0, 0.1]",
        "box.top={ thermal = 3 }",
        "box.top=reflecting",
        "species.gas.count=4",
        "restitution={ normal = 0.9, contact_duration = 0.01 }",
    ],
)
def test_where_it_is_not_known(make, override):
    """Across the sides too, of two temperatures, without heat, of a thin gas, with losses."""
    assert expected_flow(make(override), 1, np.linspace(0, 41, 5)) is None

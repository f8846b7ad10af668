"""The course in time: temperatures, gates and accounts against states and samples, and the laws beside them."""

import json
import math
import shutil
import tracemalloc

import numpy as np
import pytest
from helpers.crafted import craft
from helpers.logs import PERIODIC, gas

from idealgas import evolution, open_log
from idealgas.analysis.evolution import MOST_SAMPLES
from idealgas.analysis.evolution.pressure_series import STATES
from idealgas.columns import SIDES
from idealgas.log.hdf5.commit import Commit

GAS = gas(40, 0.1, (12, 8), "until = 20", temperature=1.5, seed=3)


def test_temperatures_are_those_of_the_states(make):
    log = make("rotation={ inertia = 0.4 }")
    result = evolution(log, 2.0, 10.0)
    assert (result.time[0], result.time[-1]) == (2.0, 10.0)
    state = log.state_at(result.time[100])
    assert result.temperature[100] == pytest.approx((state.velocity**2).sum() / 2 / 40)
    assert result.spin[100] == pytest.approx(0.4 * 0.01 * (state.angular_velocity**2).mean())
    assert result.law.temperature[0] == pytest.approx(1.0)
    assert json.dumps(result.as_dict(), allow_nan=False)


def test_without_events_it_has_the_samples(make):
    log = make("log.events=false", "rotation.inertia=0.4")
    result = evolution(log)
    assert result.time.tolist() == result.samples.tolist()
    assert result.temperature == pytest.approx(result.parts["motion"] / 40)
    assert np.abs(result.balance).max() < 1e-12
    assert result.spin == pytest.approx(result.parts["spin"] * 2 / 40)
    assert result.pressure is None


def test_more_gases_than_colours(make):
    """Eight inner pistons, with a disc before each and a gas beyond the last."""
    pistons = [f'{{ inner = "x", name = "{name}", position = {k}, mass = 9 }}' for k, name in enumerate("abcdefg", 2)]
    inside = [f"{{ position = [{k + 1.5}, 4], velocity = [0.1, 0], radius = 0.1 }}" for k in range(8)]
    last = '{ inner = "x", position = 9, mass = 9 }'
    discs = (f"disc=[{', '.join(inside)}]", "species.0.region=[9, 0, 12, 8]")
    result = evolution(make(f"piston=[{', '.join([*pistons, last])}]", *discs))
    assert [*result.pistons] == [*(f"{name} piston" for name in "abcdefg"), "piston"]
    assert [*result.chambers][-2:] == ["between g piston and piston", "right"]
    lines = result.figure().axes[0].lines
    looks = {(line.get_color(), line.get_linestyle()) for line in lines}
    assert len(lines) == len(looks) == 1 + len(result.chambers)
    assert lines[1].get_label() == "left of the pistons"


@pytest.mark.slow
def test_of_very_many_samples_some_are_read(make, tmp_path):
    """A small log may have millions of equal samples, as they are compressed; all at once would need much memory."""
    path, number = shutil.copyfile(make("box.left={thermal=1.5}").path, tmp_path / "many.h5"), 16 * MOST_SAMPLES + 1

    def multiply(file):
        for name in (name for name in Commit.read(file).tails if name.startswith("observables/")):
            column = file[name]
            last = {"time": np.linspace(0, 20, number), "step": np.arange(number)}.get(name.split("/")[-1], column[0])
            column.resize(number, axis=0)
            column[:] = last

    craft(path, multiply, {"observables": number})
    with open_log(path) as log:
        tracemalloc.start()
        result = evolution(log)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert len(log.observables["energy"][1]) == number
    assert result.samples.tolist() == np.linspace(0, 20, number)[::17].tolist()
    assert (result.parts["motion"] == result.parts["motion"][0]).all()
    assert most < 60e6  # all of them are 100 MB


def test_a_gate_counts_who_is_beyond(make):
    gate = "wall=[{ from = [6, 0], to = [6, 8], opens_at = 5 }]"
    log = make(gate, "species.region=[0, 0, 6, 8]")
    result = evolution(log)
    share = result.beyond["gas"]
    assert (share[result.time <= 5] == 0).all()
    assert share[-1] == (log.state_at(20.0).position[:, 0] > 6).mean() > 0.2
    assert f"At the end {100 * share[-1]:.1f} % of the discs are beyond the wall" in result.summary()


PISTON = "piston=[{ velocity = -0.05 }]"


def test_an_adiabatic_exponent_from_temperature_and_area(make):
    """The piston goes from 12 to 11 in a time of 20: instants, not means over bins."""
    log = make(PISTON)
    result = evolution(log)
    kinetic = [(log.state_at(t).velocity ** 2).sum() for t in (0.0, 20.0)]
    gamma = result.adiabatic_exponent
    assert gamma.value == pytest.approx(1 + math.log(kinetic[1] / kinetic[0]) / math.log(12 / 11))
    assert gamma.theory == pytest.approx(2.06, abs=0.02)  # discs have 2 where Z = 1, and φ is 0.013
    assert 0.01 < gamma.standard_error < 0.5
    assert abs(gamma.deviation) < 4
    assert " The piston goes from 12 to 11. γ = 1 + ln(T₂/T₁)/ln(A₁/A₂) = " in result.summary()
    assert evolution(log, 0.0, 5.0).adiabatic_exponent is None  # the area hardly changes


@pytest.mark.slow
def test_errors_of_adiabatic_exponents_are_right(make):
    """Root mean square of deviation over error in 40 runs within 3/√80 of 1; a short stroke has a caveat."""
    slow = "piston=[{ velocity = -0.005 }]", "run.until=200"
    strokes = [evolution(make(*slow, f"scene.seed={k}")) for k in range(1, 41)]
    assert not any("round trips" in caveat for stroke in strokes for caveat in stroke.caveats)
    assert any("only 0.8" in caveat for caveat in evolution(make(PISTON)).caveats)
    off = [stroke.adiabatic_exponent.deviation for stroke in strokes]
    assert abs(math.sqrt(np.mean(np.square(off))) - 1) < 3 / math.sqrt(80)


def test_the_mean_of_a_steady_temperature_is_compared_with_theory(make):
    """Not an instant, whose kinetic energy fluctuates by T/√N."""
    result = evolution(make("box.left={ thermal = 3 }", "run.until=400"))
    mean = result.mean_temperature
    assert (mean.theory, result.law.temperature[-1]) == (3.0, 3.0)
    assert abs(mean.deviation) < 4
    assert mean.value == pytest.approx(result.temperature[-200:].mean(), rel=0.1)
    assert "; its mean once steady is " in result.summary()
    assert "equilibrium (3, " in result.summary()
    closed = evolution(make())
    assert closed.mean_temperature is None  # its energy is conserved
    assert closed.summary() == "The kinetic energy per disc stays at 1.5; equilibrium theory predicts 1.5."


def test_work_of_a_piston_at_constant_temperature(make):
    """A slow piston does N T ln(A₁/A₂) on an ideal gas; 40 discs of this size need a little more."""
    slow = "piston=[{ velocity = -0.0125 }]"
    result = evolution(make("box.left={ thermal = 1.5 }", slow, "run.until=80", "log.snapshot_every=1"))
    work = result.isothermal_work
    assert work.value == pytest.approx(result.given["piston"][-1])
    assert work.theory == pytest.approx(40 * 1.5 * math.log(12 / 11), rel=0.06)
    assert work.theory > 40 * 1.5 * math.log(12 / 11)
    assert abs(work.deviation) < 4
    assert "The work of the piston on the discs is " in result.summary()
    assert evolution(make(PISTON)).isothermal_work is None


def test_haff(make):
    """τ of a dilute gas: 4/((1 - e²) 2σn√(πT/m)); what size, number and velocities' a₂ change is some percent."""
    result = evolution(make("restitution.normal=0.8", "species.radius=0.02", *PERIODIC))
    tau = 4 / (0.36 * 2 * 0.04 * 40 / 96 * math.sqrt(math.pi * 1.5))
    t = result.law.temperature
    assert t[0] == pytest.approx(1.5)
    assert 20 / (math.sqrt(t[0] / t[-1]) - 1) == pytest.approx(tau, rel=0.05)
    assert np.abs(result.balance).max() < 1e-12
    assert result.dissipated.keys() == {"discs"}
    assert result.pressure is None  # nothing is hit
    energy = result.parts["motion"]
    assert result.dissipated["discs"] == pytest.approx(energy[0] - energy, rel=1e-12, abs=1e-12 * energy[0])


@pytest.mark.usefixtures("uncompiled")
def test_what_elastic_discs_lose_by_rounding_is_no_loss(make):
    assert {*evolution(make("restitution.wall=0.9", "run.until=3")).dissipated} == {*SIDES}


def test_adiabat(make):
    """Of points T A stays the same; the discs' size makes it a little more."""
    result = evolution(make("piston=[{ velocity = -0.2 }]", "species.radius=0.001"))
    assert result.law.temperature[-1] == pytest.approx(1.5 * 12 / 8, rel=1e-3)
    assert result.pistons["piston"][[0, -1]] == pytest.approx([12, 8])
    assert result.given["piston"][-1] == pytest.approx(result.parts["motion"][-1] - 60)


def test_a_piston_with_a_mass_keeps_its_balance_and_has_a_place(make):
    result = evolution(make("piston=[{ side = 'left', position = 4, mass = 5, pressure = 1 }]", "species.radius=0.001"))
    assert np.abs(result.balance).max() < 1e-12
    assert set(result.parts) == {"motion", "piston"}
    energy, n = 60 + 8 * (8 - 0.002), 40
    t = energy / (2 * n + 1.5)
    assert result.law.temperature[0] == pytest.approx(t, rel=1e-3)
    assert 12 - result.law.piston == pytest.approx(0.002 + (n + 1) * t / 8, rel=1e-3)
    shown = result.plot().axes
    assert "piston position (length)" in [ax.get_ylabel() for ax in shown]
    assert "work done by the piston" in [text.get_text() for ax in shown for text in ax.get_legend().get_texts()]


def test_equilibrium(make):
    for overrides, t in (
        ((), 1.5),
        (("box.left={ thermal = 2 }",), 2.0),
        (PERIODIC, 1.5),
        (("box.left={ thermal = 2 }", "box.right={ thermal = 1 }"), None),
        (("rotation.roughness=0",), None),
    ):
        law = evolution(make(*overrides, "run.until=2")).law
        assert (law and law.temperature[-1]) == (t and pytest.approx(t)), overrides


def test_pressure_in_bins_of_time(make):
    """The bins together are the mean over the log, and the picture has one panel for P(t) and one for P(A)."""
    log = make("piston=[{ velocity = -0.1 }]", "species.radius=0.001")
    result = evolution(log)
    series, force = result.pressure, log.observables["wall_energy"][1][-1, 1] / 0.1 / 20  # work per way and time
    assert series.pressure["right wall"].mean() * 8 == pytest.approx(force, rel=1e-9)
    n = len(series.area)
    assert series.area[[0, -1]] == pytest.approx(96 - 0.8 * 20 * np.array([0.5, n - 0.5]) / n)
    assert {*series.pressure} == {f"{side} wall" for side in SIDES}
    titles = [table.title for table in result.plain_tables()]
    assert titles[1] == "Pressure on walls, means over bins of time"
    axes = [ax.get_ylabel() for ax in result.plot().axes]
    assert axes.count("pressure (energy/length²)") == 2
    labels = [text.get_text() for text in result.plot().axes[-1].get_legend().get_texts()]
    assert labels == ["isotherm through the start", "adiabat through the start", "P on right wall, in time"]


def states_of(result):
    """Areas of the pressures that the picture of an evolution shows against the area."""
    return result.plot().axes[-1].containers[0].lines[0].get_xdata()


def test_states_of_a_piston_are_a_path_until_it_rests(make):
    """One with a mass oscillates first; all the time at rest is one point. One that is moved never rests."""
    moved = evolution(make("piston=[{ velocity = -0.1 }]"))
    assert (moved.rest_start, len(states_of(moved))) == (None, len(moved.pressure.area))
    log = make("piston=[{ position = 12, mass = 100, pressure = 3 }]", "species.count=60", "run.until=1000")
    result, late = evolution(log), evolution(log, 500.0)
    assert 100 < result.rest_start < 500 < late.rest_start
    areas = states_of(result)
    assert len(areas) == STATES + 1
    assert np.ptp(areas[:4]) > 10
    assert areas[-1] == pytest.approx(8 * result.rest.value, rel=0.01)
    assert len(states_of(late)) == 1


def test_pressure_of_a_uniform_gas_is_that_of_all_sides(make):
    series = evolution(make()).pressure
    assert series.shown == ("all sides",)
    assert series.lines is None
    assert (series.area == 96).all()
    sides = np.mean([series.pressure[f"{side} wall"] for side in ("left", "right")], axis=0) * 16
    ends = np.mean([series.pressure[f"{side} wall"] for side in ("bottom", "top")], axis=0) * 24
    assert series.pressure["all sides"] == pytest.approx((sides + ends) / 40)


@pytest.mark.parametrize(
    ("overrides", "isotherm", "adiabat"),
    [
        (("piston=[{ velocity = -0.1 }]",), True, True),
        (("piston=[{ velocity = -0.1 }]", "box={ size = [12, 8], left = { thermal = 1.5 } }"), True, False),
        (("piston=[{ velocity = -0.1 }]", "gravity.acceleration=[0, -0.1]"), False, False),
        (("piston=[{ velocity = -0.1 }]", "species.radius=0.7"), False, False),  # above freezing at the end
    ],
)
@pytest.mark.slow
def test_lines_of_state_where_theory_has_them(overrides, isotherm, adiabat, make):
    lines = evolution(make(*overrides)).pressure.lines
    assert (lines is not None) == isotherm
    if lines:
        assert (lines.adiabat is not None) == adiabat
        start = -1  # the largest area
        assert lines.isotherm[start] == pytest.approx(40 * 1.5 / 96, rel=0.1)
        if adiabat:
            assert lines.adiabat[start] == pytest.approx(lines.isotherm[start])
            assert lines.adiabat[0] > lines.isotherm[0]

"""The analyses of a log from end to end: windows, results, pictures and refusals."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from idealgas import heat_capacity, histogram
from idealgas.analysis.core.equilibration import measure
from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.style import save
from idealgas.analysis.heat_capacity import CLOSED, HeatCapacityAnalysis
from idealgas.analysis.histogram import QUANTITIES
from idealgas.analysis.info import info
from idealgas.analysis.pressure.figure import pressure_figure
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.temperature import temperature, temperature_figure
from idealgas.analysis.theory.ensemble import composition
from idealgas.analysis.transport.measure import transport
from idealgas.effects.properties import ActiveEffect, Properties
from idealgas.errors import OutputError, UserError
from idealgas.log import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import Scene, parse_scene

SCENE = """
[scene]
seed = 5
[box]
size = [20.0, 15.0]
[[species]]
name = "gas"
count = 100
radius = 0.25
speed = 1.0
[run]
collisions_per_disc = 150
"""


def run(folder, name, text=SCENE, *overrides):
    path = folder / name
    simulate(parse_scene(text, overrides=overrides), path)
    return open_log(path)


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    with run(tmp_path_factory.mktemp("observables"), "gas.h5") as log:
        yield log


@pytest.fixture(scope="module")
def hotter(tmp_path_factory):
    with run(tmp_path_factory.mktemp("observables"), "hot.h5", SCENE, "species.0.speed=2.0", "scene.seed=6") as log:
        yield log


def test_composition(log):
    discs = composition(log.discs)
    assert (discs.name, discs.radius.tolist(), discs.mass.tolist()) == (("gas",), [0.25], [1.0])
    assert discs.number.tolist() == [100]


def test_default_window_leaves_the_relaxation_out(tmp_path):
    """From equal speeds it takes a few collisions per disc, which the fluctuations of this many discs do not hide."""
    with run(tmp_path, "many.h5", SCENE, "species.0.count=1000", "box.size=[60, 50]") as log:
        window = measure(log, [Moments()])
        assert 0 < window.start < log.end_time / 2
        assert window.detected
        assert window.end == log.end_time


def test_given_window_is_kept(log):
    window = measure(log, [Moments()], 3.0, 17.5)
    assert (window.start, window.end, window.detected) == (3.0, 17.5, False)


@pytest.mark.parametrize(
    ("start", "end"), [(5.0, 5.0), (6.0, 5.0), (-1.0, 5.0), (1e9, None), (None, 1e9), (float("nan"), None)]
)
def test_empty_windows_are_refused_in_one_line(log, start, end):
    with pytest.raises(UserError, match=r"empty time window t = .*: the log covers t = 0 to") as error:
        measure(log, [Moments()], start, end)
    assert "\n" not in str(error.value)


def test_window_without_events_is_refused(log):
    (times,) = next(log.chunks(("time",)))
    gap = np.diff(times).argmax()
    with pytest.raises(UserError, match="no event between"):
        measure(log, [Moments()], times[gap] + 1e-9, times[gap + 1] - 1e-9)


def test_log_without_events_is_refused(tmp_path):
    with run(tmp_path, "plain.h5", SCENE, "log.events=false", "run.collisions_per_disc=1") as log:
        with pytest.raises(UserError, match="has no events"):
            pressure(log)
        assert info(log)["run"]["event_rows"] is None


def test_effects_are_not_ignored(log, monkeypatch):
    monkeypatch.setattr(Scene, "active_effects", (ActiveEffect("magnets", (), Properties(uniform=False)),))
    with pytest.raises(UserError, match="no answer for a gas with magnets"):
        transport(log)
    found = pressure(log)
    assert (found.routes, found.no_theory) == ((), "no equation of state holds under magnets")
    assert histogram(log, "free-time").no_law == "the gas is not the same everywhere (magnets)"


def test_gas_at_rest_is_refused(tmp_path):
    with run(tmp_path, "rest.h5", SCENE, "species.0.speed=0", "run.collisions_per_disc=", "run.until=1") as log:
        for analysis in (pressure, lambda log: histogram(log, "speed"), temperature):
            with pytest.raises(UserError, match=r"no event between|no disc moves"):
                analysis(log)


def test_pressure_by_hand(log):
    """Everything over a given window, again by a few lines of numpy."""
    start, end = 5.0, log.end_time
    result = pressure(log, start, end)
    routes = {route.name: route for route in result.routes}
    columns = ("time", "disc", "partner", "position", "velocity")
    blocks = list(log.chunks(columns, log.row_at(start)))
    time, disc, partner, position, velocity = (np.concatenate(column) for column in zip(*blocks, strict=True))
    before = np.empty_like(velocity)
    last = dict(enumerate(log.state_at(start).velocity))
    for row, own in enumerate(disc):
        before[row] = last[own]
        last[own] = velocity[row]
    push = velocity - before  # mass 1
    left = push[partner == -1, 0].sum() / (end - start) / log.box[1]
    assert routes["left wall"].pressure.value == pytest.approx(left, rel=1e-10)
    sides = -(push * np.sign(push) * -1)[partner < 0].sum() / (end - start) / (2 * sum(log.box))
    assert routes["all walls"].pressure.value == pytest.approx(sides, rel=1e-10)
    first = np.flatnonzero((partner >= 0) & (disc < partner))
    virial = ((position[first] - position[first + 1]) * push[first]).sum()
    z = 1 + virial / (end - start) / (2 * log.discs.kinetic_energy)
    assert routes["pairs, virial"].compressibility_factor.value == pytest.approx(z, rel=1e-10)
    rate = 2 * len(first) / 100 / (end - start)
    assert result.collision_rates[0].rate.value == pytest.approx(rate, rel=1e-10)
    assert result.free_paths[0].time.value == pytest.approx(1 / rate, rel=1e-10)
    assert time[0] > start


def test_check_fails_when_theory_is_off(log):
    result = pressure(log)
    assert result.check().agrees is True

    def moved(route):
        z = route.compressibility_factor
        return replace(route, compressibility_factor=replace(z, theory=z.value + 4.5 * z.standard_error))

    assert replace(result, routes=tuple(moved(route) for route in result.routes)).check().agrees is False
    unknown = tuple(
        replace(r, compressibility_factor=replace(r.compressibility_factor, theory=None)) for r in result.routes
    )
    assert str(replace(result, routes=unknown, no_theory="why").check()) == "No theory here: why."
    pairs = replace(result.routes[-1].compressibility_factor, standard_error=math.nan)
    checked = replace(result, routes=(replace(result.routes[-1], compressibility_factor=pairs),)).check()
    assert checked.agrees is None
    assert str(checked).startswith("Too few samples to tell")


def test_an_error_of_theory_counts_like_one_of_measurement():
    found = Estimate(1.5, 0.03, 100.0, 1.4, 0.04)
    assert found.deviation == pytest.approx(2.0)
    assert found.times(-2.0).deviation == pytest.approx(-2.0)
    assert Estimate.from_dict(found.as_dict()) == found


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_histogram_is_a_density(log, quantity):
    result = histogram(log, quantity)
    (found,) = result.distributions
    assert 0.99 < (found.density * np.diff(found.edges)).sum() <= 1 + 1e-12
    middle = (found.edges[1:] + found.edges[:-1]) / 2
    assert (found.density * middle * np.diff(found.edges)).sum() == pytest.approx(found.mean.value, rel=0.02, abs=0.01)
    assert all(0 <= test.p_value <= 1 for test in found.tests)
    assert found.samples > 100


def test_temperatures_of_the_directions_add_up(log):
    result = temperature(log)
    (gas,) = result.species
    assert (gas.x.value + gas.y.value) / 2 == pytest.approx(gas.both.value, rel=1e-12)
    assert gas.both.value == pytest.approx(log.discs.kinetic_energy / 100, rel=1e-10)
    assert gas.history == pytest.approx(np.full(len(gas.history), 0.5), rel=1e-10)


def test_heat_capacity_of_one_log(log):
    """The exact energy over the temperature by the pressure."""
    measured = heat_capacity(log)
    (route,) = HeatCapacityAnalysis.combine([measured]).routes
    assert (route.name, route.kind) == ("E/T", CLOSED)
    assert route.value.value == pytest.approx(0.5 / measured.temperature.value, rel=1e-10)


def test_heat_capacity_of_two_logs_has_their_slope(log, hotter):
    cold, hot = logs = [heat_capacity(log), heat_capacity(hotter)]
    slope = (hot.energy.value - cold.energy.value) / (hot.temperature.value - cold.temperature.value)
    found = {route.name: route.value for route in HeatCapacityAnalysis.combine(logs).routes}
    assert found["dE/dT"].value == pytest.approx(slope, rel=1e-10)
    error = slope * np.hypot(cold.temperature.standard_error, hot.temperature.standard_error) / 1.5 * slope
    assert found["dE/dT"].standard_error == pytest.approx(error, rel=1e-10)


def test_logs_of_one_energy_have_no_slope(log):
    found = HeatCapacityAnalysis.combine([heat_capacity(log), heat_capacity(log)])
    assert [route.name for route in found.routes] == ["E/T"]
    assert "several energies" in found.refused["dE/dT"]


def test_results_are_json(log, hotter):
    results = [
        pressure(log),
        temperature(log),
        HeatCapacityAnalysis.combine([heat_capacity(log), heat_capacity(hotter)]),
        histogram(log, "speed"),
    ]
    for values in (*(result.as_dict() for result in results), info(log)):
        assert json.loads(json.dumps(values, allow_nan=False))


def test_unknown_numbers_are_null_in_json():
    assert Estimate(np.nan, np.inf, 3.0).as_dict()["value"] is None


def test_every_axis_has_a_name(log, hotter):
    for figure in (
        pressure_figure(pressure(log)),
        temperature_figure(temperature(log)),
        HeatCapacityAnalysis.combine([heat_capacity(log), heat_capacity(hotter)]).plot(),
        *(histogram(log, quantity).plot() for quantity in ("speed", "waiting-time")),
    ):
        for ax in figure.axes:
            assert ax.get_xlabel()
            assert ax.get_ylabel()


def test_pictures_are_written_or_refused(log, tmp_path):
    figure = temperature_figure(temperature(log))
    save(figure, tmp_path / "temperature.png")
    assert (tmp_path / "temperature.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(OutputError, match="no folder"):
        save(figure, tmp_path / "no such folder" / "temperature.png")


def test_info_counts(log):
    found = info(log)
    assert found["gas"]["number"] == 100
    assert found["run"]["event_rows"] == len(log)
    assert found["file"]["state"] == "complete"

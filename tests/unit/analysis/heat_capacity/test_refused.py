"""Routes to the heat capacity that a log refuses give the reason of that log."""

import math

import numpy as np
import pytest
from helpers.support import ROOT

from idealgas import heat_capacity, load_scene, open_log, parse_scene, simulate
from idealgas.analysis.heat_capacity import HeatCapacityAnalysis
from idealgas.analysis.heat_capacity.fluctuations import EnergySeries, energy_series, expected_capacity
from idealgas.errors import UserError


def test_a_short_run_with_a_piston_lacks_samples_not_a_piston(tmp_path):
    simulate(load_scene(ROOT / "configs/piston.toml", ["run.until=300", "log.snapshot_every=5"]), tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        measured = heat_capacity(log, start=20.0)
    result = HeatCapacityAnalysis.combine([measured])
    refused = result.refused
    assert "independent samples of the energy are too few (128 needed)" in refused["fluctuations of the kinetic energy"]
    assert "it requires" not in refused["fluctuations of the kinetic energy"]
    assert refused["γ"].startswith("no heat capacity of the gas with the piston was measured")
    assert refused["Var(E)/T²"].startswith("it requires thermal walls")
    rows = [label.get_text() for label in HeatCapacityAnalysis.figure(result).axes[0].get_yticklabels()]
    assert rows == ["no dE/dT", "no E/T", "no Var(E)/T²", "no fluctuations", "no γ"]


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize(
    ("effect", "position", "potential"),
    [
        (f"gravity.acceleration=[0, {-1 / 4.98!r}]", None, 1 - 1 / (2 * math.sinh(0.5)) ** 2),
        ("piston=[{ side='right', mass=50, pressure=4 }]", 10.0, 1.0),
    ],
    ids=["column", "piston"],
)
def test_capacity_of_positions_by_theory(tmp_path, effect, position, potential):
    """For x = mgh/T = 1, x² eˣ/(eˣ - 1)² is 1/(2 sinh ½)². In a dilute gas Z² and d(φZ)/dφ are 1 + 4φ, to order φ²."""
    gas = "box.size=[10, 5]\nrun.events=1\nspecies=[{name='gas', count=40, radius=0.01, temperature=1}]\n"
    simulate(parse_scene(gas + effect), tmp_path / "run.h5")
    kinetic = np.full(2, 40.0)
    with open_log(tmp_path / "run.h5") as log:
        series = EnergySeries(kinetic, kinetic, position and np.full(2, position), 0.0)
        theory, of_piston = expected_capacity(log, series)
    assert theory.value == pytest.approx(1 + potential, abs=1e-6)
    assert of_piston == (position and pytest.approx(1.0, abs=1e-6))


def test_few_samples_of_the_energy_name_the_key_that_stores_more(tmp_path):
    scene = load_scene(ROOT / "configs/rough.toml", ["run.collisions_per_disc=20", "log.events=false"])
    simulate(scene, tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log, pytest.raises(UserError, match="16 needed"):
        heat_capacity(log, start=1.0)


@pytest.mark.parametrize(
    ("effect", "collisions"), [("rotation={inertia=0.5, roughness=1}", 800), ("gravity.acceleration=[0, -0.1]", 100)]
)
def test_events_tell_the_energy_at_all_times(effect, collisions, tmp_path):
    """The capacity of rough discs is 3N/2; samples at the starts of epochs were too few to give any."""
    gas = ["species.0.count=100", f"species.0.radius={math.sqrt(0.1 / math.pi)!r}"]
    scene = load_scene(ROOT / "configs/quickstart.toml", [*gas, effect, f"run.collisions_per_disc={collisions}"])
    simulate(scene, tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        series, measured = energy_series(log), heat_capacity(log)
        time, kinetic = log.observables["kinetic_energy"]
        assert energy_series(log, start=float(time[1])).kinetic[0] == pytest.approx(kinetic[1], rel=1e-12)
    assert np.ptp(series.energy) < 1e-9 * series.energy.mean()
    for route in measured.routes.values():
        assert abs(route.deviation) < 4
        assert route.standard_error < 0.3
    assert bool(measured.routes) == (collisions > 100)

"""Routes to the heat capacity that a log refuses give the reason of that log."""

import pytest
from helpers.support import ROOT

from idealgas import heat_capacity, load_scene, open_log, simulate
from idealgas.analysis.heat_capacity import HeatCapacityAnalysis
from idealgas.errors import UserError


def test_a_short_run_with_a_piston_lacks_samples_not_a_piston(tmp_path):
    simulate(load_scene(ROOT / "configs/piston.toml", ["run.until=300", "log.snapshot_every=5"]), tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        measured = heat_capacity(log, start=20.0)
    refused = HeatCapacityAnalysis.combine([measured]).refused
    assert "independent samples of the energy are too few (128 needed)" in refused["fluctuations of the kinetic energy"]
    assert "it takes" not in refused["fluctuations of the kinetic energy"]
    assert refused["γ"].startswith("no heat capacity of the gas with the piston was measured")
    assert refused["Var(E)/T²"].startswith("it takes thermal walls")


def test_few_samples_of_the_energy_name_the_key_that_stores_more(tmp_path):
    simulate(load_scene(ROOT / "configs/rough.toml", ["run.collisions_per_disc=20"]), tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log, pytest.raises(UserError, match="16 needed"):
        heat_capacity(log, start=1.0)

"""Reversed velocities: a gas runs back, the same by every method, in a resumed run and in the energy account."""

import numpy as np
import pytest
from helpers.log_compare import same_by_brute_force_and_resumed
from helpers.support import ROOT, logged

from idealgas import load_scene, open_log, parse_scene
from idealgas.columns import OUTSIDE, Kind
from idealgas.log.start import continued_scene

GOLDEN = ROOT / "tests" / "cases" / "golden" / "steering.toml"
EXPANSION = """
scene.seed = 3
box.size = [20, 10]
wall = [{ name = "gate", from = [10, 0], to = [10, 10], opens_at = 1, closes_at = 17 }]
species = [{ name = "gas", count = 50, radius = 0.2, temperature = 1, region = [0, 0, 10, 10] }]
steering.reversed_at = 9
run.until = 18
"""


@pytest.mark.usefixtures("uncompiled")
def test_the_same_by_brute_force_and_resumed(tmp_path):
    summary = same_by_brute_force_and_resumed(tmp_path, GOLDEN, (), *(f"run.until={until}" for until in (1, 2, 4, 5.5)))
    with open_log(tmp_path / "whole.h5") as log:
        assert summary.steered == log.observables["steered"][1][-1] == 2 * len(log.discs)
        assert summary.rows == len(log)


def test_all_velocities_and_spins_are_reversed_in_rows_of_their_own(tmp_path):
    with logged(load_scene(GOLDEN), tmp_path / "run.h5") as log:
        n = len(log.discs)
        steered = [block.kind == Kind.STEERED for block in log.chunks(("kind",))]
        assert np.flatnonzero(np.concatenate(steered)).tolist() == [
            *range(log.row_at(2), log.row_at(2) + n),
            *range(log.row_at(5), log.row_at(5) + n),
        ]
        before, after = log.state_at(np.nextafter(2, 0)), log.state_at(2)
        rows = next(log.events(t0=2, t1=np.nextafter(2, 3)))
        assert (rows.disc.tolist(), set(rows.partner.tolist())) == ([*range(n)], {OUTSIDE})
        assert np.abs(after.velocity + before.velocity).max() < 1e-14  # under gravity for one last bit of time
        assert np.array_equal(after.angular_velocity, -before.angular_velocity)
        assert np.array_equal(after.velocity, rows.velocity)
        assert np.abs(after.position - before.position).max() < 1e-13
        assert "reversed_at = 3.0" in continued_scene(log, 2.0, "run.h5")
        assert "reversed_at" not in continued_scene(log, 5.0, "run.h5")


def right_half(log, time):
    return (log.state_at(time).position[:, 0] > 10).mean()


@pytest.mark.parametrize(("precision", "returns"), [(None, True), ("float32", False)])
def test_an_expanded_gas_runs_back_with_16_digits_and_not_with_7(tmp_path, precision, returns):
    """Both ways at t = 9 ± 8: the same places, and the gate closes behind the last disc."""
    overrides = [] if precision is None else ["run.method=brute_force", f"run.precision={precision}"]
    if precision:
        overrides.append("wall=")
    with logged(parse_scene(EXPANSION, overrides=overrides), tmp_path / "run.h5") as log:
        out, back = log.state_at(1), log.state_at(17)
        assert right_half(log, 9) > 0.25
        apart = np.abs(out.position - back.position).max()
        assert (apart < 1e-3) == returns
        assert not returns or right_half(log, 18) == 0

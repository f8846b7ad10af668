"""Time of a sweep from the costs of its points, and the short runs from which these follow."""

import pytest

from idealgas.sweep.cost import MOST_TRIALS, START, TRIAL_SHARE, Cost, Trial, estimate_cost, total_seconds
from idealgas.sweep.plan import load_sweep

PLAN = """
[sweep]
replicates = 5
[[axis]]
key = "species.gas.temperature"
range = [1, 2, 40]
[base]
box.size = [10, 10]
species = [{name = "gas", count = 10, radius = 0.1, temperature = 1.0}]
run.events = 1000
"""

UNKNOWN = "[base.gravity]\nacceleration = [0, -1]\n[[base.wall]]\nfrom = [2, 2]\nto = [4, 3]\n"
"""Tables of a gas for which theory has no rate of events."""


@pytest.mark.parametrize(("seconds", "workers", "total"), [([6, 6, 6, 6], 2, 12), ([1, 1, 40], 3, 40), ([5], 8, 5)])
def test_workers_share_the_points_but_no_point_is_shared(seconds, workers, total):
    costs = [Cost(100, 0.1, 1e6, 1e6, each) for each in seconds]
    assert total_seconds(costs, workers) == START + total


@pytest.mark.interpreted
@pytest.mark.parametrize(("text", "number"), [(PLAN, round(TRIAL_SHARE * 5 * 40)), (PLAN + UNKNOWN, MOST_TRIALS)])
def test_short_runs_take_a_share_of_the_time_where_theory_forecasts_the_events(text, number, tmp_path):
    """A point takes as long as a short run of it here; each short run is slower than the one before."""
    path, tried = tmp_path / "sweep.toml", []
    path.write_text(text)

    def execute(run, scenes):
        for scene in scenes:
            tried.append(scene.species[0].temperature)
            yield Trial(rows=1.0, per_second=1e12, per_time=1.0, seconds=1.0, apart=1.0 + (len(tried) - 1) / 1000)

    sweep = load_sweep(path)
    costs = estimate_cost(sweep, execute=execute)
    every = -(-40 // number)
    temperatures = [point.scene.species[0].temperature for point in sweep.points[::5]]
    assert tried == temperatures[::every]
    assert [cost.events for cost in costs] == pytest.approx([1000] * 200)
    expected = [1 + point.combination // every / 1000 for point in sweep.points]
    assert [cost.seconds for cost in costs] == pytest.approx(expected, abs=1e-6)

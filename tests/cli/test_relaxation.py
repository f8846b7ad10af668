"""`idealgas relaxation`: tables, JSON and pictures of one log and of several."""

import json

import pytest
from helpers.support import output_of

from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

SCENE = """
box.size = [10, 10]
species = [{name = "gas", count = 100, radius = 0.1, speed = 1.0}]
run.collisions_per_disc = 30
"""


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """Paths: event-driven and Monte Carlo."""
    folder = tmp_path_factory.mktemp("relaxation")
    extras = {"exact": "", "random": 'run.method = "monte_carlo"\nrun.v_ref = 10\n'}
    for name, extra in extras.items():
        simulate(parse_scene(SCENE + extra), folder / f"{name}.h5")
    return {name: folder / f"{name}.h5" for name in extras}


def test_one_table_for_several_logs(logs, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    shown = output_of("relaxation", logs["exact"], logs["random"])
    rows = [line for line in shown.splitlines() if ".h5" in line and "│" in line]
    assert all(" 100 " in row for row in rows[:4])  # two logs, in time and in collisions per disc
    assert f"{logs['random']}" in rows[4]
    assert " 1,500 " in rows[4]
    assert all(f"{logs['exact']}" not in row for row in rows[4:])
    assert "published" not in shown


def test_numbers_for_machines(logs):
    shown = output_of("relaxation", logs["exact"], logs["random"], "--every", 300, "--json")
    exact, random = json.loads(shown)["logs"]
    assert (exact["path"], random["path"]) == (str(logs["exact"]), str(logs["random"]))
    assert exact["acceptance"] is None
    assert random["acceptance"]["collisions"] == 1500
    assert exact["speed_distributions"]["trials"] is None
    assert random["speed_distributions"]["trials"][:3] == [0, 300, 600]
    for result in (exact, random):
        assert result["relaxation_time"]["standard_error"] > 0
        assert len(result["time"]) == len(result["kurtosis"]) == len(result["distance"]) == len(result["entropy"])
        assert result["collisions_per_disc"][-1] == pytest.approx(30)


def test_speeds_at_instants(logs):
    shown = output_of("relaxation", logs["exact"], "--every", 5)
    counts = [line.split() for line in shown.splitlines() if line.strip().startswith(("0 ", "5 ", "law "))]
    assert counts[0] == ["0", "0.00", counts[0][2], "0", "0", "0", "100", "0", "0", "0", "0", "0"]
    assert sum(map(int, counts[1][3:])) == 100
    assert sum(map(float, counts[2][1:])) == pytest.approx(100, abs=0.5)


def test_picture(logs, tmp_path):
    output_of("relaxation", logs["exact"], logs["random"], "--plot", tmp_path / "picture.svg")
    assert (tmp_path / "picture.svg").stat().st_size > 20_000

"""`idealgas accuracy` as a user runs it: a small gas, and the orbit of three discs."""

import csv
import json

import pytest
from helpers.support import ROOT, called, idealgas

SMALL = """
[box]
size = [10, 10]
left = "periodic"
right = "periodic"
[[species]]
name = "gas"
count = 60
radius = 0.3
temperature = 1
[run]
collisions_per_disc = 60
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    folder = tmp_path_factory.mktemp("accuracy")
    (folder / "small.toml").write_text(SMALL)
    return folder, idealgas("accuracy", "small.toml", "-o", "out", "--repeats", 1, folder=folder)


@pytest.mark.slow
def test_tables_sentences_and_files_with_all_numbers(small):
    folder, done = small
    assert (done.returncode, done.stderr) == (0, "")
    assert "Time and averages" in done.stdout
    assert "event-driven" in done.stdout
    assert "- No trajectories were compared: only float64 supports periodic sides." in done.stdout
    files = [f"out/accuracy{end}: written" for end in (".csv", ".json", ".png", "-details.png")]
    assert done.stdout.splitlines()[-4:] == files

    with (folder / "out/accuracy.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    result = json.loads((folder / "out/accuracy.json").read_text())
    assert [row["case"] for row in rows] == [row["case"] for row in result["rows"]]
    assert [row["method"] for row in rows] == ["event_driven"] + ["time_driven"] * 8
    assert rows[0]["rate_bias"] == ""
    coarse = rows[1]
    assert float(coarse["rate_bias"]) < -4 * float(coarse["rate_bias_error"]) < 0
    assert float(coarse["missed_share"]) > 0
    assert float(coarse["deepest_overlap"]) > 0.1 > 1e-9 > float(rows[0]["deepest_overlap"])
    assert all(float(row["cpu_s_per_time"]) > 0 for row in rows)
    for picture in ("accuracy", "accuracy-details"):
        assert (folder / f"out/{picture}.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_the_orbit_of_three_discs(tmp_path):
    scene = ROOT / "configs" / "three-discs.toml"
    done = called("accuracy", scene, "--json", "-o", tmp_path)
    written = "".join(f"{tmp_path / name}: written\n" for name in ("orbit.csv", "orbit.json", "orbit.png"))
    assert (done.returncode, done.stderr) == (0, written)
    result = json.loads(done.stdout)
    assert result["placements"] >= 12
    medians = [measured["median"] for measured in result["survivals"]]
    assert medians == sorted(medians)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["orbit.csv", "orbit.json", "orbit.png"]

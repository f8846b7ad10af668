import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner
from idealgas_cli.main import main

SCENE = """
box.size = [20, 20]
species = [{name = "gas", count = 60, radius = 0.3, speed = 1.0}]
run.collisions_per_disc = 100
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("analysis")
    (folder / "scene.toml").write_text(SCENE)
    ran = CliRunner().invoke(main, ["run", str(folder / "scene.toml"), "-o", str(folder / "run.h5")])
    assert ran.exit_code == 0, ran.output
    return str(folder / "run.h5")


def idealgas(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


COMMANDS = [
    ("info",),
    ("temperature",),
    ("pressure",),
    ("heat-capacity",),
    ("profile",),
    ("evolution",),
    *(
        ("histogram", "--quantity", q)
        for q in ("speed", "vx", "vy", "energy", "free-path", "free-time", "waiting-time")
    ),
]


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_tables_and_json(path, command):
    table = idealgas(*command, path)
    assert table.exit_code == 0, table.output
    assert table.stderr == ""
    assert max(map(len, table.stdout.splitlines())) <= 400
    found = idealgas(*command, path, "--json")
    assert found.exit_code == 0
    assert json.loads(found.stdout)


def test_window(path):
    found = json.loads(idealgas("temperature", path, "--from", 10, "--to", 20, "--json").stdout)
    assert found["window"] == {"start": 10.0, "end": 20.0, "equilibration_detected": False}


def test_check_names_what_it_compares(path):
    line = idealgas("pressure", path, "--check").stdout.splitlines()[-1]
    assert "agree within 4 standard errors" in line
    assert line.endswith("in walls, virial; pairs, virial.")
    found = json.loads(idealgas("pressure", path, "--check", "--json").stdout)
    assert (found["agrees"], found["compared"], found["no_theory"]) == (True, ["walls, virial", "pairs, virial"], None)


@pytest.mark.parametrize(
    ("overrides", "why"),
    [
        (("species.radius=1.2", "species.count=58"), "above 0.62"),
        (("species.count=1",), "holds less than 3"),
        (("gravity.acceleration=[0, -0.01]",), "no equation of state holds under gravity"),
    ],
)
def test_check_without_a_theory_says_so(overrides, why, tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE.replace("collisions_per_disc = 100", "events = 2000"))
    options = [word for text in (*overrides, "species.placement=lattice") for word in ("--set", text)]
    assert idealgas("run", tmp_path / "scene.toml", "-o", tmp_path / "run.h5", *options).exit_code == 0
    checked = idealgas("pressure", tmp_path / "run.h5", "--check")
    assert checked.exit_code == 0, checked.output
    assert checked.stdout.splitlines()[-1].startswith("No theory here: ")
    assert why in checked.stdout.splitlines()[-1]
    as_json = idealgas("pressure", tmp_path / "run.h5", "--check", "--json")
    assert as_json.exit_code == 0
    assert json.loads(as_json.stdout)["agrees"] is None
    assert why in json.loads(as_json.stdout)["no_theory"]


def test_check_of_several_logs_without_a_theory_says_so(tmp_path):
    """Their Z is in the table without one; of several gases those with a theory are compared, and named."""
    (tmp_path / "scene.toml").write_text(SCENE.replace("collisions_per_disc = 100", "events = 2000"))
    dense = ("--set", "species.radius=1.2", "--set", "species.count=58", "--set", "species.placement=lattice")
    logs = [tmp_path / f"{name}.h5" for name in ("one", "two", "dilute")]
    for log, options in zip(logs, (dense, (*dense, "--set", "scene.seed=2"), ()), strict=True):
        assert idealgas("run", tmp_path / "scene.toml", "-o", log, *options).exit_code == 0
    checked = idealgas("pressure", *logs[:2], "--check")
    assert checked.exit_code == 0
    assert checked.stdout.splitlines()[-1].startswith("No theory here: there is none for a gas of packing fraction 0.")
    assert idealgas("pressure", *logs[:2]).exit_code == 0
    together = idealgas("pressure", *logs, "--check")
    assert together.exit_code == 0
    assert together.stdout.splitlines()[-1].count("φ = ") == 1


def test_check_that_fails_exits_with_one(path, monkeypatch):
    monkeypatch.setattr("idealgas.analysis.core.statistics.TOLERANCE", 1e-9)
    result = idealgas("pressure", path, "--check")
    assert result.exit_code == 1
    assert "do not agree" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--from", 1e6), "no window"),
        (("--from", 5, "--to", 5), "no window"),
        (("--plot", "picture.xyz"), "unknown figure format"),
    ],
)
@pytest.mark.parametrize("command", COMMANDS[1:7], ids=" ".join)
def test_bad_input_is_one_line(path, command, arguments, message):
    result = idealgas(*command, path, *arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert message in result.stderr


def test_a_histogram_in_csv_has_its_bins(path):
    rows = list(csv.DictReader(idealgas("histogram", path, "--csv").stdout.splitlines()))
    bins = [row for row in rows if row["table"].startswith("Density of speed")]
    low, high, value, law = (np.array([float(row[name]) for row in bins]) for name in ("from", "to", "value", "theory"))
    assert value @ (high - low) == pytest.approx(1, abs=1e-3)
    assert law @ (high - low) == pytest.approx(1, abs=1e-3)
    assert (low[1:] == high[:-1]).all()

"""What all commands that read a log have in common: they print what is asked for, and write nothing else."""

import csv
import json
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.commands import GAS, PLOTTED, listing
from helpers.support import called, error_of, output_of
from pyarrow import parquet

from idealgas import open_log

QUANTITIES = ("vx", "vy", "energy", "free-path", "free-time", "waiting-time", "impact-parameter", "collisions")
COMMANDS = [("info",), *((name,) for name in PLOTTED), *(("histogram", "--quantity", name) for name in QUANTITIES)]
NOT_LOGS = {
    "missing": None,
    "folder": None,
    "other": None,
    "empty": lambda whole: b"",
    "text": lambda whole: b"[box]\nsize = [1, 1]\n",
    "noise": lambda whole: bytes(range(256)) * 100,
    "start": lambda whole: whole[:100],
    "half": lambda whole: whole[: len(whole) // 2],
}


@pytest.fixture
def path(folder):
    return str(folder / "run.h5")


@pytest.mark.parametrize("name", NOT_LOGS)
def test_a_file_that_is_not_a_log_is_the_same_line_for_all_commands(name, path, tmp_path):
    """Where a folder may be one of a sweep, it is named as one without results."""
    whole, file = Path(path).read_bytes(), tmp_path / f"{name}.h5"
    if name == "folder":
        file.mkdir()
    elif name == "other":
        with h5py.File(file, "w") as other:
            other["x"] = [1.0, 2.0]
    elif name != "missing":
        file.write_bytes(NOT_LOGS[name](whole))
    before = listing(tmp_path)
    lines = {command: error_of(command, file.name, folder=tmp_path) for command in ("info", *PLOTTED)}
    if name == "folder":
        sweeps = {lines.pop(command) for command in ("pressure", "heat-capacity", "relaxation")}
        assert sweeps == {"folder.h5: contains no results of a sweep\n"}
    (line,) = set(lines.values())
    assert line.startswith(f"{name}.h5: ")
    assert listing(tmp_path) == before


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_tables_and_json(folder, command):
    before = listing(folder)
    table = output_of(*command, "run.h5", folder=folder)
    assert max(map(len, table.splitlines())) <= 400
    assert json.loads(output_of(*command, "run.h5", "--json", folder=folder))
    if command != ("info",):
        assert "agree" in (headline := table.splitlines()[0]) or "heory" in headline
        assert called(*command, "run.h5", "--csv", folder=folder).stdout.startswith("quantity,group,index,value,")
    assert listing(folder) == before


@pytest.mark.parametrize("command", PLOTTED)
def test_pictures(command, path, tmp_path):
    output_of(command, path, "--from", "0.5", "--to", "20", "--plot", "picture.png", folder=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["picture.png"]
    assert (tmp_path / "picture.png").read_bytes().startswith(b"\x89PNG")
    line = error_of(command, path, "--plot", "picture.png", folder=tmp_path)
    assert line == "picture.png: already exists (use --force to overwrite)\n"


def test_errors_against_the_length_of_blocks(folder, path, tmp_path):
    output_of("pressure", path, "--plot-errors", "errors.png", "--plot", "picture.svg", folder=tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["errors.png", "picture.svg"]
    assert (tmp_path / "errors.png").read_bytes().startswith(b"\x89PNG")
    refused = error_of("pressure", path, "--plot-errors", "errors.png", folder=tmp_path)
    assert refused == "errors.png: already exists (use --force to overwrite)\n"


def test_points_of_a_section_as_a_table(path, tmp_path):
    for name in ("points.csv", "points.parquet"):
        output_of("section", path, "--to", 20, "--points", name, folder=tmp_path)
    text = (tmp_path / "points.csv").read_text(encoding="utf-8")
    rows, table = list(csv.DictReader(text.splitlines())), parquet.read_table(tmp_path / "points.parquet").to_pydict()
    assert [*table] == ["time", "disc", "log", "trajectory", "wall", "position", "sine", "side"]
    with open_log(path) as log:
        hits = [row for chunk in log.events(t1=20) for row in zip(*chunk[:4], strict=True) if row[3] == 1]
    assert [row[0] for row in hits] == table["time"]
    assert [row[1] for row in hits] == table["disc"]
    assert [("left", "right", "bottom", "top")[-1 - row[2]] for row in hits] == table["wall"]
    for name, values in table.items():
        assert [type(values[0])(row[name]) for row in rows] == values
    result = json.loads(output_of("section", path, "--to", 20, "--json"))
    assert sum(result["number"].values()) == len(rows)
    assert "points" not in result
    output_of("section", path, "--points", "points.csv", "--force", folder=tmp_path)
    assert len((tmp_path / "points.csv").read_text(encoding="utf-8")) > len(text)
    refused = error_of("section", path, "--points", "points.csv", folder=tmp_path)
    assert refused == "points.csv: already exists (use --force to overwrite)\n"
    refused = error_of("section", path, "--points", "points.txt", folder=tmp_path)
    assert refused == "points.txt: unknown table format (allowed .csv, .parquet)\n"


def test_seed_and_window(path):
    assert type(json.loads(output_of("info", path, "--json"))["scene"]["seed"]) is int
    result = json.loads(called("temperature", path, "--from", 10, "--to", 20, "--json").stdout)
    assert result["window"] == {"start": 10.0, "end": 20.0, "equilibration_detected": False}


def test_temperatures_of_one_species_are_printed_once(path):
    lines = output_of("temperature", path).splitlines()
    for name in ("gas: m vx²", "gas: m vy²", "gas: m v²/2"):
        assert sum(f"│ {name} " in line for line in lines) == 1


def test_check_names_what_it_compares(path):
    shown = output_of("pressure", path, "--check")
    assert shown.splitlines()[-1].startswith("Measurement and theory agree. A correct gas fails this check with a ")
    table = shown[shown.index("Check: difference between measurement and theory") :]
    assert " ".join(re.sub("[│┃]", " ", table).split()).count(": virial series") == 2  # cells may have several lines
    result = json.loads(called("pressure", path, "--check", "--json").stdout)
    assert (result["agrees"], result["no_theory"]) == (True, None)
    assert [row["name"] for row in result["compared"]] == ["walls, virial", "pairs, virial"]
    assert all(abs(row["difference"]) < row["allowed"] < row["detectable"] for row in result["compared"])
    assert [row["agrees"] for row in result["compared"]] == [True, True]


@pytest.mark.parametrize(
    ("overrides", "why"),
    [
        (("species.radius=1.2", "species.count=58"), "above 0.62"),
        (("species.count=1",), "holds fewer than 3"),
        (("gravity.acceleration=[0, -0.01]",), "no equation of state holds under gravity"),
    ],
)
def test_check_without_a_theory_says_so(overrides, why, tmp_path):
    (tmp_path / "scene.toml").write_text(f"{GAS}run.events = 2000")
    options = [word for text in (*overrides, "species.placement=lattice") for word in ("--set", text)]
    output_of("run", "scene.toml", "-o", "run.h5", *options, folder=tmp_path)
    silent = called("pressure", "run.h5", "--check", "-q", folder=tmp_path)
    assert (silent.returncode, silent.stdout) == (0, "")
    (line,) = silent.stderr.splitlines()
    assert line.startswith("Theory is not available: ")
    assert why in line
    result = json.loads(output_of("pressure", "run.h5", "--check", "--json", folder=tmp_path))
    assert result["agrees"] is None
    assert why in result["no_theory"]


def test_check_of_several_logs_without_a_theory_says_so(tmp_path):
    """Their Z is in the table without one; of several gases those with a theory are compared, and named."""
    (tmp_path / "scene.toml").write_text(f"{GAS}run.events = 2000")
    dense = ("--set", "species.radius=1.2", "--set", "species.count=58", "--set", "species.placement=lattice")
    logs = [tmp_path / f"{name}.h5" for name in ("one", "two", "dilute")]
    for log, options in zip(logs, (dense, (*dense, "--set", "scene.seed=2"), ()), strict=True):
        output_of("run", tmp_path / "scene.toml", "-o", log, *options)
    checked = called("pressure", *logs[:2], "--check").stderr
    assert checked.startswith("Theory is not available: no equation of state is known for a packing fraction of 0.")
    output_of("pressure", *logs[:2])
    (row,) = json.loads(output_of("pressure", *logs, "--check", "--json"))["compared"]
    assert row["name"].startswith("φ = ")


def test_check_that_fails_exits_with_one_and_of_too_few_samples_with_two(path, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr("idealgas.analysis.check.FALSE_ALARM", 2.0)
        result = called("pressure", path, "--check")
    assert result.returncode == 1
    assert "do not agree" in result.stdout
    monkeypatch.setattr("idealgas.analysis.check.FEWEST", 1e6)
    result = called("pressure", path, "--check")
    assert result.returncode == 2
    assert result.stdout.splitlines()[-1].startswith("Too few samples to tell whether measurement and theory agree.")
    assert json.loads(called("pressure", path, "--check", "--json").stdout)["agrees"] is None


def test_a_histogram_in_csv_has_its_bins(path):
    rows = list(csv.DictReader(called("histogram", path, "--csv").stdout.splitlines()))
    names = ("edges", "density", "laws.Maxwell_Boltzmann")
    edges, value, law = (
        np.array([float(row["value"]) for row in rows if row["quantity"] == f"histogram.distributions.gas.{name}"])
        for name in names
    )
    assert value @ np.diff(edges) == pytest.approx(1, abs=1e-3)
    assert law @ np.diff(edges) == pytest.approx(1, abs=1e-2)

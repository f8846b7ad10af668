import csv
import json
from dataclasses import replace

import pytest
from helpers.support import called

from idealgas.analysis import registry
from idealgas.errors import UserError
from idealgas.scene import parse_scene
from idealgas.sweep.figure import sweep_figure
from idealgas.sweep.plan import Point, with_seed
from idealgas.sweep.point import log_path, points_folder, result_path, run_point
from idealgas.sweep.results import read_points, result_rows, stored_results, write_tables

SCENE = """
scene.seed = 4
box.size = [10, 10]
species = [{name = "gas", count = 20, radius = 0.3, temperature = 1.0}]
run.events = 2000
"""


ANALYSES = ("pressure", "temperature")


@pytest.fixture
def point(tmp_path):
    points_folder(tmp_path).mkdir()
    return Point(3, 1, 1, {"phi": 0.1, "species.x": [1, 2]}, parse_scene(SCENE))


def test_a_point_leaves_its_log_and_its_results(point, tmp_path):
    run_point(point, tmp_path, ANALYSES, True)
    assert sorted(path.name for path in points_folder(tmp_path).iterdir()) == ["0003.h5", "0003.json"]
    (result,) = read_points(tmp_path)
    assert (result["point"], result["replicate"], result["seed"]) == (3, 1, 4)
    assert set(result["analyses"]) == {"pressure", "temperature"}
    assert "seconds" not in result["summary"]
    assert parse_scene(result["scene"]) == parse_scene(SCENE)


def test_what_is_done_is_not_done_again(point, tmp_path):
    result_path(tmp_path, 3).write_text("as it was")
    run_point(point, tmp_path, ANALYSES, True)
    assert result_path(tmp_path, 3).read_text() == "as it was"
    assert not log_path(tmp_path, 3).exists()


def test_results_do_not_depend_on_what_a_dead_worker_left(point, tmp_path):
    run_point(point, tmp_path, ANALYSES, True)
    first = result_path(tmp_path, 3).read_bytes()
    result_path(tmp_path, 3).unlink()
    log_path(tmp_path, 3).rename(log_path(tmp_path, 3).with_suffix(".h5.part"))
    run_point(point, tmp_path, ANALYSES, False)
    assert result_path(tmp_path, 3).read_bytes() == first
    assert [path.name for path in points_folder(tmp_path).iterdir()] == ["0003.json"]


def test_the_table_is_tidy(point, tmp_path):
    run_point(point, tmp_path, ANALYSES, True)
    tables, _ = write_tables(tmp_path)
    with (tmp_path / "results.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0])[:5] == ["point", "replicate", "seed", "phi", "species.x"]
    by_name = {row["quantity"]: row for row in rows}
    assert len(by_name) == len(rows)
    assert all(part.isidentifier() or part.isdigit() for name in by_name for part in name.split("."))
    pairs = by_name["pressure.routes.pairs_virial.compressibility_factor"]
    assert pairs["group"] == "pairs, virial"
    ((values, origin),) = stored_results(tmp_path, "pressure")
    assert origin.label == "phi = 0.1, species.x = [1, 2]"
    z = registry.find("pressure").restored(values, origin).route("pairs, virial").compressibility_factor
    assert (float(pairs["value"]), float(pairs["theory"])) == (z.value, z.theory)
    assert pairs["species.x"] == "[1, 2]"
    assert by_name["temperature.species.gas.both"]["standard_error"]
    if len(tables) == 2:
        from pyarrow import parquet

        assert parquet.read_table(tables[1]).num_rows == len(rows)


def test_the_figure_shows_the_headline_with_its_theory(point, tmp_path):
    run_point(point, tmp_path, ANALYSES, False)
    run_point(replace(point, index=4, values={"phi": 0.2, "species.x": [1, 2]}), tmp_path, ANALYSES, False)
    (panel,) = sweep_figure(tmp_path).axes
    assert panel.get_ylabel() == "pressure: routes: 'pairs, virial': compressibility factor"
    assert panel.get_xlabel() == "packing fraction φ"
    assert [text.get_text() for text in panel.get_legend().get_texts()] == [
        "theory, at the points", "species.x = [1, 2]",
    ]  # fmt: skip
    (panel,) = sweep_figure(tmp_path, "temperature.species.gas.both").axes
    assert panel.get_ylabel() == "temperature: species: 'gas': both (energy)"
    with pytest.raises(UserError, match=r'did you mean "pressure\.area"'):
        sweep_figure(tmp_path, "pressure.aria")


def test_theory_has_markers_at_the_points_of_a_sweep_and_missing_runs_are_said(point, tmp_path):
    for k in range(4):
        values, scene = {"species.gas.temperature": 1 + k // 2}, with_seed(point.scene, k)
        run_point(replace(point, index=k, replicate=k % 2, values=values, scene=scene), tmp_path, ("pressure",), False)
    figure = sweep_figure(tmp_path, "pressure.routes.pairs_virial.pressure")
    (panel,) = figure.axes
    assert panel.get_xlabel() == "temperature of 'gas' (energy)"
    assert panel.get_ylabel() == "pressure: routes: 'pairs, virial': pressure (energy/length²)"
    (theory,) = [line for line in panel.lines if line.get_label() == "theory, at the points"]
    rows = [row for row in result_rows(tmp_path) if row["quantity"] == "pressure.routes.pairs_virial.pressure"]
    averages = [(rows[k]["theory"] + rows[k + 1]["theory"]) / 2 for k in (0, 2)]
    assert (theory.get_xdata().tolist(), theory.get_marker()) == ([1, 2], "x")
    assert theory.get_ydata().tolist() == pytest.approx(averages, rel=1e-12)
    assert theory.get_color() not in {line.get_color() for line in panel.lines if line is not theory}
    assert figure.get_suptitle() == ""
    (tmp_path / "sweep.toml").write_text("# sweep of 1189 points by idealgas\n[sweep]\n")
    assert sweep_figure(tmp_path).get_suptitle() == "1,185 of 1,189 runs are missing"
    done = called("pressure", tmp_path, "--plot", tmp_path / "z.svg")
    assert done.stderr == f"{tmp_path}: 1,185 of 1,189 runs are missing\n"
    assert "1,185 of 1,189 runs" in " ".join((tmp_path / "z.svg").read_text().split())


@pytest.mark.parametrize(
    ("key", "name"),
    [
        ("phi", "packing fraction φ"),
        ("species.gas.count", "count of 'gas'"),
        ("species.temperature", "species temperature (energy)"),
        ("box.left.temperature", "box left temperature (energy)"),
        ("run.until", "run until (time)"),
    ],
)
def test_axes_have_names_and_units(point, tmp_path, key, name):
    result = {"point": 0, "seed": 1, "combination": 0, "replicate": 0, "values": {key: 0.5}, "scene": SCENE}
    result_path(tmp_path, 0).write_text(json.dumps(result | {"summary": {"events": 7}, "analyses": {}}))
    (panel,) = sweep_figure(tmp_path).axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == (name, "run: events")


def test_folders_without_results_are_refused(point, tmp_path):
    with pytest.raises(UserError, match="contains no results of a sweep"):
        read_points(tmp_path)
    run_point(point, tmp_path, ("temperature",), True)
    with pytest.raises(UserError, match='does not include the analysis "pressure"'):
        list(stored_results(tmp_path, "pressure"))
    result_path(tmp_path, 3).write_text(json.dumps({})[:1])
    with pytest.raises(UserError, match="damaged results"):
        read_points(tmp_path)

"""Result files of points that a sweep did not write: each is one line, in every command that reads them."""

import json
import re

import pytest
from helpers.support import error_of

from idealgas.scene import parse_scene
from idealgas.sweep.folder import hold_folder
from idealgas.sweep.plan import Point
from idealgas.sweep.point import result_path, run_point

SCENE = """
scene.seed = 4
box.size = [10, 10]
species = [{name = "gas", count = 20, radius = 0.3, temperature = 1.0}]
run.events = 2000
"""

SWEEP = f"""
[sweep]
analyses = ["pressure"]
[base]
{SCENE.strip().replace("scene.seed = 4", "")}
"""


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Result file of a point."""
    folder = tmp_path_factory.mktemp("sweep")
    with hold_folder(folder):
        run_point(Point(0, 0, 0, {}, parse_scene(SCENE)), folder, ("pressure",), False)
    return result_path(folder, 0).read_text()


def put(*path_and_value):
    """Change of one value of the file."""

    def change(text):
        result = json.loads(text)
        *path, last, value = path_and_value
        node = result
        for step in path:
            node = node[step]
        node[last] = value
        return json.dumps(result)

    return change


ANY = [
    lambda _: "",
    lambda _: "[]",
    lambda _: "[" * 100_000,
    lambda text: text[:-100],
    lambda text: text.replace('"point"', '"number"'),
    put("point", "0"),
    put("point", 1),
    put("point", -1),
    put("seed", 1.5),
    put("combination", None),
    put("combination", 10**30),
    put("values", [1]),
    put("summary", 3),
    put("summary", "events", [1]),
    put("analyses", ["pressure"]),
    put("analyses", "pressure", None),
    put("analyses", "pressure", "caveats", 1),
    put("analyses", "pressure", {}),
    put("analyses", "pressure", "packing_fraction", float("nan")),
    put("analyses", "pressure", "packing_fraction", float("inf")),
    put("analyses", "pressure", "number", 10**400),
    put("analyses", "pressure", "routes", 0, "compressibility_factor", "value", "much"),
]
"""Changes that every reader refuses."""

IN_USE = [
    put("scene", ""),
    put("scene", "box = 3"),
    put("analyses", "pressure", "routes", 3),
    put("analyses", "pressure", "routes", [{}]),
    put("analyses", "pressure", "packing_fraction", "thick"),
    put("analyses", "pressure", "number", [1]),
]
"""Changes that a reader of the scene or of the analysis refuses."""


@pytest.mark.parametrize("change", [*ANY, *IN_USE])
def test_each_is_one_line_of_an_analysis(finished, tmp_path, change):
    with hold_folder(tmp_path / "out"):
        result_path(tmp_path / "out", 0).write_text(change(finished))
    assert re.search("damaged results|0000.json: scene", error_of("pressure", tmp_path / "out"))


@pytest.mark.parametrize("change", ANY)
def test_each_is_one_line_of_a_sweep(finished, tmp_path, change):
    (tmp_path / "plan.toml").write_text(SWEEP)
    with hold_folder(tmp_path / "out"):
        result_path(tmp_path / "out", 0).write_text(change(finished))
    assert "damaged results" in error_of("sweep", tmp_path / "plan.toml", "-o", tmp_path / "out")


@pytest.mark.parametrize("name", ["0.json", "00000.json", "0001.json", "٣.json"])
def test_a_file_under_another_name_is_refused(finished, tmp_path, name):
    with hold_folder(tmp_path / "out"):
        result_path(tmp_path / "out", 0).with_name(name).write_text(finished)
    assert "the file name does not match point 0" in error_of("pressure", tmp_path / "out")

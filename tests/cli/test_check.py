import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

IDEALGAS = shutil.which("idealgas", path=str(Path(sys.executable).parent)) or "idealgas"
CONFIGS = Path(__file__).parents[2] / "configs"


def check(*arguments, folder=None):
    return subprocess.run([IDEALGAS, "check", *map(str, arguments)], capture_output=True, text=True, cwd=folder)


def test_an_invalid_scene_is_refused_line_by_line(invalid_case, tmp_path):
    overrides = [argument for override in invalid_case.overrides for argument in ("--set", override)]
    result = check(invalid_case.path, *overrides, folder=tmp_path)
    assert result.returncode == 2
    assert result.stderr.splitlines() == invalid_case.lines
    assert result.stdout == ""
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["missing.toml", "."])
def test_an_unreadable_scene_is_one_line(name, tmp_path):
    result = check(name, folder=tmp_path)
    assert result.returncode == 2
    assert result.stderr.startswith(f"{name}: cannot be read (")
    assert result.stderr.count("\n") == 1


def test_a_shipped_scene_is_shown_in_full(shipped_scene):
    result = check(shipped_scene)
    assert (result.returncode, result.stderr) == (0, "")
    for part in ("[scene]", "[run]", "compression = ", "packing fraction φ", "wall hits per time", "rows in the log"):
        assert part in result.stdout
    assert result.stdout.endswith("effects: none beyond elastic discs and a reflecting box\n")


def test_json():
    result = check(CONFIGS / "mixture.toml", "--json", "--set", "species.heavy.count=100")
    assert result.returncode == 0
    found = json.loads(result.stdout)
    assert found["number"] == 900
    assert [(s["name"], s["number"]) for s in found["species"]] == [("light", 800), ("heavy", 100)]
    assert found["scene"]["species"][1]["count"] == 100
    assert found["effects"] == []
    assert found["rows"] > found["events"] > 0


def test_the_shown_scene_is_a_scene(tmp_path):
    shown = check(CONFIGS / "three-discs.toml").stdout
    copy = tmp_path / "copy.toml"
    copy.write_text(shown[: shown.index("Discs at the start")])
    assert check(copy).stdout == shown

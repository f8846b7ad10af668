"""What all commands that read a log have in common, through the real command: they write nothing but what is asked."""

import shutil

import h5py
import pytest
from helpers.support import ROOT, called, idealgas

COMMANDS = ("info", "histogram", "temperature", "pressure", "heat-capacity", "profile", "evolution")

commands = pytest.mark.parametrize("command", COMMANDS)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A log of 4 000 events, and files that are none."""
    folder = tmp_path_factory.mktemp("logs")
    scene = ROOT / "configs" / "mixture.toml"
    made = idealgas("run", scene, "-o", "run.h5", "--set", "run.events=4000", folder=folder)
    assert made.returncode == 0, made.stderr
    whole = (folder / "run.h5").read_bytes()
    (folder / "half.h5").write_bytes(whole[: len(whole) // 2])
    (folder / "start.h5").write_bytes(whole[:100])
    (folder / "empty.h5").touch()
    (folder / "noise.h5").write_bytes(bytes(range(256)) * 100)
    (folder / "text.h5").write_text("[box]\nsize = [1, 1]\n")
    (folder / "folder.h5").mkdir()
    with h5py.File(folder / "other.h5", "w") as other:
        other["x"] = [1.0, 2.0]
    return folder


def listing(folder):
    return {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}


@commands
@pytest.mark.slow
def test_results_only(command, folder):
    before = listing(folder)
    result = idealgas(command, "run.h5", folder=folder)
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout
    assert listing(folder) == before


@pytest.mark.parametrize("command", COMMANDS[1:])
def test_plot_and_window(command, folder, tmp_path):
    shutil.copy(folder / "run.h5", tmp_path)
    result = called(command, "run.h5", "--from", "0.5", "--to", "1", "--plot", "picture.png", folder=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["picture.png", "run.h5"]
    assert (tmp_path / "picture.png").read_bytes().startswith(b"\x89PNG")
    again = called(command, "run.h5", "--plot", "picture.png", folder=tmp_path)
    assert (again.returncode, again.stdout) == (2, "")
    assert again.stderr == "picture.png: already exists (use --force to overwrite)\n"


BAD = ("missing", "folder", "empty", "text", "noise", "other", "start", "half")


@pytest.mark.parametrize("name", BAD)
def test_a_file_that_is_not_a_log_is_the_same_line_for_all_commands(name, folder):
    """Where a folder may be one of a sweep, it is named as one without results."""
    before = listing(folder)
    lines = {}
    for command in COMMANDS:
        result = called(command, f"{name}.h5", folder=folder)
        assert (result.returncode, result.stdout, result.stderr.count("\n")) == (2, "", 1)
        lines[command] = result.stderr
    if name == "folder":
        assert {lines.pop(command) for command in ("pressure", "heat-capacity")} == {
            "folder.h5: holds no results of a sweep\n"
        }
    (line,) = set(lines.values())
    assert line.startswith(f"{name}.h5: ")
    assert listing(folder) == before

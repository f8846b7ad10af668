"""What all commands that read a log have in common, through the real command: they write nothing but what is asked."""

import shutil

import h5py
import pytest
from helpers.support import ROOT, called, idealgas

COMMANDS = ("info", "histogram", "temperature", "pressure", "heat-capacity")

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
def test_what_is_no_log_is_one_line(name, folder):
    before = listing(folder)
    result = called("info", f"{name}.h5", folder=folder)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.startswith(f"{name}.h5: ")
    assert result.stderr.count("\n") == 1
    assert listing(folder) == before


@pytest.mark.parametrize(
    ("command", "name"),
    [
        (command, name)
        for command in COMMANDS[1:]
        for name in BAD
        if not (name == "folder" and command in ("pressure", "heat-capacity"))
    ],
)
def test_all_commands_say_the_same(command, name, folder):
    first, result = (called(each, f"{name}.h5", folder=folder) for each in ("info", command))
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr == first.stderr
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize("command", ["pressure", "heat-capacity"])
def test_a_folder_that_is_no_sweep_is_one_line(command, folder):
    result = called(command, "folder.h5", folder=folder)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr == "folder.h5: holds no results of a sweep\n"


def test_a_picture_that_cannot_be_written(folder):
    result = called("pressure", "run.h5", "--plot", "missing/picture.png", folder=folder)
    assert result.returncode == 2
    assert result.stderr == "missing/picture.png: no folder missing\n"

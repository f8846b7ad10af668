"""Surroundings that others set: the same events come out, or one line that says what is wrong."""

import os
import shlex
import subprocess
import time
from pathlib import Path

import pytest
from click.testing import CliRunner
from helpers.support import IDEALGAS, ROOT, error_of, joined, output_of, same_rows
from idealgas_cli.main import main

from idealgas.log import open_log

CORNER = ROOT / "configs" / "corner.toml"
NOWHERE = {"HOME": "/proc/nowhere", "XDG_CACHE_HOME": "/proc/nowhere", "XDG_CONFIG_HOME": "/proc/nowhere"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a log."""
    folder = tmp_path_factory.mktemp("environment")
    output_of("run", CORNER, "-o", "run.h5", folder=folder)
    return folder


def events(path):
    with open_log(path) as log:
        return joined(log.chunks())


def with_few_files(*arguments, **environment):
    """The command as a process that may have 32 files open."""
    command = shlex.join([IDEALGAS, *map(str, arguments)])
    return subprocess.run(
        ["/bin/sh", "-c", f"ulimit -n 32; exec {command}"], env=os.environ | environment, capture_output=True, text=True
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "environment",
    [
        {"HDF5_USE_FILE_LOCKING": "TRUE", "NUMBA_DISABLE_JIT": "1", "PYTHONIOENCODING": "ascii"},
        {"HDF5_USE_FILE_LOCKING": "FALSE", "PYTHONIOENCODING": "latin-1"},
    ],
    ids=lambda environment: environment["HDF5_USE_FILE_LOCKING"],
)
def test_a_run_has_the_same_events(folder, tmp_path, environment):
    done = with_few_files("run", CORNER, "-o", tmp_path / "run.h5", **environment)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.isascii()
    assert same_rows(events(tmp_path / "run.h5"), events(folder / "run.h5"))


@pytest.mark.slow
def test_a_picture_without_a_home(folder, tmp_path):
    cache = {"NUMBA_CACHE_DIR": os.environ.get("NUMBA_CACHE_DIR", str(Path("~/.cache/idealgas").expanduser()))}
    done = with_few_files("evolution", folder / "run.h5", "--plot", tmp_path / "e.png", **NOWHERE, **cache)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "e.png").stat().st_size > 1000


@pytest.mark.parametrize("charset", ["ascii", "latin-1", "cp437"])
@pytest.mark.parametrize("command", ["check", "info", "evolution", "bench --help"])
def test_characters_that_a_terminal_does_not_have(folder, charset, command):
    name, *options = command.split()
    paths = {"check": [str(CORNER)], "bench": []}.get(name, [str(folder / "run.h5")])
    done = CliRunner(charset=charset).invoke(main, [name, *paths, *options])
    assert (done.exit_code, done.exception, done.stderr) == (0, None, "")
    assert done.stdout


@pytest.mark.parametrize("number", ["0", "-1", "many", ""])
def test_a_number_of_threads_that_is_none(folder, monkeypatch, number):
    monkeypatch.setenv("NUMBA_NUM_THREADS", number)
    line = error_of("info", "run.h5", folder=folder)
    assert line == f"NUMBA_NUM_THREADS: not a number of threads (got {number}; allowed a whole number >= 1)\n"


def test_a_current_folder_that_is_closed(folder, tmp_path):
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o555)
    if os.access(closed, os.W_OK):  # to root no folder on a disk is closed
        closed = Path("/proc")
    for command in (f"run {CORNER} -o out.h5", f"evolution {folder}/run.h5 --plot out.png"):
        assert "cannot be written" in error_of(*command.split(), folder=closed, code=1)
    output_of("info", folder / "run.h5", folder=closed)


def test_the_clock_on_the_wall_is_not_asked(folder, tmp_path, monkeypatch):
    """It may be set while a run goes on; only when a log was made is told by it."""

    def back():
        nonlocal now
        now -= 1e6
        return now

    now = time.time()
    monkeypatch.setattr(time, "time", back)
    output_of("run", CORNER, "-o", "run.h5", folder=tmp_path)
    output_of("follow", "run.h5", folder=tmp_path)
    assert same_rows(events(tmp_path / "run.h5"), events(folder / "run.h5"))
    assert now > 0, "asked"

"""`resume`, `recover`, `follow` and `export` as commands."""

import resource
import signal
import subprocess
import time
from functools import partial

import h5py
import pytest
from helpers.support import IDEALGAS, ROOT, called, idealgas, output_of, wait_for_rows

from idealgas.log import open_log

QUICKSTART = ROOT / "configs" / "quickstart.toml"
LONG = ("--set", "run.collisions_per_disc=1e6")


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    path = tmp_path_factory.mktemp("finished") / "run.h5"
    output_of("run", QUICKSTART, "-o", path, "--set", "run.events=6000")
    return path


@pytest.fixture
def copy(finished, tmp_path):
    (tmp_path / "run.h5").write_bytes(finished.read_bytes())
    return tmp_path / "run.h5"


def start_run(path, rows=200_000):
    """A run that goes on for long, once it has so many rows on record."""
    child = subprocess.Popen([IDEALGAS, "run", QUICKSTART, "-o", path, *LONG], stdout=subprocess.DEVNULL)
    wait_for_rows(path, rows, child)
    return child


@pytest.fixture(scope="module")
def dead(tmp_path_factory):
    """A log whose writer was killed."""
    path = tmp_path_factory.mktemp("dead") / "run.h5"
    child = start_run(path)
    child.send_signal(signal.SIGKILL)
    child.wait()
    return path


def test_resume_to_a_later_end(copy):
    assert "9,000" in output_of("resume", copy, "--events", "9e3")
    with open_log(copy) as log:
        assert (log.scene.run.events, log.scene.run.collisions_per_disc) == (9000, None)
        assert log.summary["events"] == 9000


@pytest.mark.slow
def test_reading_a_dead_writers_log_says_so(dead):
    for command in (("info",), ("temperature", "--from", 0), ("follow", "--once")):
        result = called(command[0], dead, *command[1:])
        assert result.returncode == 0, result.stderr
        if command[0] == "follow":
            assert "not closed (crash?)" in result.stdout
        else:
            assert result.stderr.startswith(f"{dead}: was not closed (crash?); ")
            assert result.stderr.count("\n") == 1


def test_recover(dead, tmp_path):
    copy = tmp_path / "copy.h5"
    result = called("recover", dead, "-o", copy)
    with open_log(copy) as log:
        assert (result.returncode, result.stdout) == (0, f"{copy}: {len(log):,} event rows kept\n")
    with h5py.File(copy) as file:
        assert len(file["events/time"]) >= 200_000
    assert called("info", copy).stderr == ""
    assert called("recover", dead, "-o", copy).returncode == 2


@pytest.mark.slow
def test_follow_ends_with_the_run(tmp_path):
    path = tmp_path / "run.h5"
    child = start_run(path)
    try:
        once = idealgas("follow", path, "--once")
        assert "running" in once.stdout
        follower = subprocess.Popen([IDEALGAS, "follow", path], stdout=subprocess.PIPE, text=True)
        time.sleep(2)
        assert follower.poll() is None
    finally:
        child.send_signal(signal.SIGINT)
        child.wait(60)
    printed, _ = follower.communicate(timeout=60)
    assert follower.returncode == 0
    for part in ("interrupted", "temperature", "events per second", "Z = PA/NT", "KS distance", "│ Maxwell-Boltzmann"):
        assert part in printed


def test_follow_shows_what_is_complete(finished):
    shown = output_of("follow", finished)
    assert "complete" in shown
    assert "6,000" in shown


def test_export_by_the_ending_of_the_file(copy, tmp_path):
    shown = output_of("export", copy, "--frames", 3, "-o", tmp_path / "gas.extxyz")
    assert shown == f"{tmp_path / 'gas.extxyz'}: 3 frames\n"
    assert output_of("export", copy, "--frames", 2, "-o", tmp_path / "x.gsd") == f"{tmp_path / 'x.gsd'}: 2 frames\n"
    output_of("export", copy, "--frames", 2, "-o", tmp_path / "gas.csv")
    head, *rows = (tmp_path / "gas.csv").read_text().splitlines()
    assert head == '"time","disc","species","radius","mass","x","y","vx","vy"'
    assert len(rows) == 2000
    shown = output_of("export", copy, "--format", "extxyz", "--frames", "every=0.5")
    assert shown.startswith(f"{copy.with_suffix('.extxyz')}: ")
    assert copy.with_suffix(".extxyz").read_text().startswith("1000\nLattice=")


@pytest.mark.parametrize("arguments", [("csv", "--events"), ("csv", "--frames", 3), ("extxyz", "--frames", 3)])
@pytest.mark.slow
def test_export_to_a_pipe(copy, arguments):
    """The same as in a file, and not a word more."""
    piped = idealgas("export", copy, "--format", *arguments, "-o", "-")
    filed = idealgas("export", copy, "--format", *arguments, "-o", copy.with_name("file." + arguments[0]))
    assert (piped.returncode, filed.returncode) == (0, 0)
    assert piped.stdout == copy.with_name("file." + arguments[0]).read_text()
    assert piped.stderr.startswith("-: ")
    assert not (copy.parent / "-").exists()


def test_export_to_a_reader_who_goes(copy):
    ended = subprocess.run(
        ["bash", "-c", '"$0" export "$1" --format csv --events -o - | head -1; echo ${PIPESTATUS[0]}', IDEALGAS, copy],
        capture_output=True,
        text=True,
    )
    header, code = ended.stdout.splitlines()
    assert header.startswith('"time"')
    assert (code, ended.stderr) == ("141", "")


def test_resume_on_a_full_disk(copy):
    """RLIMIT_FSIZE stands for a disk without room."""
    limit = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (20_000_000, resource.RLIM_INFINITY))
    result = subprocess.run(
        [IDEALGAS, "resume", copy, "--events", "400000"], capture_output=True, text=True, preexec_fn=limit
    )
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr == f"{copy}: cannot be written: File too large\n"
    with open_log(copy) as log:
        assert len(log) > 6000
    output_of("resume", copy)
    with open_log(copy) as log:
        assert log.complete

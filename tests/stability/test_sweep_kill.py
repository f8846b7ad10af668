"""Sweeps whose workers or scheduler are killed, or that share a scheduler: every point has its own result."""

import contextlib
import json
import random
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest
from helpers.support import IDEALGAS

pytestmark = pytest.mark.long

HISTORIES = 20

SWEEP = """
[sweep]
seed = {seed}
replicates = 4
keep_logs = false
[[axis]]
key = "species.temperature"
values = {temperatures}
[base]
box.size = [10, 10]
species = [{{name = "gas", count = 20, radius = 0.3, temperature = 1.0}}]
run.events = {events}
"""


def plan(path: Path, temperatures: list[int], seed: int = 3, events: int = 60_000) -> Path:
    path.write_text(SWEEP.format(temperatures=temperatures, seed=seed, events=events))
    return path


def start(plan: Path, folder: Path, *options: str) -> subprocess.Popen:
    command = [IDEALGAS, "sweep", str(plan), "-o", str(folder), *options]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def finished(plan: Path, folder: Path, *options: str) -> dict[str, bytes]:
    """Run a sweep to its end, and return its files by their names."""
    running = start(plan, folder, *(options or ("--workers", "1")))
    _, stderr = running.communicate(timeout=300)
    assert (running.returncode, stderr) == (0, "")
    return results(folder)


def results(folder: Path) -> dict[str, bytes]:
    """Files of a sweep, by their names; none is left unfinished."""
    paths = [path for path in folder.rglob("*") if path.is_file() and path.suffix != ".parquet"]
    assert not [
        path for path in paths if path.name.endswith(".part") or (path.name.startswith(".") and path.stem != ".lock")
    ]
    return {path.name: path.read_bytes() for path in paths}


def wait_for_points(running: subprocess.Popen, folder: Path, number: int) -> None:
    while running.poll() is None and len(list(folder.glob("points/*.json"))) < number:
        time.sleep(0.005)


@contextlib.contextmanager
def scheduler(folder: Path) -> Iterator[tuple[str, subprocess.Popen]]:
    """A scheduler with one worker: its address and its process."""
    file = folder / "scheduler.json"
    file.unlink(missing_ok=True)
    programs = ("scheduler --no-dashboard --port 0 --host 127.0.0.1", "worker --no-dashboard --no-nanny --nthreads 1")
    with contextlib.ExitStack() as stack:
        started = []
        for program in programs:
            command = [sys.executable, "-m", "dask", *program.split(), "--scheduler-file", str(file)]
            started.append(stack.enter_context(subprocess.Popen(command, stdout=-3, stderr=-3, cwd=folder)))
            stack.callback(started[-1].kill)
            while not (file.exists() and file.stat().st_size):
                assert started[0].poll() is None
                time.sleep(0.02)
        yield json.loads(file.read_text())["address"], started[0]


def test_two_sweeps_at_once_on_one_scheduler(tmp_path):
    plans = [plan(tmp_path / "a.toml", [1, 2], 1, 500), plan(tmp_path / "b.toml", [3, 4, 5], 2, 500)]
    alone = [finished(path, tmp_path / f"alone-{path.stem}") for path in plans]
    assert [len(files) for files in alone] == [8 + 3, 12 + 3]
    with scheduler(tmp_path) as (address, _):
        for k in range(HISTORIES):
            folders = [tmp_path / f"{path.stem}-{k}" for path in plans]
            running = [start(*both, "--scheduler", address) for both in zip(plans, folders, strict=True)]
            for process, number in zip(running, (8, 12), strict=True):
                stdout, stderr = process.communicate(timeout=300)
                assert (process.returncode, stderr) == (0, "")
                assert stdout.startswith(f"{number} points run, 0 done before, 0 failed")
            assert [results(folder) for folder in folders] == alone


def test_sweeps_whose_workers_are_killed(tmp_path):
    path = plan(tmp_path / "sweep.toml", [1, 2])
    alone, chance = finished(path, tmp_path / "alone"), random.Random(1)
    for k in range(HISTORIES):
        running = start(path, folder := tmp_path / f"{k}", "--workers", "1")
        wait_for_points(running, folder, chance.randrange(7))
        time.sleep(0.2 * chance.random())
        if running.poll() is None:
            for child in psutil.Process(running.pid).children(recursive=True):
                with contextlib.suppress(psutil.Error):
                    if any("spawn_main" in word for word in child.cmdline()):
                        child.kill()
        _, stderr = running.communicate(timeout=300)
        assert "Traceback" not in stderr
        assert finished(path, folder) == alone


def test_sweeps_whose_scheduler_is_killed(tmp_path):
    path = plan(tmp_path / "sweep.toml", [1, 2])
    alone, chance = finished(path, tmp_path / "alone"), random.Random(2)
    for k in range(HISTORIES):
        with scheduler(tmp_path) as (address, process):
            running = start(path, folder := tmp_path / f"{k}", "--scheduler", address)
            wait_for_points(running, folder, chance.randrange(7))
            time.sleep(0.2 * chance.random())
            process.kill()
            _, stderr = running.communicate(timeout=300)
        assert "Traceback" not in stderr
        assert stderr.count("\n") <= 1
        assert finished(path, folder) == alone

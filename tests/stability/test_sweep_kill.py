"""Sweeps whose workers, scheduler or disk die, or that share a scheduler: every point has its result in the end."""

import contextlib
import random
import time
from pathlib import Path

import pytest
from helpers.log_compare import differences
from helpers.support import idealgas, small_disk
from helpers.sweeps import scheduler, start, wait_for, workers_of

pytestmark = pytest.mark.slow

HISTORIES = 20
IN_CI = (3, 12, 19)
"""Histories that .ci/slow runs; all others of HISTORIES are run by hand, with -m long."""

each_history = pytest.mark.parametrize(
    "history", [pytest.param(k, marks=() if k in IN_CI else pytest.mark.long) for k in range(HISTORIES)]
)

SWEEP = """
[sweep]
seed = {seed}
replicates = 3
keep_logs = {keep_logs}
[[axis]]
key = "species.temperature"
values = {temperatures}
[base]
box.size = [10, 10]
species = [{{name = "gas", count = 20, radius = 0.3, temperature = 1.0}}]
run.events = {events}
"""
POINTS = 6
QUICK = 5_000  # events of a point whose duration does not matter

TIMEOUT = 300  # seconds in which every sweep ends


def plan(folder: Path, *temperatures: int, seed: int = 3, events: int = 100_000, keep_logs: bool = False) -> Path:
    """Write the file of a sweep into a folder."""
    path = folder / "sweep.toml"
    settings = {"seed": seed, "events": events, "keep_logs": str(keep_logs).lower()}
    path.write_text(SWEEP.format(temperatures=list(temperatures) or [1, 2], **settings))
    return path


def number_done(folder: Path) -> int:
    return len(list(folder.glob("points/*.json")))


def finished(plan: Path, folder: Path) -> dict[str, bytes]:
    """Run a sweep to its end, and return its files by their names."""
    done = idealgas("sweep", plan, "-o", folder, "--workers", 1)
    print(done.stdout.partition(":")[0])
    assert (done.returncode, done.stderr) == (0, "")
    return results(folder)


def results(folder: Path) -> dict[str, bytes]:
    """Files of a sweep but for its logs, by their names; none is left unfinished."""
    paths = [path for path in folder.rglob("*") if path.is_file() and path.name != ".lock"]
    assert not [path for path in paths if path.suffix == ".part" or path.name.startswith(".")]
    return {path.name: path.read_bytes() for path in paths if path.suffix != ".h5"}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Files of the sweep that nothing disturbs."""
    folder = tmp_path_factory.mktemp("undisturbed")
    files = finished(plan(folder), folder / "out")
    assert {f"{k:04d}.json" for k in range(POINTS)} | {"results.csv"} <= set(files)
    return files


@each_history
def test_workers_are_killed(history, undisturbed, tmp_path):
    """Up to four times, so that a point may also fail for good, or while they start."""
    path, folder, chance = plan(tmp_path), tmp_path / "out", random.Random(history)
    running, killed = start(path, folder), 0
    for _ in range(chance.choice((1, 1, 2, 4))):
        before = chance.randrange(POINTS)
        while running.poll() is None and not (number_done(folder) >= before and workers_of(running)):
            time.sleep(0.002)
        time.sleep(0.3 * chance.random())
        for worker in workers_of(running):
            worker.kill()
            worker.wait(TIMEOUT)
            killed += 1
    stdout, stderr = running.communicate(timeout=TIMEOUT)
    print(f"{killed} workers killed, exit code {running.returncode}: {stdout.partition(':')[0]} {stderr}")
    assert killed
    assert running.returncode == bool(stderr)
    ends = " failed: its worker died 3 times", "(Nanny failed to start); run the same command again to continue"
    assert all(line.endswith(ends) for line in stderr.splitlines())
    assert finished(path, folder) == undisturbed


@each_history
def test_the_scheduler_is_killed(history, undisturbed, tmp_path):
    """Either a scheduler to which the sweep is connected, or the process of the sweep, which contains its scheduler."""
    path, folder, chance = plan(tmp_path), tmp_path / "out", random.Random(history)
    with scheduler(tmp_path) if history % 2 else contextlib.nullcontext((None, None)) as (address, process):
        running = start(path, folder, *(("--scheduler", address) if address else ()))
        before = chance.randrange(POINTS)
        wait_for(lambda: number_done(folder) >= before and folder.exists(), running)
        time.sleep((0.2 if before else 4) * chance.random())  # without a point, processes may still be starting
        assert running.poll() is None
        (process or running).kill()
        if process:
            stdout, stderr = running.communicate(timeout=TIMEOUT)
            assert (running.returncode, stdout) == (2, "")
            assert stderr in (
                "lost the connection to the scheduler; run the same command again to continue\n",
                f"{address}: no scheduler answered within 10 s\n",
            )
    print(f"{'scheduler' if process else 'sweep'} killed after {number_done(folder)} points")
    assert finished(path, folder) == undisturbed  # at once: workers of a sweep that was killed may still be running
    running.communicate(timeout=TIMEOUT)


@pytest.fixture(scope="module")
def undisturbed_with_logs(tmp_path_factory):
    """Folder of a sweep that nothing disturbs, and its files."""
    folder = tmp_path_factory.mktemp("undisturbed")
    return folder / "out", finished(plan(folder, events=QUICK, keep_logs=True), folder / "out")


@pytest.mark.needs("a disk to mount")
@each_history
def test_the_disk_is_full(history, undisturbed_with_logs, tmp_path):
    """At any time between the first file and the last one."""
    alone, files = undisturbed_with_logs
    pages = sum(-(-path.stat().st_size // 4096) for path in alone.rglob("*") if path.is_file())
    path, disk = plan(tmp_path, events=QUICK, keep_logs=True), tmp_path / "disk"
    kilobytes = 4 * (1 + history * (pages - 2) // (HISTORIES - 1))
    with small_disk(disk, kilobytes) as resize:
        done = idealgas("sweep", path, "-o", disk / "out", "--workers", 1)
        print(f"{kilobytes} of {4 * pages} kB, exit code {done.returncode}: {done.stderr}")
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
        assert done.stderr.startswith(f"{disk / 'out'}")
        assert "cannot be written: No space left on device" in done.stderr
        assert not list((disk / "out").rglob("*.part"))
        resize(100_000)
        assert finished(path, disk / "out") == files
        for log in (alone / "points").glob("*.h5"):
            assert differences(log, disk / "out" / "points" / log.name) == []


@pytest.mark.long
def test_two_sweeps_at_once_on_one_scheduler(tmp_path):
    """Every point of both has its result."""
    folders = [tmp_path / name for name in "ab"]
    for folder in folders:
        folder.mkdir()
    plans = [plan(folders[0], 1, 2, seed=1, events=500), plan(folders[1], 3, 4, 5, seed=2, events=500)]
    alone = [finished(path, path.parent / "alone") for path in plans]
    with scheduler(tmp_path) as (address, _):
        for k in range(HISTORIES):
            running = [start(path, path.parent / str(k), "--scheduler", address) for path in plans]
            for process, number in zip(running, (6, 9), strict=True):
                stdout, stderr = process.communicate(timeout=TIMEOUT)
                assert (process.returncode, stderr) == (0, "")
                assert stdout.startswith(f"{number} points run, 0 done before, 0 failed")
            assert [results(path.parent / str(k)) for path in plans] == alone

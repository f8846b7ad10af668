"""Sweeps as a user starts, kills and continues them."""

import contextlib
import csv
import json
import os
import resource
import shutil
import signal
from pathlib import Path

import pytest
from helpers.support import called, error_of, idealgas, output_of
from helpers.sweeps import start, wait_for

from idealgas.analysis import registry
from idealgas.sweep.run import Outcome, SweepProgress

SWEEP = """
[sweep]
seed = 3
replicates = 3
analyses = ["pressure"]
keep_logs = false
[[axis]]
key = "phi"
values = [0.02, 0.1]
[base]
box.size = [10, 10]
species = [{name = "gas", count = 20, radius = 0.3, temperature = 1.0}]
run.events = 2000
"""


INTERRUPTED = "interrupted; run the same command again to continue\n"


@pytest.fixture
def plan(tmp_path):
    path = tmp_path / "sweep.toml"
    path.write_text(SWEEP)
    return path


def results(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.rglob("*")) if path.suffix in (".json", ".csv")}


@pytest.mark.slow
def test_workers_make_no_difference_and_nothing_is_done_twice(plan, tmp_path):
    for workers in (1, 2):
        done = idealgas("sweep", plan, "-o", tmp_path / f"with-{workers}", "--workers", workers)
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
        assert done.stdout.startswith("6 points run, 0 done before, 0 failed")
    result, two = (results(tmp_path / f"with-{workers}") for workers in (1, 2))
    assert len(result) == 7
    assert result == two
    (tmp_path / "with-2" / "points" / "0004.json").unlink()
    plan.write_text(SWEEP.replace("[0.02, 0.1]", "[0.05, 0.02, 0.1]"))
    again = idealgas("sweep", plan, "-o", tmp_path / "with-2")
    assert again.stdout.startswith("4 points run, 5 done before, 0 failed")
    more = results(tmp_path / "with-2")
    assert len(more) == 11
    assert more["results.previous-1.csv"] == result["results.csv"]  # of the points of the first plan
    assert all(more[name] == result[name] for name in result if name not in ("results.csv", "0004.json"))
    table = idealgas("pressure", tmp_path / "with-1", "--check")
    assert table.returncode == 0, table.stderr
    assert "Measurement and theory agree." in table.stdout


@pytest.mark.slow
def test_failing_points_do_not_stop_the_others(plan, tmp_path):
    plan.write_text(SWEEP.replace("[0.02, 0.1]", "[0.02, 0.64]").replace("count = 20", "count = 3"))
    done = idealgas("sweep", plan, "-o", tmp_path / "out", "--workers", 1)
    assert done.returncode == 1
    assert done.stdout.startswith("3 points run, 0 done before, 3 failed")
    lines = done.stderr.splitlines()
    assert len(lines) == 3
    assert all(
        line.startswith(f"point {k} failed: ") and "no room" in line for k, line in zip((3, 4, 5), lines, strict=True)
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        pytest.param(
            ("-o", "out", "--scheduler", "tcp://127.0.0.1:9"),
            "tcp://127.0.0.1:9: no scheduler answered within 10 s",
            marks=pytest.mark.slow,
        ),
        (("-o", "out", "--scheduler", "nowhere"), "nowhere: not the address of a scheduler"),
        (
            ("-o", "out", "--scheduler", "tls://127.0.0.1:9"),
            "tls://127.0.0.1:9: not the address of a scheduler (TLS needs certificates, distributed.comm.tls in dask's",
        ),
        ((), "-o DIR: missing"),
    ],
)
def test_bad_input_is_one_line(plan, tmp_path, arguments, message):
    assert message in error_of("sweep", plan, *arguments, folder=tmp_path)


def test_a_dry_run_has_the_axes_in_their_order_also_as_json(plan, tmp_path):
    assert "6 points, about" in output_of("sweep", plan, "-o", tmp_path / "out", "--dry-run")
    assert not (tmp_path / "out").exists()
    plan.write_text(SWEEP.replace("[base]", '[[axis]]\nkey = "species.gas.count"\nvalues = [20, 30]\n[base]'))
    shown = output_of("sweep", plan, "--dry-run")
    head, first = (line.split() for line in shown.splitlines()[1:4:2])
    assert [word for word in head if word != "┃"][:4] == ["point", "replicate", "phi", "species.gas.count"]
    assert [word for word in first if word != "│"][:4] == ["0", "0", "0.02", "20"]
    result = json.loads(called("sweep", plan, "--dry-run", "--json").stdout)
    assert [point["values"] for point in result["points"][::6]] == [
        {"phi": 0.02, "species.gas.count": 20},
        {"phi": 0.1, "species.gas.count": 20},
    ]


def test_the_quantities_are_listed():
    listed = output_of("sweep", "--list").splitlines()
    assert {"pressure.routes.*.compressibility_factor", "temperature.species.*.both", "pressure.area"} <= set(listed)
    assert {line.partition(".")[0] for line in listed} == set(registry.names())
    assert "SWEEP.toml: missing" in error_of("sweep")


@pytest.mark.slow
def test_all_that_people_want_of_a_sweep(plan, tmp_path):
    """Every kind of analysis in the table, its caveats, the time beside its estimate, JSON, and a picture."""
    text = SWEEP.replace('["pressure"]', '["pressure", "profile", "evolution"]')
    plan.write_text(text.replace("replicates = 3", "replicates = 2"))
    shown = output_of("sweep", plan, "-o", tmp_path / "out", "--workers", 1, "--plot", tmp_path / "z.png")
    counts, timing, picture = shown.splitlines()
    assert counts.startswith("4 points run, ")
    assert timing.startswith("time: ")
    assert " (estimate " in timing
    assert picture == f"{tmp_path / 'z.png'}: written"
    expected = {".lock", "points", "results.csv", "results.parquet", "sweep.toml"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == expected  # logs of short runs are gone
    assert (tmp_path / "z.png").stat().st_size > 5000
    with (tmp_path / "out" / "results.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["quantity"].partition(".")[0] for row in rows} == {"run", "pressure", "profile", "evolution"}
    assert list(rows[0])[-1] == "caveats"
    again = called("sweep", plan, "-o", tmp_path / "out", "--json")
    result = json.loads(again.stdout)
    assert (result["ran"], result["before"], len(result["results"])) == (0, 4, len(rows))
    for option, name in (("--of", "pressure.area"), ("--against", "phi")):
        wrong = error_of("sweep", plan, "-o", tmp_path / "out", "-q", "--plot", tmp_path / "y.png", option, f"{name}s")
        assert f'did you mean "{name}"' in wrong
    assert not (tmp_path / "y.png").exists()


@pytest.mark.parametrize("later", ["a point", "the tables"])
def test_a_ctrl_c_that_another_package_loses_is_not_lost(plan, tmp_path, monkeypatch, later):
    def run_sweep(*_, on_progress, **__):
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        if later == "a point":
            on_progress(SweepProgress(1, 0, 6))
        return Outcome(0, 0, {})

    monkeypatch.setattr("idealgas.sweep.run.run_sweep", run_sweep)
    before = signal.getsignal(signal.SIGINT)
    done = called("sweep", plan, "-o", tmp_path / "out")
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == INTERRUPTED
    assert signal.getsignal(signal.SIGINT) == before


@pytest.mark.parametrize("options", [(), ("--dry-run",)])
def test_without_the_extra_one_line_names_it(plan, tmp_path, monkeypatch, options):
    monkeypatch.setattr("idealgas.sweep.run.find_spec", lambda name: None)
    done = called("sweep", plan, "-o", tmp_path / "out", *options)
    assert done.returncode == 2
    assert done.stderr == 'a sweep requires dask.distributed: .venv/bin/pip install -e ".[sweep]" in the top folder\n'
    assert not (tmp_path / "out").exists()


LONGER = SWEEP.replace("run.events = 2000", "run.events = 200_000").replace("replicates = 3", "replicates = 4")
"""Eight points of some tenths of a second each: whatever is waited for at one of them, others are still to come."""


@pytest.mark.parametrize("group", [True, False], ids=["group", "process"])
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM], ids=lambda how: how.name)
@pytest.mark.slow
def test_a_sweep_that_was_stopped_goes_on_where_it_stopped(plan, tmp_path, how, group):
    """Terminals and batch systems send a signal to the whole group of processes, `kill` and `timeout` to one."""
    plan.write_text(LONGER)
    running = start(plan, tmp_path / "out")
    points = tmp_path / "out" / "points"
    wait_for((points / "0002.json").exists, running)
    (os.killpg if group else os.kill)(running.pid, how)
    stdout, stderr = running.communicate(timeout=60)
    if how != signal.SIGKILL:
        assert (running.returncode, stdout, stderr) == (128 + how, "", INTERRUPTED)  # none of leaked semaphores either
    before = {path.name: path.stat().st_mtime_ns for path in points.glob("*.json")}
    assert 0 < len(before) < 8
    again = idealgas("sweep", plan, "-o", tmp_path / "out")
    assert (again.returncode, again.stderr) == (0, "")
    assert again.stdout.startswith(f"{8 - len(before)} points run, {len(before)} done before, 0 failed")
    assert all((points / name).stat().st_mtime_ns == at for name, at in before.items())


@pytest.mark.slow
def test_a_folder_that_goes_while_a_sweep_is_running_in_it(plan, tmp_path):
    plan.write_text(LONGER.replace("200_000", "2_000_000"))
    folder = tmp_path / "out"
    running = start(plan, folder)
    wait_for(lambda: (folder / "points" / "0000.json").exists(), running)
    assert error_of("sweep", plan, "-o", folder) == f"{folder}: another sweep is running in this folder\n"
    shutil.rmtree(folder, ignore_errors=True)
    stdout, stderr = running.communicate(timeout=60)
    assert (running.returncode, stdout) == (1, "")
    assert (stderr.count("\n"), str(folder) in stderr) == (1, True)


@pytest.mark.slow
def test_a_full_disk_ends_a_sweep_which_goes_on_later(plan, tmp_path):
    """A limit of the size of a file stands for it: the larger points do not fit."""
    plan.write_text(SWEEP.replace('"phi"\nvalues = [0.02, 0.1]', '"run.events"\nvalues = [2000, 200_000]'))
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000, limit[1]))
    try:
        done = idealgas("sweep", plan, "-o", tmp_path / "out", "--workers", 1)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.endswith("cannot be written: File too large; run the same command again to continue\n")
    assert done.stderr.count("\n") == 1
    again = idealgas("sweep", plan, "-o", tmp_path / "out")
    assert again.stdout.startswith("3 points run, 3 done before, 0 failed")

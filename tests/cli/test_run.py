"""`idealgas run` as a user meets it: what is printed, what is written, and what is refused."""

import json
import resource
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from helpers.support import IDEALGAS, ROOT, called, error_of, idealgas, output_of, wait_for_rows

from idealgas.log import open_log

CORNER = ROOT / "configs" / "corner.toml"
ENDLESS = """
box.size = [30, 30]
run.until = 1e9
species = [{ name = "gas", count = 100, radius = 0.5, temperature = 1, placement = "lattice" }]
"""


def test_summary_and_json(tmp_path):
    shown = output_of("run", CORNER, "-o", "run.h5", folder=tmp_path)
    for part in ("run.h5", "events", "8", "simulated time", "energy drift", "wall time", "file size"):
        assert part in shown
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]
    result = idealgas("run", CORNER, "-o", "other.h5", "--json", folder=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    summary = json.loads(result.stdout)
    assert (summary["events"], summary["disc_collisions"], summary["wall_hits"]) == (8, 2, 6)
    assert (summary["completed"], summary["end_time"], summary["rows"]) == (True, 10.0, 10)
    with open_log(tmp_path / "other.h5") as log:
        assert log.summary == summary
        assert log.command == f"idealgas run {CORNER} -o other.h5 --json"


def test_overrides_come_last(tmp_path):
    overrides = ("--set", "run.until=2", "--set", "run.events=3")
    result = called("run", CORNER, "-o", "run.h5", "--json", *overrides, folder=tmp_path)
    assert json.loads(result.stdout)["events"] == 3
    with open_log(tmp_path / "run.h5") as log:
        assert (log.scene.run.until, log.scene.run.events) == (2.0, 3)


NO_LOG = "is not a log of idealgas and will not be overwritten"


def test_an_existing_output_and_a_scene_are_left_alone(tmp_path):
    output = tmp_path / "run.h5"
    output.write_bytes(b"precious")
    for force, why in (((), "already exists (use --force to overwrite)"), (("--force",), NO_LOG)):
        assert error_of("run", CORNER, "-o", "run.h5", *force, folder=tmp_path) == f"run.h5: {why}\n"
    assert output.read_bytes() == b"precious"
    output.unlink()
    for _ in range(2):
        output_of("run", CORNER, "-o", "run.h5", "--force", folder=tmp_path)
    with open_log(output) as log:
        assert len(log) == 10
    scene = Path(shutil.copy(CORNER, tmp_path))
    (tmp_path / "link.h5").symlink_to(scene)
    for name in (scene.name, "link.h5"):
        line = error_of("run", scene.name, "-o", name, "--force", folder=tmp_path)
        assert line == f"{name}: output would overwrite the input\n"
    assert scene.read_bytes() == Path(CORNER).read_bytes()


@pytest.mark.parametrize(("compression", "limit"), [("gzip", 10_000_000), ("none", 20_000_000)])
def test_no_room_left_is_one_line_and_keeps_the_rows_so_far(tmp_path, compression, limit):
    """RLIMIT_FSIZE stands for a full disk."""
    (tmp_path / "scene.toml").write_text(ENDLESS)
    result = subprocess.run(
        [IDEALGAS, "run", "scene.toml", "-o", "run.h5", "--set", f"log.compression={compression}"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
    )
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr == "run.h5: cannot be written: File too large\n"
    with open_log(tmp_path / "run.h5") as log:
        assert not log.complete
        assert sum(len(block.time) for block in log.chunks()) == len(log) > 50_000


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM], ids=lambda how: how.name)
def test_a_signal_ends_the_run_with_a_readable_log(tmp_path, how):
    (tmp_path / "scene.toml").write_text(ENDLESS)
    output = tmp_path / "run.h5"
    command = [IDEALGAS, "run", "scene.toml", "-o", "run.h5"]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        wait_for_rows(output, 10_000, process)
        process.send_signal(how)
        stdout, stderr = process.communicate(timeout=60)
    assert (process.returncode, stderr) == (128 + how, "interrupted; `idealgas resume run.h5` continues it\n")
    assert "run.h5 (interrupted)" in stdout
    with open_log(output) as log:
        assert not log.complete
        assert not log.unclosed
        assert log.summary == {}
        assert sum(len(block.time) for block in log.chunks()) == len(log) > 0
        assert log.state_at(log.end_time).time == log.end_time
    assert "interrupted" in output_of("info", "run.h5", folder=tmp_path)


@pytest.mark.slow
def test_a_clock_that_stands_still_is_one_line(tmp_path):
    """A gate closes over a disc at the top of its flight: at rest, it collides with it without end."""
    (tmp_path / "scene.toml").write_text("""
disc = [{ position = [2.4, 0.55], velocity = [0.1, 0.1], radius = 0.2 }]
wall = [{ from = [0, 0.5], to = [6, 0.5], closes_at = 0.1 }]
box.size = [6, 1.5]
gravity.acceleration = [0, -1]
run = { until = 3, method = "brute_force" }
""")
    result = idealgas("run", "scene.toml", "-o", "run.h5", folder=tmp_path)
    assert result.returncode == 2
    assert result.stderr.splitlines()[-1].startswith("after t = 0.1: the clock stands still: a disc collides without")
    output_of("info", "run.h5", folder=tmp_path)


WIDE = "box.size = [1, 10]\ndisc = [{ position = [0.5, 5], velocity = [1, 0.5], radius = 0.5 }]"
NO_GAP = """
box.size = [4, 10]
disc = [
    { position = [1, 5], velocity = [1, 0.5], radius = 1 },
    { position = [3, 5], velocity = [-1, 0.5], radius = 1 },
]
"""


@pytest.mark.parametrize("method", ["event_driven", "brute_force"])
@pytest.mark.parametrize("text", [WIDE, NO_GAP], ids=["as wide as the box", "side by side"])
def test_discs_without_a_gap_end_the_run_with_one_line(text, method, tmp_path):
    """All their events are at one time, which an end in time never comes to."""
    (tmp_path / "scene.toml").write_text(text)
    keys = ("--set", "run.until=20", "--set", f"run.method={method}")
    line = error_of("run", "scene.toml", "-o", "run.h5", *keys, folder=tmp_path)
    assert line == "after t = 0: the clock stands still: a disc collides without end at one instant\n"
    output_of("info", "run.h5", folder=tmp_path)


@pytest.mark.slow
def test_a_disc_that_keeps_the_run_busy_is_named_on_stderr(tmp_path):
    (tmp_path / "scene.toml").write_text("""
box.size = [10, 10]
gravity.acceleration = [0, -1]
restitution = { wall = 0.5, contact_duration = 1e-6 }
run.until = 3
log.events = false
disc = [{ position = [5, 0.6], radius = 0.5 }]
species = [{ name = "gas", count = 5, radius = 0.5, temperature = 1, region = [0, 5, 10, 10] }]
""")
    result = idealgas("run", "scene.toml", "-o", "run.h5", "--json", folder=tmp_path)
    assert result.returncode == 0
    assert json.loads(result.stdout)["completed"]
    assert result.stderr.startswith("1 of 6 discs accounts for most of the events from t = 0 to t = ")
    assert result.stderr.count("\n") == 1

"""Events as lines of JSON: filters, a log that is being written, and a reader that goes away."""

import json
import os
import pty
import subprocess

import numpy as np
from helpers.support import IDEALGAS, output_of
from idealgas_cli.events import KINDS

from idealgas import open_log
from idealgas.log.dataframes import KIND_NAMES


def rows(text):
    return [json.loads(line) for line in text.splitlines()]


def test_every_row_with_every_digit(folder):
    printed = rows(output_of("events", folder / "run.h5"))
    with open_log(folder / "run.h5") as log:
        (batch,) = log.chunks()
    assert len(printed) == len(batch.time)
    assert np.array_equal([row["time"] for row in printed], batch.time)
    assert np.array_equal([[row["vx"], row["vy"]] for row in printed], batch.velocity)
    assert np.array_equal([[row["x"], row["y"]] for row in printed], batch.position)
    assert {row["kind"] for row in printed} == {"disc", "wall"}


def test_filters(folder):
    assert KINDS == KIND_NAMES
    printed = rows(output_of("events", folder / "run.h5"))
    selected = rows(output_of("events", folder / "run.h5", "--disc", 3, "--kind", "wall", "--from", 5, "--to", 90.5))
    assert selected == [
        row for row in printed if row["disc"] == 3 and row["kind"] == "wall" and 5 <= row["time"] < 90.5
    ]
    assert selected
    first, last = (printed[k]["time"] for k in (40, 60))  # of events: the one at --from is printed, that at --to is not
    selected = rows(output_of("events", folder / "run.h5", "--from", repr(first), "--to", repr(last)))
    assert selected == [row for row in printed if first <= row["time"] < last]
    assert (selected[0]["time"], selected[-1]["time"] < last) == (first, True)


def test_a_log_that_is_being_written(folder):
    """The reader starts with the run, ends with it, and has every row."""
    run = [IDEALGAS, "run", "scene.toml", "-o", "live.h5", "-q", "--set", "run.collisions_per_disc=1000"]
    with subprocess.Popen(run, cwd=folder) as writer:
        while not (folder / "live.h5").exists() and writer.poll() is None:
            pass
        reader = subprocess.run(
            [IDEALGAS, "events", "live.h5", "--follow", "--kind", "wall"], cwd=folder, capture_output=True, text=True
        )
        writer.wait()
    assert (writer.returncode, reader.returncode) == (0, 0), reader.stderr
    assert reader.stdout == output_of("events", folder / "live.h5", "--kind", "wall")


def test_a_reader_that_goes_away(folder):
    command = f"{IDEALGAS} events run.h5 | head -n 1; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, text=True)
    assert (done.returncode, done.stderr, len(rows(done.stdout))) == (141, "", 1)


def test_stream_of_a_run(folder):
    """The lines are those of `events`, and the log is that of a run without a stream."""
    streamed = output_of("run", "scene.toml", "-o", "streamed.h5", "--stream", folder=folder)
    assert streamed == output_of("events", folder / "run.h5")
    assert output_of("digest", folder / "streamed.h5").split()[0] == output_of("digest", folder / "run.h5").split()[0]


def test_stream_beside_a_progress_bar(folder):
    """A bar on a terminal leaves the lines on stdout."""
    bar, terminal = pty.openpty()
    run = [IDEALGAS, "run", "scene.toml", "-o", "bar.h5", "--stream", "--set", "run.until=2"]
    done = subprocess.run(run, cwd=folder, stdout=subprocess.PIPE, stderr=terminal, text=True)
    os.close(terminal)
    os.close(bar)
    assert (done.returncode, done.stdout) == (0, output_of("events", folder / "run.h5", "--to", 2))


def test_a_reader_that_leaves_a_run(folder):
    """The run waits for its reader, ends with it, has every line that was read, and can be continued."""
    run = [IDEALGAS, "run", "scene.toml", "-o", "left.h5", "--stream"]
    with subprocess.Popen(run, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        first = process.stdout.readline()
        assert process.poll() is None  # so many events fill any pipe
        process.stdout.close()
        assert process.wait() == 141
        assert process.stderr.read() == "interrupted; `idealgas resume left.h5` continues it\n"
    whole = output_of("events", folder / "run.h5")
    left = output_of("events", folder / "left.h5")
    assert left.startswith(first)
    assert whole.startswith(left)
    assert len(left) < len(whole)
    output_of("resume", folder / "left.h5")
    assert output_of("events", folder / "left.h5") == whole

"""Logs read: rows by number, time and disc, and the state at any time."""

import h5py
import numpy as np
import pytest
from helpers.fresh_python import python
from helpers.log_compare import scene_of
from helpers.log_samples import DISCS, STEP, checkpoint_arrays, filled, gas, new_writer, rows, write_log
from helpers.needs import posix
from helpers.support import logged

from idealgas.columns import BLOCK, Kind
from idealgas.log import LogError, LogLayout, LogWriter, box_walls, open_log
from idealgas.log.hdf5 import chunks
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

STOP = 2 * BLOCK + 300


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    with open_log(write_log(tmp_path_factory.mktemp("log") / "run.h5", STOP)) as log:
        yield log


@pytest.mark.parametrize(
    ("start", "stop"), [(0, None), (5, 6), (BLOCK - 1, BLOCK + 1), (70_000, 10**9), (9, 9), (9, 3)]
)
def test_chunks_are_slices(log, start, stop):
    blocks = list(log.chunks(("velocity", "disc"), start, stop))
    expected = rows(0, STOP)
    assert all(0 < len(block.disc) <= BLOCK for block in blocks)
    periodic = np.concatenate([np.empty((0, 2)), *(block.velocity for block in blocks)])
    assert np.array_equal(periodic, expected.velocity[start:stop])
    assert sum(len(block.disc) for block in blocks) == len(periodic)


def test_row_at(log):
    times = rows(0, STOP).time
    for time in [-1.0, 0.0, STEP / 2, BLOCK * STEP, (BLOCK - 0.5) * STEP, (STOP - 1) * STEP, STOP * STEP, 1e9]:
        for side in ("left", "right"):
            assert log.row_at(time, side) == times.searchsorted(time, side)


def test_row_at_with_equal_times_across_chunks(tmp_path):
    start = gas()
    with LogWriter(tmp_path / "run.h5", start, LogLayout(box_walls(start.box)), scene_text="", seed=0) as writer:
        for size in (BLOCK, BLOCK, BLOCK):
            filled(writer, size)[0].time[:] = 3.0
            writer.write(size)
    with open_log(tmp_path / "run.h5") as log:
        assert (log.row_at(3.0), log.row_at(3.0, "right")) == (0, 3 * BLOCK)
        assert (log.row_at(2.9), log.row_at(3.1)) == (0, 3 * BLOCK)


@pytest.mark.parametrize("disc", [None, 0, 24])
@pytest.mark.parametrize(("t0", "t1"), [(None, None), (50.0, 51.0), (None, 3.0), (63.99, 64.01), (9.0, 2.0)])
def test_events_of_a_disc_and_a_window(log, disc, t0, t1):
    expected = rows(0, STOP)
    here = np.ones(STOP, bool) if disc is None else expected.disc == disc
    here &= (expected.time >= (t0 or 0)) & (expected.time < (t1 or 1e9))
    times = np.concatenate([np.empty(0), *(block.time for block in log.events(disc, t0, t1))])
    assert np.array_equal(times, expected.time[here])


def states(times):
    """The state at each time by going through all rows, one by one."""
    start = gas()
    record = [(0.0, r, v) for r, v in zip(start.position, start.velocity, strict=True)]
    expected, row = rows(0, 3000), 0
    for time in times:
        while row < 3000 and expected.time[row] <= time:
            record[expected.disc[row]] = (expected.time[row], expected.position[row], expected.velocity[row])
            row += 1
        yield np.array([r + (time - t) * v for t, r, v in record]), np.array([v for _, _, v in record])


TIMES = [0.0, STEP / 3, 1.0, 1.0, 1.0 + STEP / 7, 2.5, 2999 * STEP]


def test_states_from_the_start(tmp_path):
    """Without checkpoints every state is the rows' alone."""
    with new_writer(tmp_path / "run.h5") as writer:
        filled(writer, 3000)
        writer.write(3000)
    with open_log(tmp_path / "run.h5") as log:
        frames = list(log.frames(TIMES))
        for time, frame, (position, velocity) in zip(TIMES, frames, states(TIMES), strict=True):
            assert frame.time == time
            assert np.array_equal(frame.position, position)
            assert np.array_equal(frame.velocity, velocity)
            assert np.array_equal(log.state_at(time).position, position)


def test_states_start_at_the_nearest_checkpoint(log):
    checkpoint = log.checkpoints[5]
    state = log.state_at(checkpoint.time + STEP / 2)
    met = rows(checkpoint.row, checkpoint.row + 1).disc[0]
    others = np.arange(DISCS) != met
    expected = checkpoint_arrays(checkpoint.row)
    flown = expected["position"] + expected["velocity"] * (STEP / 2)
    assert np.array_equal(state.position[others], flown[others])
    assert np.array_equal(state.velocity[met], rows(checkpoint.row, checkpoint.row + 1).velocity[0])


def test_states_at_many_times_decode_each_chunk_once(tmp_path, monkeypatch):
    text = """
    box.size = [10, 10]
    species = [{name = "gas", count = 30, radius = 0.3, temperature = 1.0}]
    run.collisions_per_disc = 700
    """
    decode, decoded = chunks.decode, []
    monkeypatch.setattr(chunks, "decode", lambda *given: decoded.append(given) or decode(*given))
    with logged(parse_scene(text), tmp_path / "run.h5") as log:
        assert len(log.checkpoints) > 10
        assert len(log) < BLOCK
        times = np.linspace(0, log.end_time, 100)
        assert len(list(log.frames(times))) == 100
        once = len(decoded)
        list(log.frames(times))
    assert once < 35  # each column of events and of checkpoints, and a few of the run
    assert len(decoded) == once


@pytest.mark.parametrize("times", [[-1.0], [1e9], [2.0, 1.0], [float("nan")]])
def test_states_that_are_not_there(log, times):
    with pytest.raises(LogError, match="no state at time"):
        list(log.frames(times))


def test_half_a_pair_does_not_count(tmp_path):
    with new_writer(tmp_path / "run.h5") as writer:
        batch, _ = filled(writer, 6)
        batch.kind[:6] = Kind.DISC
        batch.time[:6] = np.repeat([1, 3, 5], 2) * STEP
        batch.disc[:6] = [3, 9, 4, 8, 2, 7]
        batch.partner[:6] = [9, 3, 8, 4, 7, 2]
        writer.write(5)
    with open_log(tmp_path / "run.h5") as log:
        assert len(log) == 4
        assert [len(block.time) for block in log.chunks()] == [4]
        assert log.end_time == 3 * STEP


def test_a_log_is_followed(tmp_path):
    with new_writer(tmp_path / "run.h5") as writer, open_log(tmp_path / "run.h5") as log:
        assert (len(log), log.end_time) == (0, 0.0)
        filled(writer, 10)
        writer.write(10)
        writer.close({"end_time": 1.0})
        log.refresh()
        assert (len(log), log.end_time, log.complete) == (10, 1.0, True)


# ── files that are not logs ──


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (b"", "empty"),
        (b"scene", "a text"),
        (b"\x89PNG\r\n\x1a\n" + bytes(100), "a binary file"),
        (b"\x89HDF\r\n\x1a\n" + bytes(100), "an HDF5 file"),
    ],
    ids=["empty", "text", "picture", "cut"],
)
def test_other_files(tmp_path, content, kind):
    (tmp_path / "run.h5").write_bytes(content)
    with pytest.raises(LogError, match=rf"run\.h5: not a log of idealgas, but {kind}"):
        open_log(tmp_path / "run.h5")


def test_a_newer_format_and_hdf5_of_others(tmp_path):
    for options in ({}, {"libver": ("v110", "v110")}):
        with h5py.File(tmp_path / "run.h5", "w", **options) as file:
            file["x"] = 1
        with pytest.raises(LogError, match="not a log of idealgas"):
            open_log(tmp_path / "run.h5")
    path = write_log(tmp_path / "log.h5", 10)
    with h5py.File(path, "r+", libver=("v110", "v110")) as file:
        file.attrs["format_version"] = 9
    with pytest.raises(LogError, match="has format 9; this version of idealgas reads format 1"):
        open_log(path)


@posix
def test_files_that_are_no_logs(tmp_path):
    with pytest.raises(LogError, match=r"cannot be read: No such file or directory$"):
        open_log(tmp_path / "run.h5")
    with pytest.raises(LogError, match=r"cannot be read: Is a directory$"):
        open_log(tmp_path)


@pytest.mark.usefixtures("uncompiled")
def test_steps_of_time_may_carry_discs_beyond_a_side(tmp_path):
    text = """
    box.size = [5, 4]
    species = [{name = "gas", count = 10, radius = 0.1, temperature = 1.0}]
    run = {method = "time_driven", dt = 0.05, until = 20.0}
    """
    with logged(parse_scene(text), tmp_path / "run.h5") as log:
        position = np.concatenate([rows.position for rows in log.chunks()])
        assert position.min() < 0 or (position > log.box).any()


def test_print_of_a_log(tmp_path):
    path = tmp_path / "run.h5"
    with logged(scene_of("mixture", "run.events=100"), path) as log:
        title, discs = log.scene.scene.title, len(log.discs)
        lines = str(log).splitlines()
        assert len(lines) == 3
        assert lines[0].startswith(f"{title}: {discs:,} discs (")
        assert lines[0].endswith("), event_driven")
        assert all(name in lines[0] for name in log.discs.species_names)
        assert lines[1] == f"t = 0 to {log.end_time:g}: 100 events, complete"
        assert lines[2].startswith(f"{path}: ")
    simulate(scene_of("quickstart", "run.events=100000"), path, force=True, interrupted=lambda: True)
    with open_log(path) as log:
        assert str(log).splitlines()[1] == f"t = 0 to {log.end_time:g}: {len(log):,} event rows, interrupted"
    simulate(scene_of("quickstart", "run.events=100", 'scene.title="a\\nb\\u001b[31m"'), path, force=True)
    with open_log(path) as log:
        assert len(str(log).splitlines()) == 3
        assert "\x1b" not in str(log)


def test_a_log_whose_run_ends_while_it_is_opened(tmp_path, monkeypatch):
    """Half of it is there when it is read first; by the time of the error the run has written the rest, and is over."""
    path = write_log(tmp_path / "run.h5", 300)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])

    def is_locked(path):
        path.write_bytes(data)
        return False

    monkeypatch.setattr("idealgas.log.reader.is_locked", is_locked)
    with open_log(path) as log:
        assert len(log) == 300


@pytest.mark.parametrize("keeper", ["idealgas.jit", "idealgas.jit.EntryPoint"])
def test_a_log_that_is_open_when_python_ends(tmp_path, keeper):
    """HDF5 ends after Python, and can then no longer read through an object of Python."""
    write_log(tmp_path / "run.h5", 100)
    program = f"import idealgas, idealgas.jit; {keeper}.kept = log = idealgas.open_log('run.h5'); print(len(log))"
    assert python(program, tmp_path) == "100"

"""Logs opened for writing again: after their writer was killed, and to continue from a checkpoint."""

import os

import h5py
import numpy as np
import pytest
from helpers.log_samples import STEP, check, filled, rows, start_writer, write_log, write_rows

from idealgas.columns import BLOCK, EventBatch
from idealgas.errors import OutputError
from idealgas.log import DamageError, LogError, LogWriter, open_log, recover


@pytest.fixture(scope="module", params=["gzip", "none"])
def left(request, tmp_path_factory):
    """A log whose writer was killed."""
    path = tmp_path_factory.mktemp("log") / "run.h5"
    child = start_writer(path, request.param, "499", rows=2000)
    child.kill()
    child.wait()
    return path


def copied(path, folder):
    (folder / "run.h5").write_bytes(path.read_bytes())
    return folder / "run.h5"


def assert_plain(path, stop):
    """h5py opens it, and all columns have just these rows."""
    with h5py.File(path) as file:
        for name, values in zip(EventBatch._fields, rows(0, stop), strict=True):
            assert values is None or np.array_equal(file["events"][name][:], values)
        assert len({len(column) for column in file["checkpoints"].values()}) == 1


def test_a_live_writer_is_not_disturbed(tmp_path):
    path = tmp_path / "run.h5"
    child = start_writer(path, "gzip", "499", rows=2000)
    try:
        with open_log(path) as log:
            assert log.live
            before = check(log)
            log.refresh()
            assert check(log) >= before
        for refused in (recover, LogWriter.resume):
            with pytest.raises(OutputError, match="another run is writing this file"):
                refused(path)
        assert child.poll() is None
    finally:
        child.kill()
        child.wait()
    with open_log(path) as log:
        assert not log.live


def test_the_log_of_a_killed_writer_is_read_unchanged_and_recovered_as_a_copy(left, tmp_path):
    before = left.read_bytes()
    with open_log(left) as log:
        assert check(log) > 2000
        assert (log.unclosed, log.live, log.complete) == (True, False, False)
    assert left.read_bytes() == before
    with pytest.raises(OSError, match="already open"):
        h5py.File(left)
    stop = recover(left, tmp_path / "copy.h5")
    assert left.read_bytes() == before
    assert_plain(tmp_path / "copy.h5", stop)
    with pytest.raises(OutputError, match="already exists"):
        recover(left, tmp_path / "copy.h5")


def test_recovery_in_place(left, tmp_path):
    path = copied(left, tmp_path)
    with open_log(path) as log:
        stop, checkpoints = len(log), len(log.checkpoints)
    assert recover(path) == stop
    with open_log(path) as log:
        assert check(log) == stop
        assert (log.unclosed, log.complete, len(log.checkpoints)) == (False, False, checkpoints)
    assert_plain(path, stop)
    again = path.read_bytes()
    assert recover(path) == stop
    assert path.read_bytes() == again


@pytest.mark.parametrize("torn", ["events/velocity", "checkpoints/position"])
def test_a_chunk_torn_while_it_was_rewritten(left, tmp_path, torn):
    """Bytes beyond the committed rows do not matter."""
    path = copied(left, tmp_path)
    with h5py.File(path, swmr=True) as file, open_log(path) as log:
        stop, count = check(log), log.commit.rows[torn.partition("/")[0]]
        column = file[torn]
        within = count % column.chunks[0]
        where = column.id.get_chunk_info_by_coord((count - within,) + (0,) * (column.ndim - 1))
        row_bytes = column.dtype.itemsize * int(np.prod(column.shape[1:]))
        assert where.size > row_bytes * (within + 1)
    with path.open("r+b") as raw:
        raw.seek(where.byte_offset + within * row_bytes)
        raw.write(b"torn")
    with open_log(path) as log:
        assert check(log) == stop
    recover(path)
    assert_plain(path, stop)


@pytest.mark.parametrize("compression", ["gzip", "none"])
@pytest.mark.parametrize("checkpoint", [0, 3, -1])
@pytest.mark.parametrize("more", [0, 10, 3 * BLOCK])
def test_continued_after_a_checkpoint(tmp_path, compression, checkpoint, more):
    path = write_log(tmp_path / "run.h5", 100_000, compression=compression)
    with open_log(path) as log:
        chosen = log.checkpoints[checkpoint]
    writer = LogWriter.resume(path, checkpoint)
    assert writer.rows == chosen.row
    stop = chosen.row + more
    while writer.rows < stop:
        writer.write(filled(writer, min(50_000, stop - writer.rows))[1])
    writer.close({"end_time": stop * STEP})
    with open_log(path) as log:
        assert check(log) == stop
        assert log.complete
        assert log.checkpoints[-1].row == log.observables["hits"][1][-1] == chosen.row
    assert_plain(path, stop)


def test_continued_after_a_kill(left, tmp_path):
    path = copied(left, tmp_path)
    with LogWriter.resume(path) as writer:
        start = writer.rows
        write_rows(writer, start + 1000, [100])
    with open_log(path) as log:
        assert check(log) == start + 1000
        assert not log.complete
    assert_plain(path, start + 1000)


def test_to_continue_needs_a_checkpoint(tmp_path):
    path = write_log(tmp_path / "run.h5", 0)
    with pytest.raises(LogError, match="no checkpoint -1 among 0"):
        LogWriter.resume(path)


def test_damage_is_not_recovered(left, tmp_path):
    path = copied(left, tmp_path)
    with path.open("r+b") as raw:
        raw.seek(20)
        raw.write(b"\x55")
    with pytest.raises(LogError, match="damaged"):
        recover(path)
    with pytest.raises(LogError, match="damaged"):
        recover(path, tmp_path / "copy.h5")
    assert not os.path.exists(tmp_path / "copy.h5")


@pytest.mark.parametrize("damaged", ["events/velocity", "checkpoints/position"])
def test_damage_is_found_before_anything_is_changed(left, tmp_path, damaged):
    path = copied(left, tmp_path)
    with h5py.File(path, swmr=True) as file, open_log(path) as log:
        column, count = file[damaged], log.commit.rows[damaged.partition("/")[0]]
        last = (count - 1) // column.chunks[0] * column.chunks[0]
        place = column.id.get_chunk_info_by_coord((last,) + (0,) * (column.ndim - 1)).byte_offset
    with path.open("r+b") as raw:
        raw.seek(place)
        raw.write(b"\x55")
    before = path.read_bytes()
    for refused in (recover, LogWriter.resume, lambda path: recover(path, tmp_path / "copy.h5")):
        with pytest.raises(DamageError, match=f"{path}: damaged: {damaged}"):
            refused(path)
        assert path.read_bytes() == before
    assert not os.path.exists(tmp_path / "copy.h5")

"""Written logs: round trips, contents for other HDF5 programs, and refusals."""

import errno
import json
import math
import os
import threading
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.log_samples import DISCS, STEP, check, gas, new_writer, rows, write_checkpoint, write_log, write_rows
from helpers.needs import posix

import idealgas.log.writer as log_writer
from idealgas.columns import (
    ANGULAR_VELOCITY,
    BLOCK,
    IMAGE,
    IMAGES,
    POSITION,
    POSITIONS,
    SPINS,
    VELOCITY,
    EventBatch,
    Kind,
    event_columns,
)
from idealgas.errors import OutputError
from idealgas.log import LogLayout, LogWriter, box_walls, open_log
from idealgas.log.hdf5.table_writer import TableWriter


@pytest.mark.parametrize("compression", ["gzip", "none"])
@pytest.mark.parametrize(
    ("stop", "flush_seconds"),
    [*((stop, 1.0) for stop in (0, 1, 3000, BLOCK, BLOCK + 1, 3 * BLOCK - 5)), (3 * BLOCK + 100, 0.0)],
)
def test_a_log_comes_back(tmp_path, monkeypatch, compression, stop, flush_seconds):
    """Also if it is flushed at every moment."""
    monkeypatch.setattr(log_writer, "FLUSH_SECONDS", flush_seconds)
    path = write_log(tmp_path / "run.h5", stop, compression=compression)
    with open_log(path) as log:
        assert check(log) == stop
        assert log.complete
        assert not log.unclosed
        assert log.summary == {"end_time": stop * STEP, "rows": stop}
        assert log.end_time == stop * STEP


@pytest.mark.parametrize("flush_seconds", [0.0, 1.0])
@pytest.mark.parametrize("most_rows", [1, 8192, 8193, 30_000])
def test_a_log_of_short_chunks_takes_any_number_of_rows(tmp_path, monkeypatch, most_rows, flush_seconds):
    monkeypatch.setattr(log_writer, "FLUSH_SECONDS", flush_seconds)
    path = write_log(tmp_path / "run.h5", 2 * BLOCK + 100, most_rows=most_rows)
    with h5py.File(path) as file:
        assert file["events/time"].chunks == (max(8192, 2 ** math.ceil(math.log2(most_rows))),)
    with open_log(path) as log:
        assert check(log) == 2 * BLOCK + 100
        assert log.row_at(50_000 * STEP) == 50_000
    with LogWriter.resume(path, 5) as writer:
        write_rows(writer, 3 * BLOCK)
    with open_log(path) as log:
        assert check(log) == 3 * BLOCK


def test_with_fsync(tmp_path, monkeypatch):
    monkeypatch.setattr(log_writer, "FLUSH_SECONDS", 0.0)
    synced = []
    monkeypatch.setattr(os, "fsync", synced.append)
    with open_log(write_log(tmp_path / "run.h5", 1000, fsync=True)) as log:
        assert check(log) == 1000
    assert len(synced) >= 4  # the rows before the record, and then the record, for both of its slots


def test_flushing_a_growing_chunk_costs_no_space(tmp_path, monkeypatch):
    monkeypatch.setattr(log_writer, "FLUSH_SECONDS", 0.0)
    sizes = []
    for batch in (BLOCK // 4, BLOCK // 64):
        with new_writer(tmp_path / f"{batch}.h5") as writer:
            write_rows(writer, BLOCK, [batch])
        sizes.append(os.path.getsize(tmp_path / f"{batch}.h5"))
    assert sizes[1] < 1.1 * sizes[0]


def test_rows_appear_while_they_come_slowly(tmp_path, monkeypatch):
    monkeypatch.setattr(log_writer, "FLUSH_SECONDS", 0.05)
    with new_writer(tmp_path / "run.h5") as writer:
        write_rows(writer, 100)
        seen, deadline = 0, time.monotonic() + 30
        while seen < 100 and time.monotonic() < deadline:
            with open_log(tmp_path / "run.h5") as log:
                seen = check(log)
                assert log.unclosed
        assert seen == 100


def test_plain_h5py_reads_it_as_h5md(tmp_path):
    path = write_log(tmp_path / "run.h5", 70_000)
    expected = rows(0, 70_000)
    with h5py.File(path) as file:
        for name in EventBatch._fields[:6]:
            assert np.array_equal(file["events"][name][:], getattr(expected, name))
        assert h5py.check_enum_dtype(file["events/kind"].dtype) == {kind.name: kind.value for kind in Kind}
        assert file["events/velocity"].attrs["unit"] == b"length/time"
        assert file["runs/scene"].asstr()[0].startswith("[scene]")
        assert list(file["walls/name"]) == [b"left", b"right", b"bottom", b"top"]
        assert [json.loads(value) for value in file["summary/value"]] == [70_000 * STEP, 70_000]
        assert {len(file["checkpoints"][name]) for name in file["checkpoints"]} == {len(file["checkpoints/time"])}
    with h5py.File(path) as file:
        assert list(file["h5md"].attrs["version"]) == [1, 1]
        assert {"name"} <= set(file["h5md/author"].attrs)
        assert {"name", "version"} <= set(file["h5md/creator"].attrs)
        energy, hits = file["observables/kinetic_energy"], file["observables/hits"]
        assert set(energy) == set(hits) == {"step", "time", "value"}
        assert energy["time"] == hits["time"]
        assert len(energy["step"]) == len(energy["time"]) == len(energy["value"])


def test_further_columns(tmp_path):
    columns = event_columns(POSITIONS, SPINS, IMAGES)
    arrays = (POSITION, VELOCITY, ANGULAR_VELOCITY, IMAGE)
    options = {"checkpoint_arrays": arrays, "event_columns": columns, "boundary": ("periodic", "none")}
    with new_writer(tmp_path / "run.h5", **options) as writer:
        batch = writer.batch()
        for column in filter(lambda column: column is not None, batch):
            column[:100] = 1
        batch.partner[:100] = -1
        batch.angular_velocity[:100] = np.arange(100) / 7
        batch.image[:100] = np.arange(200).reshape(100, 2)
        writer.write(100)
        image = np.arange(2 * DISCS).reshape(DISCS, 2)
        state = {"position": image % 5, "velocity": image, "angular_velocity": image[:, 0], "image": image}
        writer.checkpoint(1.0, 1, state, {"hits": 0})
    with open_log(tmp_path / "run.h5") as log:
        (block,) = log.chunks()
        assert isinstance(block, EventBatch)
        assert np.array_equal(block.angular_velocity, np.arange(100) / 7)
        assert np.array_equal(block.image, np.arange(200).reshape(100, 2))
        assert log.checkpoints[0].arrays["image"].dtype == np.int32
        assert np.array_equal(log.checkpoints[0].arrays["image"], image)


def test_without_events_and_without_close(tmp_path):
    with new_writer(tmp_path / "run.h5", event_columns=()) as writer:
        write_checkpoint(writer)
        writer.close({"end_time": 5.0})
    with open_log(tmp_path / "run.h5") as log:
        assert not log.has_events
        assert (len(log), len(log.checkpoints), log.end_time) == (0, 1, 5.0)
        assert list(log.chunks()) == []
        assert log.row_at(1.0) == 0
    with new_writer(tmp_path / "left.h5") as writer:
        write_rows(writer, 500)
    with open_log(tmp_path / "left.h5") as log:
        assert (check(log), log.complete, log.summary) == (500, False, {})
        assert log.end_time == 499 * STEP


def test_a_log_is_behind_while_batches_are_to_be_stored(tmp_path, monkeypatch):
    goes_on = threading.Event()
    append = TableWriter.append
    with new_writer(tmp_path / "run.h5") as writer:
        monkeypatch.setattr(TableWriter, "append", lambda *given: goes_on.wait() and append(*given))
        write_rows(writer, 300, sizes=(300,))
        assert not writer.behind
        write_rows(writer, 600, sizes=(300,))
        assert writer.behind
        goes_on.set()
        while writer.behind:
            time.sleep(0.01)
    with open_log(tmp_path / "run.h5") as log:
        assert check(log) == 600


def test_long_texts_many_checkpoints_and_what_changes_after_it_was_handed_over(tmp_path):
    text = "# " + "x" * 200_000
    with new_writer(tmp_path / "run.h5", scene_text=text) as writer:
        for k in range(1000):
            writer.checkpoint(k, k, {"position": np.zeros((DISCS, 2)), "velocity": np.full((DISCS, 2), k)}, {"hits": 0})
    with open_log(tmp_path / "run.h5") as log:
        assert log.scene_text == text
        assert [checkpoint.velocity[3, 1] for checkpoint in log.checkpoints] == list(range(1000))
    position = np.zeros((DISCS, 2))
    with new_writer(tmp_path / "other.h5") as writer:
        for k in range(50):
            position[:] = k / 10
            writer.checkpoint(k, k, {"position": position, "velocity": position}, {"hits": 0})
    with open_log(tmp_path / "other.h5") as log:
        assert all((checkpoint.position == checkpoint.epoch / 10).all() for checkpoint in log.checkpoints)


@pytest.mark.parametrize("discs", [1, 5000])
def test_few_and_many_discs(tmp_path, discs):
    start = gas(discs)
    with LogWriter(tmp_path / "run.h5", start, LogLayout(box_walls(start.box)), scene_text="", seed=2**200) as writer:
        for k in range(3):
            writer.checkpoint(k, k, {"position": start.position / (k + 1), "velocity": start.velocity})
    with open_log(tmp_path / "run.h5") as log:
        assert np.array_equal(log.checkpoints[2].position, start.position / 3)
        assert log.attributes["seed"] == str(2**200)


# ── refusals ──


def test_an_existing_file_stays(tmp_path):
    path = tmp_path / "run.h5"
    write_log(path, 20)
    before = path.read_bytes()
    with pytest.raises(OutputError, match=r"already exists \(use force=True to overwrite\)") as caught:
        new_writer(path)
    assert caught.value.exit_code == 2
    assert path.read_bytes() == before
    write_log(path, 10, force=True)
    with open_log(path) as log:
        assert check(log) == 10


@pytest.mark.parametrize("number", [errno.EACCES, errno.EROFS], ids=errno.errorcode.get)
def test_an_unwritable_folder(tmp_path, monkeypatch, number):
    def fail(*_, **__):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(Path, "touch", fail)  # nothing is forbidden to root
    with pytest.raises(OutputError, match=f"cannot be written: {os.strerror(number)}") as caught:
        new_writer(tmp_path / "run.h5")
    assert caught.value.exit_code == 1


def test_a_disk_that_is_full_from_the_start(tmp_path, monkeypatch):
    def fail(*_):
        raise OSError(errno.ENOSPC, "no space")

    monkeypatch.setattr(log_writer.schema, "create_tables", fail)
    with pytest.raises(OutputError, match="cannot be written: No space left on device"):
        new_writer(tmp_path / "run.h5")
    assert list(tmp_path.iterdir()) == []


def test_a_summary_of_wrong_size(tmp_path):
    with new_writer(tmp_path / "run.h5") as writer:
        with pytest.raises(ValueError, match="must be short"):
            writer.close({"x": "y" * 1000})
        with pytest.raises(ValueError, match="at least one"):
            writer.close({})


# ── faults ──


@pytest.mark.parametrize("calls", ["batches", "checkpoints"])
def test_a_fault_of_the_thread_comes_up(tmp_path, monkeypatch, calls):
    writer = new_writer(tmp_path / "run.h5")
    write_rows(writer, 1000)

    def fail(*_):
        raise OSError(errno.ENOSPC, "no space")

    monkeypatch.setattr(log_writer, "commit_tables", fail)
    monkeypatch.setattr(log_writer, "FLUSH_SECONDS", 0.0)

    def go_on():
        for _ in range(100):
            if calls == "batches":
                writer.batch()
                writer.write(10)
            else:
                write_checkpoint(writer)
            time.sleep(0.01)

    with pytest.raises(OutputError, match=r"cannot be written: No space left on device") as caught:
        go_on()
    assert caught.value.exit_code == 1
    with pytest.raises(OutputError, match="No space left"):
        writer.close()
    assert not any(thread.name == "log writer" for thread in threading.enumerate())


@posix
def test_a_command_with_a_file_name_that_is_not_utf_8(tmp_path):
    path = tmp_path / os.fsdecode(b"gas\xff.h5")
    write_log(path, 10, command="idealgas run gas\udcff.toml")
    with open_log(path) as log:
        assert log.command == r"idealgas run gas\udcff.toml"

"""One writer per log: nothing that this process or another one does to a log frees the lock of its writer."""

import errno
import os
import subprocess
import sys
import threading
import time

import h5py
import pytest
from helpers.log_samples import check, new_writer, write_log, write_rows
from helpers.needs import posix
from helpers.support import ROOT

from idealgas.errors import OutputError, UserError
from idealgas.files import LOG, check_output, is_of_kind, written
from idealgas.locks import WriteLock, is_locked
from idealgas.log import LogError, LogWriter, open_log, recover
from idealgas.run.resume import resume
from idealgas.run.simulate import simulate
from idealgas.scene import load_scene

IN_USE = "another run is writing this file"

RESUME = """
import sys
from idealgas.errors import UserError
from idealgas.log import LogWriter
try:
    LogWriter.resume(sys.argv[1], None).close()
except UserError as error:
    print(str(error).rpartition(": ")[2])
"""


def in_another_process(path):
    """What another process gets that resumes a log; nothing if it does."""
    done = subprocess.run([sys.executable, "-c", RESUME, path], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def read(path):
    with open_log(path) as log:
        assert log.live
        return check(log)


def refused(action):
    with pytest.raises(UserError, match=IN_USE):
        action()


USES = {
    "open": lambda path: open_log(path).close(),
    "read": read,
    "recognise": lambda path: is_of_kind(path, LOG),
    "ask": is_locked,
    "bytes": lambda path: path.read_bytes(),
    "h5py": lambda path: h5py.File(path, swmr=True, locking=False).close(),
    "overwrite": lambda path: refused(lambda: check_output(path, LOG, force=True)),
    "resume": lambda path: refused(lambda: LogWriter.resume(path, None)),
    "recover": lambda path: refused(lambda: recover(path)),
}


@pytest.mark.parametrize("use", USES)
def test_the_lock_outlasts_every_use_in_this_process(tmp_path, use):
    path = tmp_path / "run.h5"
    with new_writer(path) as writer:
        write_rows(writer, 1000)
        thread = threading.Thread(target=USES[use], args=[path])
        thread.start()
        thread.join()
        USES[use](path)
        assert in_another_process(path) == IN_USE
        write_rows(writer, 2000)
    with open_log(path) as log:
        assert (check(log), log.unclosed) == (2000, False)
    assert in_another_process(path) == ""


def test_a_run_is_refused_while_this_process_writes_its_log(tmp_path):
    """The run in the other thread comes to its end, with the same log as one alone."""
    scene, path = load_scene(ROOT / "configs" / "quickstart.toml", ["run.events=3000"]), tmp_path / "run.h5"
    begun, may_end = threading.Event(), threading.Event()

    def wait(_):
        begun.set()
        may_end.wait(60)

    thread = threading.Thread(target=simulate, args=[scene, path], kwargs={"on_progress": wait})
    thread.start()
    begun.wait(60)
    try:
        for action in (lambda: resume(path), lambda: simulate(scene, path, force=True)):
            with pytest.raises(UserError) as caught:
                action()
            assert str(caught.value) == f"{path}: {IN_USE}"
        assert in_another_process(path) == IN_USE
    finally:
        may_end.set()
        thread.join()
    simulate(scene, tmp_path / "alone.h5")
    with open_log(path) as log, open_log(tmp_path / "alone.h5") as alone:
        assert log.complete
        for ours, expected in zip(log.chunks(), alone.chunks(), strict=True):
            assert all(a is b is None or (a == b).all() for a, b in zip(ours, expected, strict=True))


def test_a_log_that_other_code_has_open_or_has_changed_is_refused(tmp_path):
    """HDF5 would share one descriptor between both."""
    path = write_log(tmp_path / "run.h5", 1000)
    with h5py.File(path, "r+", locking=False) as other:
        with pytest.raises(OutputError, match=IN_USE):
            LogWriter.resume(path)
        assert len(other["events/time"]) == 1000
    LogWriter.resume(path).close()
    path = write_log(tmp_path / "other.h5", 1000)
    with open_log(path) as log:
        commit = log.commit
    with LogWriter.resume(path, 0) as writer:
        write_rows(writer, writer.rows + 500)
    before = path.read_bytes()
    with pytest.raises(LogError, match="was changed by another run while it was being read"):
        LogWriter.resume(path, commit=commit)
    assert path.read_bytes() == before


def test_an_error_of_the_writer_does_not_reach_other_readers(tmp_path, monkeypatch):
    """The file remains locked until HDF5 has closed it: until then it may still change it."""
    path = tmp_path / "run.h5"

    def fail(*_, **__):
        raise OSError(errno.ENOSPC, "no space")

    writer = new_writer(path)
    write_rows(writer, 100)
    with h5py.File(path, swmr=True, locking=False) as other:
        monkeypatch.setattr("idealgas.log.writer.commit_tables", fail)
        with pytest.raises(OutputError, match="No space left"):
            writer.close()
        descriptor = other.id.get_vfd_handle()
        assert os.path.samestat(os.fstat(descriptor), path.stat())
        assert in_another_process(path) == IN_USE


def test_a_reader_of_a_log_that_a_run_continues(tmp_path):
    """The run removes rows that the reader has not read yet: the log is not called damaged, and can be read again."""
    path = write_log(tmp_path / "run.h5", 200_000)
    with open_log(path) as log:
        with LogWriter.resume(path, 3) as writer:
            with pytest.raises(LogError, match="was changed by a run while it was being read"):
                check(log)
            write_rows(writer, 250_000)
        log.refresh()
        assert check(log) == 250_000


@posix
@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")  # of forks beside threads
def test_a_forked_child_has_no_part_in_the_lock(tmp_path):
    path = tmp_path / "log"
    path.touch()
    lock = WriteLock(path)
    reader, ours = os.pipe()
    if not (child := os.fork()):
        os.close(ours)
        os.read(reader, 1)
        os._exit(0)
    try:
        lock.close()
        deadline = time.monotonic() + 10
        while is_locked(path) and time.monotonic() < deadline:
            time.sleep(0.01)
        assert not is_locked(path)
    finally:
        os.close(ours)
        os.waitpid(child, 0)


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP], ids=errno.errorcode.get)
def test_a_file_system_without_locks(tmp_path, monkeypatch, number):
    """Logs are read; writing one needs the consent of the user, and this process still writes each only once."""

    def fail(*_):
        raise OSError(number, os.strerror(number))

    log = write_log(tmp_path / "run.h5", 100)
    monkeypatch.setattr("idealgas.system._lock", fail)
    monkeypatch.setattr("idealgas.system._test", fail)
    monkeypatch.delenv("HDF5_USE_FILE_LOCKING", raising=False)
    with open_log(log) as opened:
        assert (check(opened), opened.live) == (100, False)
    for action in (lambda: new_writer(tmp_path / "new.h5"), lambda: LogWriter.resume(log)):
        with pytest.raises(
            OutputError, match="cannot be written: this file system does not support locks; set HDF5_USE_FILE_LOCK"
        ) as caught:
            action()
        assert caught.value.exit_code == 1
    with written(tmp_path / "table.csv", ".csv") as part:
        part.write_text("")
    monkeypatch.setenv("HDF5_USE_FILE_LOCKING", "FALSE")
    with new_writer(tmp_path / "other.h5") as writer:
        write_rows(writer, 100)
        assert is_locked(tmp_path / "other.h5")
        refused(lambda: LogWriter.resume(tmp_path / "other.h5", None))

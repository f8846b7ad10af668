"""An HDF5 file that is open for writing by a single writer."""

import errno
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

import h5py

from idealgas.locks import WriteLock
from idealgas.log.hdf5.commit import Commit, commit_of
from idealgas.log.hdf5.superblock import clear_consistency_flags

OPTIONS: dict[str, Any] = {"libver": ("v110", "v110"), "locking": False}
"""Options of `h5py.File`, without HDF5's own lock, which SWMR mode drops and which may conflict with `WriteLock`."""


class ChangedError(Exception):
    """A file has been changed since it was read."""


class WritableFile:
    """An HDF5 file that is open for writing, and locked until it is closed.

    Attributes:
        file: the h5py file.
    """

    def __init__(self, path: Path, commit: Commit | None = None) -> None:
        """Open a file, even if its last writer did not close it.

        Args:
            path: path of the file.
            commit: newest commit that the file must have; None if any commit is accepted.

        Raises:
            ChangedError: if the newest commit of the file is a different one.
            BlockingIOError: if another writer has the file open.
            OSError: if the file cannot be opened for writing.
            ValueError: if the superblock of the file is damaged.
        """
        self._lock = WriteLock(path)
        try:
            if commit is not None and commit_of(path) != commit:
                raise ChangedError
            clear_consistency_flags(self._lock.descriptor)
            self.file = h5py.File(path, "r+", **OPTIONS)
        except BaseException:
            self._lock.close()
            raise
        if not self._alone:
            self.file.close()
            self._lock.close()
            raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))

    @property
    def _alone(self) -> bool:
        """Whether no other code in this process has the file open in HDF5, which would then be shared with it."""
        return h5py.h5f.get_obj_count(self.file.id, h5py.h5f.OBJ_FILE) == 1

    @property
    def removed(self) -> bool:
        """Whether the file has been deleted from its folder."""
        return os.fstat(self._lock.descriptor).st_nlink == 0

    def close(self) -> None:
        """Close the file.

        If other code in this process has the file open, HDF5 closes the file only when that code does, and the file
        remains locked until then. HDF5 may crash while closing a file that cannot be written, so HDF5 only flushes the
        file, and the file is then closed without HDF5 writing to it again.

        Raises:
            OSError: if flushing fails; the file is then abandoned.
        """
        if not self._alone:
            self.file.flush()
            self.file.close()
            return
        with self._lock:
            try:
                self.file.flush()
            finally:
                self._discard_writes()
            clear_consistency_flags(self._lock.descriptor)

    def abandon(self) -> None:
        """Close a file that can no longer be written, and leave it as if its writer had been killed."""
        if self._alone:
            self._discard_writes()
            self._lock.close()
        else:
            with suppress(OSError, RuntimeError):
                self.file.close()

    def _discard_writes(self) -> None:
        """Make HDF5 close the file without writing to it, because HDF5 clears the flags even after a failed write."""
        nowhere = os.open(os.devnull, os.O_RDWR)
        os.dup2(nowhere, self.file.id.get_vfd_handle())
        os.close(nowhere)
        with suppress(OSError, RuntimeError):
            self.file.close()

"""An HDF5 file that is being written, by one writer."""

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
"""Options of `h5py.File`. HDF5 frees its own lock in SWMR mode, and on some systems it collides with `WriteLock`."""


class ChangedError(Exception):
    """A file has been written since it was read."""


class WritableFile:
    """An HDF5 file, open for writing, and locked until it is closed.

    Attributes:
        file: the file for h5py.
    """

    def __init__(self, path: Path, commit: Commit | None = None) -> None:
        """Open a file, also if its last writer did not close it. commit: newest one that it must have, None for any.

        Raises:
            ChangedError: if it has another commit.
            BlockingIOError: if it is being written.
            OSError: if it cannot be written.
            ValueError: if its superblock is damaged.
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
        """Whether no other code in this process has opened the file with HDF5, which would share it with this one."""
        return h5py.h5f.get_obj_count(self.file.id, h5py.h5f.OBJ_FILE) == 1

    @property
    def removed(self) -> bool:
        """Whether the file has no name any more."""
        return os.fstat(self._lock.descriptor).st_nlink == 0

    def close(self) -> None:
        """Close the file. HDF5 does so only after other code has closed it too; until then it remains locked.

        HDF5 may crash where a file that it closes cannot be written, so it only flushes the file. Raises OSError if
        that fails, and the file is then abandoned.
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
        """Close a file that could not be written to, and leave it as if its writer had been killed."""
        if self._alone:
            self._discard_writes()
            self._lock.close()
        else:
            with suppress(OSError, RuntimeError):
                self.file.close()

    def _discard_writes(self) -> None:
        """Make HDF5 close the file without writing to it: it would clear the flags of a file with lost writes, too."""
        nowhere = os.open(os.devnull, os.O_RDWR)
        os.dup2(nowhere, self.file.id.get_vfd_handle())
        os.close(nowhere)
        with suppress(OSError, RuntimeError):
            self.file.close()

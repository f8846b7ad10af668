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
            clear_consistency_flags(path)
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
        """Close the file. HDF5 does so only after other code has closed it too; until then it remains locked."""
        alone = self._alone
        self.file.close()
        if alone:
            self._lock.close()

    def abandon(self) -> None:
        """Close a file that could not be written to, and leave it as if its writer had been killed."""
        alone = self._alone
        if alone:
            discard_writes(self.file)
        with suppress(OSError, RuntimeError):
            self.file.close()
        if alone:
            self._lock.close()


def discard_writes(file: h5py.File) -> None:
    """Discard what HDF5 would still write: when it closes a file, it writes what it can and clears the flags."""
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, file.id.get_vfd_handle())
    os.close(nowhere)

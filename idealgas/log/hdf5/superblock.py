"""The superblock of an HDF5 file, which contains the file consistency flags and the position of the end of the file.

The flags are set while a writer has the file open, and remain set if the writer did not close it; HDF5 then refuses to
open the file in the usual way. A superblock of version 3 has the flags in byte 11, the end of the file in bytes 28 to
35, and the lookup3 checksum of all previous bytes in bytes 44 to 47. Source: HDF5 File Format Specification 3.0, II.A.
"""

import errno
import io
import os
import struct
from pathlib import Path

from idealgas.locks import regular

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_SIZE = 48
_PAGE = 4096
_FAR = 1 << 50
_MASK = 0xFFFFFFFF


def has_consistency_flags(block: bytes) -> bool | None:
    """Return whether the flags are set, given the first bytes of a file; None if not a superblock of version 3."""
    return block[11] != 0 if len(block) >= _SIZE and block.startswith(_SIGNATURE) and block[8] == 3 else None


def clear_consistency_flags(descriptor: int) -> None:
    """Clear the file consistency flags of a file that was not closed.

    Args:
        descriptor: file descriptor, open for reading and writing.

    Raises:
        ValueError: if the superblock is damaged.
    """
    with open(descriptor, "r+b", closefd=False) as file:
        file.seek(0)
        block = file.read(_SIZE)
        if has_consistency_flags(block):
            end = -(-os.fstat(descriptor).st_size // _PAGE) * _PAGE
            block = _cleared(block, end)
            file.truncate(end)
            file.seek(0)
            file.write(block)


class ReadableFile(io.FileIO):
    """An HDF5 file, open for reading, whose file consistency flags appear to be cleared.

    HDF5 accesses the file only through this object, so HDF5 takes no locks and shares nothing with a writer in the same
    process. SWMR, HDF5's own mode for reading a file that is being written, is not used because it retries indefinitely
    when it meets a damaged byte. As a writer may extend the file at any moment, the file appears to be very long; bytes
    beyond its actual end read as zero.

    Attributes:
        unclosed: whether the flags are set; None if the file is not HDF5 with a superblock of version 3.
        end: size of the file according to the superblock, bytes; valid only if the file was closed.
    """

    def __init__(self, path: Path) -> None:
        """Open a file. Raises ValueError if the superblock is damaged."""
        super().__init__(path, opener=regular)
        self._at_end, self._head, self.end = False, b"", 0
        block = self.read(_SIZE)
        self.unclosed = has_consistency_flags(block)
        if self.unclosed is not None:
            try:
                self._head = _cleared(block, _FAR)
            except ValueError:
                self.close()
                raise
            (self.end,) = struct.unpack_from("<Q", block, 28)

    def __del__(self) -> None:
        self.close()  # HDF5 does not close this file

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Change the position in the file; the apparent end, which HDF5 seeks, may be too far for `lseek`."""
        self._at_end = whence == os.SEEK_END
        return _FAR if self._at_end else super().seek(offset, whence)

    def tell(self) -> int:
        """Return the position in the file."""
        return _FAR if self._at_end else super().tell()

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        """Read bytes into a buffer. Raises OSError if all of them lie beyond the end of the file."""
        start, data, count = self.tell(), memoryview(buffer).cast("B"), 0
        while size := super().readinto(data[count:]):
            count += size
        if not count:
            raise OSError(errno.EINVAL, "lies beyond the end of the file")
        data[count:] = bytes(len(data) - count)
        head = self._head[start : start + len(data)]
        data[: len(head)] = head
        return len(data)


def _cleared(block: bytes, end: int) -> bytes:
    """Return the superblock with cleared flags, for a file of `end` bytes.

    The end is replaced, too, because in a file that was not closed it is the end at the time of the last flush.
    """
    if len(block) < _SIZE or struct.unpack_from("<I", block, _SIZE - 4)[0] != lookup3(block[:-4]):
        raise ValueError("the superblock's checksum does not match")
    head = block[:11] + b"\0" + block[12:28] + struct.pack("<Q", end) + block[36:-4]
    return head + struct.pack("<I", lookup3(head))


def lookup3(data: bytes) -> int:
    """Return the lookup3 hash of one or more bytes.

    Source: Bob Jenkins, `hashlittle` of lookup3.c (2006, public domain), with initial value 0.
    """
    a = b = c = 0xDEADBEEF + len(data) & _MASK
    blocks = (len(data) - 1) // 12
    for block in range(blocks):
        x, y, z = struct.unpack_from("<III", data, 12 * block)
        a, b, c = _mix(a + x & _MASK, b + y & _MASK, c + z & _MASK)
    x, y, z = struct.unpack("<III", data[12 * blocks :].ljust(12, b"\0"))
    return _final(a + x & _MASK, b + y & _MASK, c + z & _MASK)


def _rotate(value: int, bits: int) -> int:
    return (value << bits | value >> 32 - bits) & _MASK


def _mix(a: int, b: int, c: int) -> tuple[int, int, int]:
    for bits in (4, 6, 8, 16, 19, 4):
        a, c = (a - c & _MASK) ^ _rotate(c, bits), c + b & _MASK
        a, b, c = b, c, a
    return a, b, c


def _final(a: int, b: int, c: int) -> int:
    for bits in (14, 11, 25, 16, 4, 14, 24):
        c = (c ^ b) - _rotate(b, bits) & _MASK
        a, b, c = b, c, a
    return b

"""Encode and decode chunks with HDF5's filter pipeline (shuffle, deflate, fletcher32), about as fast as memory allows.

A chunk may skip filters of the dataset's pipeline; each bit of its filter mask stands for a filter that is skipped.
Full chunks of a compressed dataset are shuffled and deflated; they need no fletcher32, because a zlib stream contains
an Adler-32. A chunk that is still growing is stored uncompressed with a fletcher32, so that its size and its position
in the file do not change.
"""

import struct

import numpy as np
from isal import igzip_lib, isal_zlib

from idealgas.jit import inline, njit

SHUFFLE, DEFLATE, FLETCHER32 = 1, 2, 4
COMPRESSED, PLAIN = FLETCHER32, SHUFFLE | DEFLATE
"""Filter masks of compressed and of growing chunks of a compressed dataset; each bit is a filter that is skipped."""

_STORED_BLOCK, _BLOCK_HEADER = 65_535, 5
"""Sizes of a full stored block of a deflate stream and of the block's header, bytes."""

_SAMPLE = 1024
"""Number of bytes of a plane that are tested to decide whether the plane is noise."""

_TILE = 2048
"""Number of items that are shuffled together, small enough for them to remain in the first-level cache."""

_WIDTHS = (4, 8)
"""Sizes of items that are shuffled by compiled functions, bytes; items of other sizes are shuffled with NumPy."""

_WORTH_LOADING = 64 * 2**20
"""Number of bytes that NumPy encodes or decodes in about the time it takes to load the compiled functions."""

_LARGEST_KEPT = 31 * 2**20
"""Size slightly below that of the largest block that glibc can be made to keep, bytes."""

_RESERVED = 2**20
"""Size of the memory that an encoder always keeps, bytes; it is larger than a chunk of events."""

_WORDS = 256
"""Number of 16-bit words for which the sum of each word times its index fits in 32 bits."""


@inline
def _gather_byte(items, byte, start, stop, out, place):
    """Copy one byte of each item from `start` up to, but not including, `stop` to consecutive bytes of `out`."""
    shift = np.uint64(8 * byte)
    for k in range(stop - start):
        out[np.uintp(place + k)] = np.uint8(items[np.uintp(start + k)] >> shift)


@njit
def shuffle(items, noise, blocks, planes):
    """Gather the bytes of items into planes: the first bytes of all items, then the second bytes, and so on.

    Args:
        items: (n,) unsigned integers.
        noise: number of planes, counted from the first, that are written to `blocks`.
        blocks: output, bytes of deflate's stored blocks, each with room for its header.
        planes: output, bytes of the remaining planes.
    """
    n = len(items)
    for first in range(0, n, _TILE):
        last = min(first + _TILE, n)
        for byte in range(items.itemsize):
            stored = byte < noise
            start = first
            while start < last:
                stop, place = last, (byte if stored else byte - noise) * n + start
                if stored:
                    stop = min(last, start + _STORED_BLOCK - place % _STORED_BLOCK)
                    place += (place // _STORED_BLOCK + 1) * _BLOCK_HEADER
                _gather_byte(items, byte, start, stop, blocks if stored else planes, place)
                start = stop


def _shuffle_in_numpy(items, noise, blocks, planes):
    """Do the same as `shuffle`, with NumPy."""
    n, words = len(items), items.view(np.uint8).reshape(-1, items.itemsize).T
    planes.reshape(-1, n)[:] = words[noise:]
    stored = words[:noise].reshape(-1)
    for k, start in enumerate(range(0, len(stored), _STORED_BLOCK)):
        part, place = stored[start : start + _STORED_BLOCK], start + (k + 1) * _BLOCK_HEADER
        blocks[place : place + len(part)] = part


@inline
def _scatter_byte(items, byte, start, stop, plane):
    """Set one byte of each item from `start` up to, but not including, `stop`; setting byte 0 clears the others."""
    shift = np.uint64(8 * byte)
    for k in range(start, stop):
        value = np.uint64(plane[np.uintp(k)]) << shift
        items[np.uintp(k)] = value if byte == 0 else items[np.uintp(k)] | value


@njit
def unshuffle(planes, items):
    """Reassemble unsigned items (n,) from their planes (itemsize, n)."""
    n = len(items)
    for first in range(0, n, _TILE):
        for byte in range(items.itemsize):
            _scatter_byte(items, byte, first, min(first + _TILE, n), planes[byte])


class Encoder:
    """Encoder of chunks that reuses its memory, because allocating memory for a chunk takes longer than encoding it.

    Memory for a larger chunk, such as a checkpoint of a large gas, is freed when a smaller chunk follows. The result of
    a method is valid only until the next call of any method.
    """

    def __init__(self) -> None:
        self._planes = self._bytes = np.empty(0, np.uint8)

    def compressed(self, rows: np.ndarray) -> np.ndarray:
        """Return the bytes of a full chunk, shuffled and deflated.

        The low-order bytes of a computed number look like noise. Planes of which a sample cannot be compressed become
        stored blocks, which are written and read in a fraction of the time.
        """
        self._reserve(rows.nbytes)
        items = np.ascontiguousarray(rows).reshape(-1)
        noise, planes = self._shuffle(items) if items.itemsize in _WIDTHS else (0, _shuffled(items))
        size, adler = self._put(0, b"\x78\x01"), 1
        stored = noise * len(items)
        for start in range(0, stored, _STORED_BLOCK):
            length = min(_STORED_BLOCK, stored - start)
            size = self._put(size, struct.pack("<BHH", 0, length, length ^ 0xFFFF))
            adler = isal_zlib.adler32(self._bytes[size : size + length], adler)
            size += length
        deflate = isal_zlib.compressobj(1, isal_zlib.DEFLATED, -15)
        size = self._put(size, deflate.compress(planes))
        size = self._put(size, deflate.flush())
        size = self._put(size, isal_zlib.adler32(planes, adler).to_bytes(4, "big"))
        return self._bytes[:size]

    def _shuffle(self, items: np.ndarray) -> tuple[int, np.ndarray]:
        """Copy the planes that are noise to stored blocks; return their number and the bytes of the other planes."""
        words, width, blocks = items.view(f"u{items.itemsize}"), items.itemsize, self._bytes[2:]
        noise = width if len(items) >= _SAMPLE else 0
        gather = shuffle if _is_worth_loading(items.nbytes) else _shuffle_in_numpy
        if noise:
            sample = self._planes[: width * _SAMPLE]
            gather(words[:_SAMPLE], 0, blocks, sample)
            while noise and len(isal_zlib.compress(sample.reshape(width, -1)[noise - 1], 0)) < _SAMPLE:
                noise -= 1
        planes = self._planes[: (width - noise) * len(items)]
        gather(words, noise, blocks, planes)
        return noise, planes

    def plain(self, rows: np.ndarray) -> np.ndarray:
        """Return the bytes of a chunk, uncompressed, followed by its fletcher32."""
        self._reserve(rows.nbytes)
        size = self._put(0, np.ascontiguousarray(rows).reshape(-1).view(np.uint8))
        size = self._put(size, fletcher32(self._bytes[:size]))
        return self._bytes[:size]

    def _put(self, start: int, data: bytes | np.ndarray) -> int:
        stop = start + len(data)
        self._bytes[start:stop] = np.frombuffer(data, np.uint8)
        return stop

    def _reserve(self, size: int) -> None:
        size = max(size, _RESERVED)
        if len(self._planes) != size:
            self._planes = np.empty(size, np.uint8)
            self._bytes = np.empty(most_stored(size), np.uint8)


def _shuffled(items: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(items.view(np.uint8).reshape(-1, items.itemsize).T)


def most_stored(size: int) -> int:
    """Return the largest stored size of a chunk of `size` bytes; incompressible data grow slightly."""
    return size + size // 64 + 1024


def decode(stored: bytes | memoryview, mask: int, dtype: np.dtype, values: int, verify: bool = True) -> np.ndarray:
    """Return the values of a stored chunk, (values,).

    At most one byte more than the declared size is decompressed, so that a malicious chunk cannot fill the memory.

    Args:
        stored: bytes in the file.
        mask: filter mask, whose bits stand for the filters that were skipped.
        dtype: type of the values.
        values: expected number of values.
        verify: whether the fletcher32, if present, has to match.

    Raises:
        ValueError: if the chunk is damaged or has a different number of values.
    """
    size = values * dtype.itemsize
    data: bytes | memoryview = memoryview(stored)
    if not mask & FLETCHER32:
        if verify and fletcher32(data[:-4]) != data[-4:]:
            raise ValueError("a checksum does not match")
        data = data[:-4]
    if not mask & DEFLATE:
        stream = igzip_lib.IgzipDecompressor(igzip_lib.DECOMP_ZLIB)  # a little faster than the class in `isal_zlib`
        try:
            data = stream.decompress(data, size + 1)
        except igzip_lib.error as error:  # type: ignore[misc]
            raise ValueError(f"a compressed chunk: {error}") from error
        if not stream.eof:
            raise ValueError(f"a compressed chunk: does not end at {size:,} bytes")
    if len(data) != size:
        raise ValueError(f"a chunk of {len(data):,} bytes (allowed {size:,})")
    if not mask & SHUFFLE and dtype.itemsize > 1:
        planes = np.frombuffer(data, np.uint8).reshape(dtype.itemsize, -1)
        planes.flags.writeable = False  # arrays always have the same type, so that the function is compiled once
        if dtype.itemsize in _WIDTHS and _is_worth_loading(size):
            items = np.empty(planes.shape[1], f"u{dtype.itemsize}")
            unshuffle(planes, items)
            return items.view(dtype)
        return np.ascontiguousarray(planes.T).reshape(-1).view(dtype)
    return np.frombuffer(data, dtype)


def keep_freed_memory() -> None:
    """Make the C library keep the memory of a chunk for the next chunk, which saves a quarter of the reading time.

    glibc returns every freed block that is larger than all blocks freed before to the system, and then has to request
    zeroed pages again.
    """
    np.empty(_LARGEST_KEPT, np.uint8)


def fletcher32(data: bytes | memoryview | np.ndarray) -> bytes:
    """Return HDF5's Fletcher-32 checksum of data, as the four bytes that follow the data in the file.

    The checksum consists of the sum of the data as 16-bit big-endian words and the sum of the running sums. Here both
    are computed from little-endian words: swapping the bytes of every word multiplies both sums by 256 modulo 65535.
    """
    words = np.frombuffer(data, "<u2", len(data) // 2)
    words.flags.writeable = False  # arrays always have the same type, so that the function is compiled once
    total, moment = map(int, (_sums if _is_worth_loading(len(data)) else _sums_in_numpy)(words))
    simple, running = 256 * total, 256 * (len(words) * total - moment)
    if len(data) % 2:
        simple += int(data[-1]) << 8
        running += simple
    return struct.pack("<HH", _fold(simple), _fold(running))


_processed = 0


def _is_worth_loading(size: int) -> bool:
    """Return whether to use compiled functions for the next `size` bytes; loading them does not pay for a small log."""
    global _processed
    _processed += size
    return _processed > _WORTH_LOADING


def _sums_in_numpy(words: np.ndarray) -> tuple[int, int]:
    """Return the same as `_sums`, computed with NumPy in floats, which represent each partial sum exactly."""
    total = moment = 0
    for first in range(0, len(words), 65535):
        part = words[first : first + 65535].astype(float)
        total += int(part.sum())
        moment += int(part @ np.arange(len(part), dtype=float))
    return total, moment


@njit
def _sums(words):
    """Return the sum of 16-bit words (n,) and the sum of each word times its index, up to multiples of 65535."""
    total = moment = np.int64(0)
    for first in range(0, len(words), _WORDS):
        total_here = np.uint32(0)
        moment_here = np.uint32(0)
        for k in range(np.uint32(min(_WORDS, len(words) - first))):
            word = np.uint32(words[np.uintp(first + k)])
            total_here += word
            moment_here += np.uint32(k) * word
        total += np.int64(total_here)
        moment += np.int64(moment_here) + first % 65535 * np.int64(total_here)
    return total, moment


def _fold(value: int) -> int:
    """Return a value modulo 65535, but 65535 for positive multiples of 65535, as in a sum with end-around carry."""
    return (value - 1) % 65535 + 1 if value else 0

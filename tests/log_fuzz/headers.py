"""HDF5 structures that somebody changed on purpose: a field of a header is another, and its check sum fits again."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from idealgas.log.hdf5.superblock import lookup3
from log_fuzz.damages import Damaged
from log_fuzz.sound import LIVE, hold

SIZES = {b"EAHD": 72, b"FAHD": 28, b"BTHD": 38, b"\x89HDF\r\n\x1a\n": 48}
"""Lengths of headers, bytes, with the check sum in the last four: HDF5 File Format Specification 3.0."""


def spoil(case: int, path: Path, sound: dict[str, bytes], names: Sequence[str]) -> Damaged:
    """Make log number `case` with one or more changed headers at a path."""
    random = np.random.default_rng([case, 22])
    name = names[case % len(names)]
    data, what = bytearray(sound[name]), []
    places = list(headers(data))
    for _ in range(int(random.integers(1, 4))):
        start, size = places[int(random.integers(len(places)))]
        place = start + int(random.integers(4, size - 4))
        way = ("byte", "small", "large", "bit")[int(random.integers(4))]
        if way == "byte":
            data[place] = int(random.integers(256))
        elif way == "bit":
            data[place] ^= 1 << int(random.integers(8))
        else:
            wide = min(int(random.choice([1, 2, 4, 8])), start + size - 4 - place)
            number = int(random.integers(0, 9)) if way == "small" else 256**wide - 1 - int(random.integers(0, 9))
            data[place : place + wide] = (number % 256**wide).to_bytes(wide, "little")
        data[start + size - 4 : start + size] = lookup3(data[start : start + size - 4]).to_bytes(4, "little")
        what.append(f"{way} at {place} in {bytes(data[start : start + 4])!r} at {start}")
    path.write_bytes(data)
    if name == LIVE:
        hold(path)
    return Damaged(name, ", ".join(what))


def headers(data: bytes) -> Iterator[tuple[int, int]]:
    """Place and length of each header with a check sum that fits."""
    for mark in (*SIZES, b"OHDR"):
        start = data.find(mark)
        while start >= 0:
            size = SIZES.get(mark) or _object_header(data, start)
            block = data[start : start + size]
            if len(block) == size > 8 and lookup3(block[:-4]) == int.from_bytes(block[-4:], "little"):
                yield start, size
            start = data.find(mark, start + 1)


def _object_header(data: bytes, start: int) -> int:
    """Length of an object header without its continuations."""
    flags = data[start + 5]
    wide = 1 << (flags & 3)
    at = start + 6 + 16 * bool(flags & 32) + 4 * bool(flags & 16)
    return at + wide + int.from_bytes(data[at : at + wide], "little") + 4 - start

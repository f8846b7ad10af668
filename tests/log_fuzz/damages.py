"""Accidents: bytes that changed, blocks that were lost or stand elsewhere, and ends that are cut off."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from log_fuzz.sound import LIVE, hold

BLOCK = 4096


class Damaged(NamedTuple):
    """A log and what happened to it."""

    sound: str
    what: str


def damage(case: int, path: Path, sound: dict[str, bytes], names: Sequence[str]) -> Damaged:
    """Make damaged log number `case` at a path."""
    random = np.random.default_rng([case, 21])
    name = names[case % len(names)]
    data = bytearray(sound[name])
    what = []
    for _ in range(1 if random.random() < 0.8 else int(random.integers(2, 20))):
        near = len(data) if random.random() < 0.5 else min(len(data), 40_000)  # most of the structure is at the start
        place = int(random.integers(near))
        way = ("byte", "bit", "zeros", "noise", "copy", "cut")[random.choice(6, p=[0.3, 0.2, 0.15, 0.1, 0.1, 0.15])]
        size = int(2 ** random.uniform(1, 13))
        block = slice(place, min(place + size, len(data)))
        if way == "byte":
            data[place] ^= int(random.integers(1, 256))
        elif way == "bit":
            data[place] ^= 1 << int(random.integers(8))
        elif way == "zeros":
            data[block] = bytes(block.stop - block.start)
        elif way == "noise":
            data[block] = random.bytes(block.stop - block.start)
        elif way == "copy":
            start = int(random.integers(len(data) // BLOCK + 1)) * BLOCK
            part = data[start : start + BLOCK]
            to = place // BLOCK * BLOCK
            data[to : to + len(part)] = part
        else:
            del data[max(1, place) :]
        what.append(f"{way} at {place}")
    path.write_bytes(data)
    if name == LIVE:
        hold(path)
    return Damaged(name, ", ".join(what))

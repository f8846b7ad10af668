"""The logs that every crafted and every damaged one begins with.

They are the old ones in `cases/logs`, with all effects, and some that this program makes: of the newest layout, and
with more than one chunk of events, which are not compressed.
"""

import lzma
import os
import signal
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import h5py
from log_compare import scene_of

from idealgas.log.hdf5.commit import DATASET, Commit
from idealgas.log.hdf5.superblock import Unmarked, is_marked, lock
from idealgas.run.simulate import simulate

FOLDER = Path(__file__).parents[1] / "cases" / "logs"
PACKED = ".h5.xz"
OLD = tuple(sorted(path.name.removesuffix(PACKED) for path in FOLDER.glob(f"*{PACKED}")))
SOME = ("plain", "killed", "effects", "monte-carlo", "no-events", "rough", "gate")
"""Those of which the quicker tests are made: each method, with events and without, and every column."""
LIVE = "live"
"""The one that was killed, while another process holds it as its writer would."""
MADE = {
    "sums": ("mixture", "run.events=3000", "log.pressure=true", "log.snapshot_every=0.5"),
    "waves": ("sound", "species.0.count=56", "box.size=[12, 12]", "run.until=60"),
    "grains": ("cooling", "species.0.count=60", "run.until=100"),
    "chunks": ("quickstart", "run.events=40000", 'log.compression="none"'),
}
"""Scenes of those that are made."""
CRAFTED = (*OLD, "sums", "waves", "grains")
DAMAGED = (*OLD, LIVE, *MADE)


@cache
def unpacked(name: str) -> bytes:
    """The bytes of a sound log."""
    if name not in MADE:
        return lzma.decompress((FOLDER / f"{'killed' if name == LIVE else name}{PACKED}").read_bytes())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.h5"
        simulate(scene_of(*MADE[name]), path)
        return path.read_bytes()


def states(name: str) -> list[bytes]:
    """A sound log; of one whose writer died also what it was a commit before, which damage may bring back."""
    data = bytearray(unpacked(name))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.h5"
        path.write_bytes(data)
        if not is_marked(path):
            return [bytes(data)]
        with h5py.File(Unmarked(path), "r") as file:
            newest = Commit.read(file).sequence % 2
            place = file[DATASET].id.get_chunk_info_by_coord((newest, 0)).byte_offset
    before = data.copy()
    before[place] ^= 1
    return [bytes(data), bytes(before)]


@contextmanager
def held(path: Path) -> Iterator[int]:
    """Let another process hold a log as its writer; yields its number."""
    process = hold(path)
    try:
        yield process
    finally:
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)


def hold(path: Path) -> int:
    """The process that holds a log as its writer, until it is killed or the one that made it is gone."""
    ready, tell = os.pipe()
    alive, _kept_open = os.pipe()
    process = os.fork()
    if not process:
        os.close(_kept_open)
        with path.open("r+b") as file:
            lock(file)
            os.write(tell, b"x")
            os.read(alive, 1)
        os._exit(0)
    os.close(tell)
    os.close(alive)
    os.read(ready, 1)
    os.close(ready)
    return process

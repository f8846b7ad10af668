"""Logs with known contents: event row k is a function of k alone. As a script: write such a log until it is killed.

log_samples.py PATH gzip|none [ROWS A BATCH]
"""

import subprocess
import sys
import time
from dataclasses import fields
from functools import lru_cache
from itertools import count
from pathlib import Path

import numpy as np

import idealgas.log.writer as log_writer
from idealgas.columns import BLOCK, COUNTED, EventBatch, Kind
from idealgas.log import Column, Log, LogError, LogLayout, LogWriter, box_walls, open_log
from idealgas.state import Gas

DISCS = 25
STEP = 2.0**-10
OBSERVABLES = (Column("kinetic_energy", "f8", (), "energy"), Column("hits", "i8"))
VALUES = (Column("hits", "i8"),)
BATH_VALUES = (*VALUES, COUNTED[Kind.THERMOSTAT])
"""Columns of checkpoints of a log with a heat bath."""


def gas(discs: int = DISCS) -> Gas:
    random = np.random.default_rng(1)
    return Gas(
        box=(10.0, 5.0),
        position=random.uniform(1, 4, (discs, 2)),
        velocity=random.normal(size=(discs, 2)),
        radius=np.full(discs, 0.1),
        mass=np.linspace(1, 2, discs),
        species=np.arange(discs, dtype=np.uint16) % 2,
        species_names=("light", "schwer — ü")[:discs],
    )


@lru_cache(64)
def rows(start: int, stop: int) -> EventBatch:
    """Event rows `start` to `stop`: wall hits at multiples of a power of two."""
    k = np.arange(start, stop)
    noise = np.sin(np.outer(k + 1, [12.9898, 78.233, 39.425, 27.17])) * 43758.5453
    noise -= np.floor(noise)
    return EventBatch(
        time=k * STEP,
        disc=(k * 7 % DISCS).astype(np.uint32),
        partner=(-1 - k % 4).astype(np.int32),
        kind=np.full(len(k), Kind.WALL, np.uint8),
        position=noise[:, :2] * [10, 5],
        velocity=noise[:, 2:] - 0.5,
    )


def new_writer(path: Path, **options) -> LogWriter:
    """options: of the layout and of the writer."""
    room = {"walls": box_walls((10.0, 5.0)), "checkpoint_values": VALUES, "observables": OBSERVABLES}
    names = {field.name for field in fields(LogLayout)}
    layout = LogLayout(**(room | {name: value for name, value in options.items() if name in names}))
    given = {"scene_text": "[scene]\ntitle = 'ü'\n", "seed": 7, "command": "test"}
    return LogWriter(path, gas(), layout, **(given | {n: v for n, v in options.items() if n not in names}))


def write_rows(writer: LogWriter, stop: int, sizes=(1, 300, 20_000, BLOCK, 77)) -> None:
    """Write rows up to `stop` in batches of these sizes, each after a sample and a checkpoint."""
    for size in (size for _ in count() for size in sizes):
        if writer.rows >= stop:
            return
        write_checkpoint(writer)
        _, size = filled(writer, min(size, stop - writer.rows))
        writer.write(size)


def filled(writer: LogWriter, most: int) -> tuple[EventBatch, int]:
    """The next batch of a writer, with as many of the next rows as it has room for, and their number."""
    batch = writer.batch()
    size = min(most, len(batch.time))
    for column, values in zip(batch, rows(writer.rows, writer.rows + size), strict=True):
        if values is not None:
            column[:size] = values
    return batch, size


def write_checkpoint(writer: LogWriter) -> None:
    row = writer.rows
    writer.observe(row * STEP, row, {"kinetic_energy": row / 3, "hits": row})
    writer.checkpoint(row * STEP, row, checkpoint_arrays(row), {"hits": -row, COUNTED[Kind.THERMOSTAT].name: 0})


def checkpoint_arrays(row: int) -> dict[str, np.ndarray]:
    return {"position": (row + np.arange(2.0 * DISCS).reshape(-1, 2)) % 5, "velocity": np.full((DISCS, 2), row / 7)}


def write_log(path: Path, stop: int, summary: dict | None = None, **options) -> Path:
    with new_writer(path, **options) as writer:
        write_rows(writer, stop)
        writer.close({"end_time": stop * STEP, "rows": stop} if summary is None else summary)
    return path


def check(log: Log) -> int:
    """Assert that a log has exactly the first rows, samples and checkpoints; returns the number of rows."""
    row = 0
    for block in log.chunks():
        expected = rows(row, row + len(block.time))
        for column, values in zip(block, expected, strict=True):
            assert (column is None and values is None) or np.array_equal(column, values)
        row += len(block.time)
    assert row == len(log)
    for checkpoint in log.checkpoints:
        assert checkpoint.time == checkpoint.row * STEP
        assert checkpoint.epoch == checkpoint.row == -checkpoint.values["hits"] <= len(log)
        assert all(np.array_equal(checkpoint.arrays[key], a) for key, a in checkpoint_arrays(checkpoint.row).items())
    times, energies = log.observables["kinetic_energy"]
    assert np.array_equal(energies, times / STEP / 3)
    assert np.array_equal(log.observables["hits"][1], times / STEP)
    start = gas()
    for name in ("position", "velocity", "radius", "mass", "species"):
        assert np.array_equal(getattr(log.discs, name), getattr(start, name))
    assert (log.box, log.discs.species_names) == (start.box, start.species_names)
    assert (log.scene_text, log.command) == ("[scene]\ntitle = 'ü'\n", "test")
    assert log.walls == box_walls((10.0, 5.0))
    return row


def rows_in(path: Path) -> int:
    """Number of committed rows, 0 before the file exists."""
    try:
        with open_log(path) as log:
            return len(log)
    except LogError:
        return 0


def start_writer(path: Path, *arguments: str, rows: int = 1) -> subprocess.Popen[bytes]:
    """A process that writes a log until it is killed, and has already written so many rows."""
    child = subprocess.Popen([sys.executable, __file__, path, *arguments])
    deadline = time.monotonic() + 60
    while rows_in(path) < rows:
        assert child.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return child


def main() -> None:
    path, compression, *most = sys.argv[1:]
    log_writer.FLUSH_SECONDS = 0.05
    with new_writer(Path(path), compression=compression) as writer:
        while True:
            write_rows(writer, writer.rows + int(most[0] if most else BLOCK))
            if most:
                time.sleep(0.001)


if __name__ == "__main__":
    main()

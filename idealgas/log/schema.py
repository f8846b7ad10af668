"""The layout of a log: every dataset with its type, unit and chunk, and the making of an empty file.

Rows come in tables, a dataset for each column: `events`, `checkpoints`, `observables`, and `summary`, whose rows say
that the run came to its end, and how. How many rows of each hold is in the commit record (`commit.py`), nowhere else.
"""

import importlib.metadata
import platform
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import NamedTuple

import h5py
import numpy as np

import idealgas
from idealgas.events import BLOCK, BOX_SIDES, COLUMN_UNITS, Kind
from idealgas.gas import Gas
from idealgas.log import chunks
from idealgas.log.commit import Commit

FORMAT = "idealgas log"
VERSION = 1
H5MD_VERSION = (1, 1)
FILE_OPTIONS: dict = {"libver": ("v110", "v110")}
PAGES: dict = {"fs_strategy": "page", "fs_page_size": 4096}
"""Small blocks never lie across two pages of the file, so that a process cannot die between two halves of one."""


class Column(NamedTuple):
    """One column of a table: `shape` is that of a row's entry, `dtype` and `unit` those of its numbers."""

    name: str
    dtype: str
    shape: tuple[int, ...] = ()
    unit: str = ""


class Wall(NamedTuple):
    """A wall as events refer to it: wall k is partner -1 - k."""

    name: str
    start: tuple[float, float]
    end: tuple[float, float]


EVENT_COLUMNS = (
    Column("time", "f8", (), COLUMN_UNITS["time"]),
    Column("disc", "u4", (), COLUMN_UNITS["disc"]),
    Column("partner", "i4", (), COLUMN_UNITS["partner"]),
    Column("kind", "u1", (), COLUMN_UNITS["kind"]),
    Column("position", "f8", (2,), COLUMN_UNITS["position"]),
    Column("velocity", "f8", (2,), COLUMN_UNITS["velocity"]),
)
CHECKPOINT_COLUMNS = (Column("time", "f8", (), "time"), Column("row", "i8"), Column("epoch", "i8"))
"""What every checkpoint has: its time, the event rows before it, and the number of epochs before it."""
CHECKPOINT_ARRAYS = (Column("position", "f8", (2,), "length"), Column("velocity", "f8", (2,), "length/time"))
"""What a checkpoint has of each disc."""
SAMPLE_COLUMNS = (Column("step", "i8"), Column("time", "f8", (), "time"))
"""Shared by all observables; the step is the number of epochs."""
SUMMARY_COLUMNS = (Column("name", "S64"), Column("value", "S256"))
"""One row for each thing that a run tells of itself at its end; the values are JSON."""
DISC_COLUMNS = (
    Column("position", "f8", (2,), "length"),
    Column("velocity", "f8", (2,), "length/time"),
    Column("radius", "f8", (), "length"),
    Column("mass", "f8", (), "mass"),
    Column("species", "u2"),
)

CHECKPOINT_ENTRIES = 4096
"""A chunk of checkpoints holds about as many disc records, and at least one checkpoint."""
SAMPLES = 1024
SUMMARY_ROWS = 64
"""Rows of `observables` and of `summary` in a chunk."""


def box_walls(box: tuple[float, float]) -> list[Wall]:
    """The four sides of the box, in the order of `BOX_SIDES`."""
    width, height = box
    ends = [((0, 0), (0, height)), ((width, 0), (width, height)), ((0, 0), (width, 0)), ((0, height), (width, height))]
    return [Wall(name, *end) for name, end in zip(BOX_SIDES, ends, strict=True)]


def write_header(
    file: h5py.File, gas: Gas, walls: Sequence[Wall], scene_text: str, seed: int, command: str, compression: str
) -> None:
    """What is known before the run: versions, scene, discs and walls."""
    file.attrs.update(
        {
            "format": np.bytes_(FORMAT),
            "format_version": VERSION,
            "seed": np.bytes_(str(seed)),  # a seed may have more than 64 bits
            "created": np.bytes_(datetime.now(UTC).isoformat(timespec="seconds")),
        }
    )
    versions = file.create_group("versions").attrs
    versions.update({"idealgas": np.bytes_(idealgas.__version__), "python": np.bytes_(platform.python_version())})
    versions.update({name: np.bytes_(importlib.metadata.version(name)) for name in ("numpy", "numba", "h5py", "isal")})
    versions["hdf5"] = np.bytes_(h5py.version.hdf5_version)
    h5md = file.create_group("h5md")
    h5md.attrs["version"] = H5MD_VERSION
    h5md.create_group("author").attrs["name"] = np.bytes_("unknown")
    h5md.create_group("creator").attrs.update(
        {"name": np.bytes_("idealgas"), "version": np.bytes_(idealgas.__version__)}
    )

    def store(name: str, data: np.ndarray, unit: str = "") -> None:
        _store(file, name, data, unit, compression)

    store("scene", _text([scene_text]))
    store("command", _text([command]))
    store("box", np.array(gas.box, "f8"), "length")
    for column in DISC_COLUMNS:
        store(f"discs/{column.name}", np.asarray(getattr(gas, column.name), column.dtype), column.unit)
    store("discs/species_name", _text(gas.species_names))
    store("walls/name", _text([wall.name for wall in walls]))
    store("walls/endpoints", np.array([(wall.start, wall.end) for wall in walls], "f8").reshape(-1, 2, 2), "length")


def create_tables(
    file: h5py.File,
    discs: int,
    event_columns: Sequence[Column],
    checkpoint_arrays: Sequence[Column],
    checkpoint_values: Sequence[Column],
    observables: Sequence[Column],
    compression: str,
) -> None:
    """Empty tables and the commit record, which lists the tables' datasets. A table without columns does not exist."""
    paths: list[str] = []

    def add(path: str, column: Column, rows: int) -> None:
        if path == "events/kind":
            column = column._replace(dtype=h5py.enum_dtype({kind.name: kind.value for kind in Kind}, basetype="u1"))
        dataset = file.create_dataset(
            path,
            shape=(0, *column.shape),
            maxshape=(None, *column.shape),
            chunks=(rows, *column.shape),
            dtype=column.dtype,
            **filters(compression),
        )
        if column.unit:
            dataset.attrs["unit"] = np.bytes_(column.unit)
        paths.append(path)

    for column in event_columns:
        add(f"events/{column.name}", column, BLOCK)
    some = max(1, CHECKPOINT_ENTRIES // discs)
    for column in (*CHECKPOINT_COLUMNS, *checkpoint_values):
        add(f"checkpoints/{column.name}", column, some)
    for column in checkpoint_arrays:
        add(f"checkpoints/{column.name}", column._replace(shape=(discs, *column.shape)), some)
    if observables:
        first = f"observables/{observables[0].name}"
        for column in SAMPLE_COLUMNS:
            add(f"{first}/{column.name}", column, SAMPLES)
        for column in observables:
            path = f"observables/{column.name}"
            add(f"{path}/value", column, SAMPLES)
            if path != first:
                for shared in SAMPLE_COLUMNS:
                    file[f"{path}/{shared.name}"] = file[f"{first}/{shared.name}"]
    for column in SUMMARY_COLUMNS:
        add(f"summary/{column.name}", column, SUMMARY_ROWS)
    Commit.create(file, paths)


def filters(compression: str) -> dict:
    """The filter pipeline of a dataset as h5py's keywords."""
    deflate = {"compression": "gzip", "compression_opts": 1, "shuffle": True} if compression == "gzip" else {}
    return {**deflate, "fletcher32": True}


def _store(file: h5py.File, name: str, data: np.ndarray, unit: str, compression: str) -> None:
    """A dataset that never changes, in one chunk: what is stored contiguously has no checksum."""
    if not data.size:
        file.create_dataset(name, data=data)
        return
    dataset = file.create_dataset(name, shape=data.shape, dtype=data.dtype, chunks=data.shape, **filters(compression))
    if unit:
        dataset.attrs["unit"] = np.bytes_(unit)
    start = (0,) * data.ndim
    if compression == "gzip":
        dataset.id.write_direct_chunk(start, chunks.Encoder().compressed(data), chunks.COMPRESSED)
    else:
        dataset.id.write_direct_chunk(start, chunks.Encoder().plain(data))


def _text(texts: Sequence[str]) -> np.ndarray:
    """UTF-8 strings of fixed length: what has variable length lies in a heap without checksums."""
    coded = [text.encode() for text in texts]
    size = max([1, *map(len, coded)])
    return np.array(coded, h5py.string_dtype("utf-8", size))

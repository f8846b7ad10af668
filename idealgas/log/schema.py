"""The layout of a log: every dataset with its type, unit and chunk, and the making of an empty file.

Rows come in tables, a dataset for each column: `runs`, whose last row has the scene that the log is of; `events`;
`checkpoints`; `observables`; the snapshots in `particles`; and `summary`, whose rows say that the run came to its end,
and how. How many rows of each hold is in the commit record (`commit.py`), nowhere else.
"""

import importlib.metadata
import platform
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from functools import cache
from typing import Any, NamedTuple

import h5py
import numpy as np

from idealgas._version import __version__
from idealgas.events import BLOCK, BOX_SIDES, COLUMN_UNITS, Kind
from idealgas.gas.state import Gas
from idealgas.log.hdf5.commit import Commit
from idealgas.log.hdf5.objects import Objects, set_attributes

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
"""Shared by all observables, whose step is the number of epochs, and by all that snapshots have of a disc."""
SUMMARY_COLUMNS = (Column("name", "S64"), Column("value", "S256"))
"""One row for each thing that a run tells of itself at its end; the values are JSON."""
DISC_COLUMNS = (
    Column("position", "f8", (2,), "length"),
    Column("velocity", "f8", (2,), "length/time"),
    Column("radius", "f8", (), "length"),
    Column("mass", "f8", (), "mass"),
    Column("species", "u2"),
)

SHORTEST_CHUNK = 8192
"""Rows of events in a chunk of a run that cannot have many; another one may go on with its log."""
DISC_RECORDS = 4096
"""A chunk of checkpoints or snapshots holds about as many disc records, and at least one state."""
SAMPLES = 1024
SUMMARY_ROWS = 64
"""Rows of `observables` and of `summary` in a chunk."""
SCENE_SLACK = 256
COMMAND_SIZE = 1024
"""Bytes by which the text of a scene may grow as its run gets a new end, and of a command."""


def box_walls(box: tuple[float, float]) -> list[Wall]:
    """The four sides of the box, in the order of `BOX_SIDES`."""
    width, height = box
    ends = [((0, 0), (0, height)), ((width, 0), (width, height)), ((0, 0), (width, 0)), ((0, height), (width, height))]
    return [Wall(name, *end) for name, end in zip(BOX_SIDES, ends, strict=True)]


class Surroundings(NamedTuple):
    """What a disc flies in. boundary: of each axis, "none" or "periodic". gravity: length/time²."""

    walls: Sequence[Wall]
    boundary: tuple[str, str] = ("none", "none")
    gravity: tuple[float, float] = (0.0, 0.0)


def write_header(
    file: h5py.File,
    gas: Gas,
    surroundings: Surroundings,
    disc_columns: Mapping[Column, np.ndarray],
    seed: int,
    trajectory: int,
    compression: str,
) -> None:
    """What is known before the run: versions, box, discs and walls."""
    objects = Objects(file.id, compression)
    set_attributes(
        file.id,
        format=np.bytes_(FORMAT),
        format_version=VERSION,
        seed=np.bytes_(str(seed)),  # a seed may have more than 64 bits
        created=np.bytes_(datetime.now(UTC).isoformat(timespec="seconds")),
    )
    set_attributes(objects.group("versions"), **_versions(), trajectory=trajectory)
    set_attributes(objects.group("h5md"), version=H5MD_VERSION)
    set_attributes(objects.group("h5md/author"), name=np.bytes_("unknown"))
    set_attributes(objects.group("h5md/creator"), name=np.bytes_("idealgas"), version=np.bytes_(__version__))
    walls, store = surroundings.walls, objects.constant
    box = store("box", np.array(gas.box, "f8"), "length")
    set_attributes(box, boundary=np.array(surroundings.boundary, "S"))
    store("gravity", np.array(surroundings.gravity, "f8"), "length/time^2")
    store("discs/id", np.arange(len(gas), dtype="u4"))
    given = {column: getattr(gas, column.name) for column in DISC_COLUMNS} | dict(disc_columns)
    for column, values in given.items():
        store(f"discs/{column.name}", np.asarray(values, column.dtype), column.unit)
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
    snapshot_arrays: Sequence[Column],
    text_sizes: Mapping[str, int],
    most_rows: int,
    compression: str,
) -> None:
    """Empty tables and the commit record, which lists the tables' datasets. A table without columns does not exist.

    text_sizes: bytes of each text in a row of `runs`. most_rows: of events.
    """
    objects = Objects(file.id, compression)
    paths: list[str] = []

    def add(path: str, column: Column, rows: int) -> None:
        dtype: Any = column.dtype
        if path == "events/kind":
            dtype = h5py.enum_dtype({kind.name: kind.value for kind in Kind}, basetype="u1")
        elif path.startswith("runs/"):
            dtype = h5py.string_dtype("utf-8", text_sizes[column.name])
        objects.column(path, dtype, (rows, *column.shape), column.unit)
        paths.append(path)

    def add_elements(group: str, columns: Sequence[Column], rows: int) -> None:
        """As H5MD has them, with times and steps in common."""
        first = f"{group}/{columns[0].name}"
        for shared in SAMPLE_COLUMNS:
            add(f"{first}/{shared.name}", shared, rows)
        for column in columns:
            path = f"{group}/{column.name}"
            add(f"{path}/value", column, rows)
            for shared in SAMPLE_COLUMNS if path != first else ():
                objects.link(f"{path}/{shared.name}", f"{first}/{shared.name}")

    for name in text_sizes:
        add(f"runs/{name}", Column(name, "S"), 1)
    event_rows = max(SHORTEST_CHUNK, min(BLOCK, 1 << (most_rows - 1).bit_length()))
    for column in event_columns:
        add(f"events/{column.name}", column, event_rows)
    some = max(1, DISC_RECORDS // discs)
    for column in (*CHECKPOINT_COLUMNS, *checkpoint_values):
        add(f"checkpoints/{column.name}", column, some)
    for column in checkpoint_arrays:
        add(f"checkpoints/{column.name}", column._replace(shape=(discs, *column.shape)), some)
    if observables:
        add_elements("observables", observables, SAMPLES)
    if snapshot_arrays:
        arrays = [column._replace(shape=(discs, *column.shape)) for column in snapshot_arrays]
        add_elements("particles/discs", arrays, some)
        _describe_particles(file, objects)
    for column in SUMMARY_COLUMNS:
        add(f"summary/{column.name}", column, SUMMARY_ROWS)
    Commit.create(file, paths)


def _describe_particles(file: h5py.File, objects: Objects) -> None:
    """What H5MD asks for beside the snapshots: the box, and what stays the same, which is there already."""
    box = objects.group("particles/discs/box")
    set_attributes(box, dimension=2, boundary=file["box"].attrs["boundary"])
    objects.link("particles/discs/box/edges", "box")
    for name in ("id", "species", "mass", "radius"):
        objects.link(f"particles/discs/{name}", f"discs/{name}")


@cache
def _versions() -> dict[str, np.bytes_]:
    """Of the programs that make a log."""
    packages = {name: importlib.metadata.version(name) for name in ("numpy", "numba", "h5py", "isal")}
    versions = {"idealgas": __version__, "python": platform.python_version(), **packages}
    return {name: np.bytes_(version) for name, version in {**versions, "hdf5": h5py.version.hdf5_version}.items()}


def _text(texts: Sequence[str]) -> np.ndarray:
    """UTF-8 strings of fixed length: what has variable length lies in a heap without checksums."""
    coded = [text.encode() for text in texts]
    size = max([1, *map(len, coded)])
    return np.array(coded, h5py.string_dtype("utf-8", size))

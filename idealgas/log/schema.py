"""The schema of a log: type, unit and chunk size of every dataset, and functions that create an empty file.

A table has one dataset per column. The tables are `runs`, whose last row contains the scene of the log, `events`,
`checkpoints`, `observables`, snapshots in `particles`, `changes`, and `summary`, which has rows once the run has
reached its end. The number of valid rows in each table is stored only in the commit record (`commit.py`).
"""

import importlib.metadata
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from typing import Any, NamedTuple

import h5py
import numpy as np

from idealgas._version import __version__
from idealgas.columns import (
    BLOCK,
    EVENT_COLUMNS,
    PLAIN_COLUMNS,
    POSITION,
    SIDES,
    VELOCITY,
    Column,
    Kind,
    face_names,
    side_ends,
)
from idealgas.log.hdf5.commit import Commit
from idealgas.state import Gas

FORMAT = "idealgas log"
VERSION = 1
"""Version of the format, to be increased whenever a reader of the previous version would misread a log."""
H5MD_VERSION = (1, 1)
PAGES: dict = {"fs_strategy": "page", "fs_page_size": 4096}
"""Options with which no small block of a file extends over two pages, so a killed process leaves none half written."""


class Wall(NamedTuple):
    """A wall of the box or inside it; wall k is partner -1 - k of events.

    Attributes:
        name: name of the wall.
        start: (x, y) of its first end, length.
        end: (x, y) of its second end, length.
    """

    name: str
    start: tuple[float, float]
    end: tuple[float, float]


CHECKPOINT_COLUMNS = (Column("time", "f8", (), "time"), Column("row", "i8"), Column("epoch", "i8"))
"""Columns of all checkpoints: the time, and the numbers of event rows and epochs before the checkpoint."""
CHECKPOINT_ARRAYS = (POSITION, VELOCITY)
"""Default columns of a checkpoint that have an entry for each disc."""
SAMPLE_COLUMNS = (Column("step", "i8"), Column("time", "f8", (), "time"))
"""Columns shared by all observables, or by all elements of snapshots; the step of an observable counts epochs."""
CHANGE_COLUMNS = (Column("time", "f8", (), "time"), Column("setting", "S256"))
"""Columns of the changes that a program made to the scene during the run."""
RUN_COLUMNS = (Column("scene", "S"), Column("command", "S"))
"""Columns with the scene and the command line of the run, and of each run that resumed it."""
SUMMARY_COLUMNS = (Column("name", "S64"), Column("value", "S256"))
"""Columns of the summary, which has one row per field; the values are JSON."""
DISC_COLUMNS = (
    POSITION,
    VELOCITY,
    Column("radius", "f8", (), "length"),
    Column("mass", "f8", (), "mass"),
    Column("species", "u2"),
)
ID = Column("id", "u4")
BOX, GRAVITY = Column("box", "f8", (2,), "length"), Column("gravity", "f8", (2,), "length/time^2")
ENDPOINTS = Column("endpoints", "f8", (2, 2), "length")
NAME = Column("name", "S")
"""Columns of the header, which describe the discs, the box and the walls, and name the walls and species."""
MOST_NAME = 1024
"""Largest size of a name, bytes, limited because exported tables repeat names in every row."""

ROOT_ATTRIBUTES = ("format", "format_version", "seed", "created")
PACKAGES = ("numpy", "numba", "h5py", "isal")
VERSIONS = ("idealgas", "python", *PACKAGES, "hdf5", "trajectory")
"""Attributes of the root and of the group `versions`."""

SHORTEST_CHUNK = 8192
"""Smallest number of event rows in a chunk, even for a short run, which may be resumed to a later end."""
DISC_RECORDS = 4096
"""Approximate number of disc states in a chunk of checkpoints or snapshots, which contains all discs at least once."""
SAMPLES = 1024
"""Number of rows in a chunk of `observables`."""
SUMMARY_ROWS = 64
"""Number of rows in a chunk of `summary`."""
SCENE_SLACK = 256
"""Number of bytes by which the text of a scene may grow when the run is resumed with a different end."""
COMMAND_SIZE = 1024
"""Largest size of a command line, bytes."""


VECTORS: dict[str, Sequence[str]] = {
    **{column.name: column.parts for column in EVENT_COLUMNS if column.parts},
    "momentum": ("momentum_x", "momentum_y"),
    "kinetic_flow": tuple(f"kinetic_flow_{part}" for part in ("xx", "xy", "yy")),
    **{name: (f"{name}_x", f"{name}_y") for name in ("kinetic_heat_flow", "collision_heat_flow")},
    "collision_flow": tuple(f"collision_flow_{part}" for part in ("xx", "xy", "yy", "yx")),
}
"""Names of the components of event columns and observables, except where they depend on the walls."""


def box_walls(box: tuple[float, float]) -> list[Wall]:
    """Return the sides of the box as walls, in the order left, right, bottom, top."""
    return [Wall(name, *ends) for name, ends in zip(SIDES, side_ends(box), strict=True)]


def components(walls: Sequence[str]) -> Mapping[str, Sequence[str]]:
    """Return the names of the components of event columns and observables. walls: names of a log's walls."""
    faces = {
        name: [f"{name}_{face}" for face in face_names(walls)]
        for name in ("face_normal_impulse", "face_tangential_impulse", "face_hits")
    }
    given = [f"wall_energy_{name}" for name in walls]
    lost = [f"dissipated_energy_{name}" for name in ("discs", *walls)]
    return {**VECTORS, **faces, "wall_energy": given, "dissipated_energy": lost}


@dataclass(frozen=True)
class LogLayout:
    """The layout of a log, which is fixed before the run.

    Attributes:
        walls: walls in the order of their numbers in events.
        boundary: "none" or "periodic", along x and along y.
        gravity: acceleration of the discs between events, length/time².
        disc_columns: additional constants and initial values of the discs, (N,) each.
        event_columns: columns of events; if there are none, the log has no events.
        checkpoint_arrays: columns of checkpoints with an entry for each disc.
        checkpoint_values: all other columns of checkpoints.
        observables: columns of samples.
        snapshot_arrays: columns of snapshots with an entry for each disc; if there are none, the log has no snapshots.
        steered: whether a program may change the scene during the run.
        most_rows: largest number of event rows of the run, if it is less than a full chunk.
        compression: "gzip" or "none".
    """

    walls: Sequence[Wall]
    boundary: tuple[str, str] = ("none", "none")
    gravity: tuple[float, float] = (0.0, 0.0)
    disc_columns: Mapping[Column, np.ndarray] = field(default_factory=dict)
    event_columns: Sequence[Column] = PLAIN_COLUMNS
    checkpoint_arrays: Sequence[Column] = CHECKPOINT_ARRAYS
    checkpoint_values: Sequence[Column] = ()
    observables: Sequence[Column] = ()
    snapshot_arrays: Sequence[Column] = ()
    steered: bool = False
    most_rows: int = BLOCK
    compression: str = "gzip"


def write_header(file: h5py.File, gas: Gas, layout: LogLayout, seed: int, trajectory: int) -> None:
    """Write the header: versions, box, discs and walls."""
    file.attrs["format"] = np.bytes_(FORMAT)
    file.attrs["format_version"] = VERSION
    file.attrs["seed"] = np.bytes_(str(seed))  # a seed may have more than 64 bits
    file.attrs["created"] = np.bytes_(datetime.now(UTC).isoformat(timespec="seconds"))
    file.create_group("versions").attrs.update({**_versions(), "trajectory": trajectory})
    file.create_group("h5md").attrs["version"] = H5MD_VERSION
    file.create_group("h5md/author").attrs["name"] = np.bytes_("unknown")
    file.create_group("h5md/creator").attrs.update({"name": np.bytes_("idealgas"), "version": np.bytes_(__version__)})

    def store(path: str, values: Any, column: Column) -> None:
        # The data are stored in one chunk, as only chunks have checksums.
        data = values if column.dtype == "S" else np.array(values, column.dtype)
        _create(file, path, column.unit, layout, data=data, chunks=data.shape)

    store("box", gas.box, BOX)
    file["box"].attrs["boundary"] = np.array(layout.boundary, "S")
    store("gravity", layout.gravity, GRAVITY)
    store("discs/id", np.arange(len(gas)), ID)
    given = {column: getattr(gas, column.name) for column in DISC_COLUMNS} | dict(layout.disc_columns)
    for column, values in given.items():
        store(f"discs/{column.name}", values, column)
    store("discs/species_name", _text(gas.species_names), NAME)
    store("walls/name", _text([wall.name for wall in layout.walls]), NAME)
    store("walls/endpoints", [(wall.start, wall.end) for wall in layout.walls], ENDPOINTS)


def create_tables(file: h5py.File, discs: int, layout: LogLayout, text_sizes: Mapping[str, int]) -> None:
    """Create all tables that have columns, still without rows, and the commit record, which lists the datasets.

    Args:
        file: the new file.
        discs: number of discs.
        layout: layout of the log.
        text_sizes: size of each string in a row of `runs`, bytes, by column.
    """
    paths: list[str] = []

    def add(path: str, column: Column, rows: int) -> None:
        dtype: Any = column.dtype
        if path == "events/kind":
            dtype = h5py.enum_dtype({kind.name: kind.value for kind in Kind}, basetype="u1")
        elif path.startswith("runs/"):
            dtype = h5py.string_dtype("utf-8", text_sizes[column.name])
        shape, growing = (0, *column.shape), (None, *column.shape)
        chunk = (rows, *column.shape)
        _create(file, path, column.unit, layout, dtype=dtype, shape=shape, maxshape=growing, chunks=chunk)
        paths.append(path)

    def add_elements(group: str, columns: Sequence[Column], rows: int) -> None:
        """Add H5MD elements that share their steps and times."""
        first = f"{group}/{columns[0].name}"
        for shared in SAMPLE_COLUMNS:
            add(f"{first}/{shared.name}", shared, rows)
        for column in columns:
            path = f"{group}/{column.name}"
            add(f"{path}/value", column, rows)
            for shared in SAMPLE_COLUMNS if path != first else ():
                file[f"{path}/{shared.name}"] = file[f"{first}/{shared.name}"]

    for name in text_sizes:
        add(f"runs/{name}", Column(name, "S"), 1)
    event_rows = max(SHORTEST_CHUNK, min(BLOCK, 1 << (layout.most_rows - 1).bit_length()))
    for column in layout.event_columns:
        add(f"events/{column.name}", column, event_rows)
    states = max(1, DISC_RECORDS // discs)
    for column in (*CHECKPOINT_COLUMNS, *layout.checkpoint_values):
        add(f"checkpoints/{column.name}", column, states)
    for column in layout.checkpoint_arrays:
        add(f"checkpoints/{column.name}", column._replace(shape=(discs, *column.shape)), states)
    if layout.observables:
        add_elements("observables", layout.observables, SAMPLES)
    if layout.snapshot_arrays:
        arrays = [column._replace(shape=(discs, *column.shape)) for column in layout.snapshot_arrays]
        add_elements("particles/discs", arrays, states)
        box = file.create_group("particles/discs/box")  # required by H5MD, like the links to the constants of the discs
        box.attrs.update({"dimension": 2, "boundary": file["box"].attrs["boundary"]})
        box["edges"] = file["box"]
        for name in ("id", "species", "mass", "radius"):
            file[f"particles/discs/{name}"] = file[f"discs/{name}"]
    for column in CHANGE_COLUMNS if layout.steered else ():
        add(f"changes/{column.name}", column, SAMPLES)
    for column in SUMMARY_COLUMNS:
        add(f"summary/{column.name}", column, SUMMARY_ROWS)
    Commit.create(file, paths)


def _create(file: h5py.File, path: str, unit: str, layout: LogLayout, **options: Any) -> None:
    """Create a dataset with checksums and the compression of the log."""
    if layout.compression == "gzip":
        options |= {"compression": "gzip", "compression_opts": 1, "shuffle": True}
    dataset = file.create_dataset(path, fletcher32=True, **options)
    if unit:
        dataset.attrs["unit"] = np.bytes_(unit)


@cache
def _versions() -> dict[str, np.bytes_]:
    """Return the versions of idealgas, Python and the packages that write the log."""
    packages = {name: importlib.metadata.version(name) for name in PACKAGES}
    versions = {"idealgas": __version__, "python": platform.python_version(), **packages}
    return {name: np.bytes_(version) for name, version in {**versions, "hdf5": h5py.version.hdf5_version}.items()}


def _text(texts: Sequence[str]) -> np.ndarray:
    """Return UTF-8 strings of fixed length, because HDF5 does not apply checksums to variable-length strings."""
    coded = [text.encode() for text in texts]
    size = max([1, *map(len, coded)])
    return np.array(coded, h5py.string_dtype("utf-8", size))

"""Rules for the values of a log: declared types and shapes, and numbers that are finite, in range and in order.

Every column is checked when it is read, before its numbers are used. A broken rule raises ValueError.
"""

import math
import sys
from bisect import bisect
from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np

from idealgas.columns import (
    COUNTED,
    EVENT_COLUMNS,
    IMAGE,
    MOST_SPECIES,
    MOST_WALLS,
    SIDES,
    TRIALS,
    VELOCITY,
    Column,
    Kind,
    side_ends,
)
from idealgas.log.hdf5.column import StoredColumn
from idealgas.log.pairs import PARTNERS
from idealgas.log.schema import (
    BOX,
    CHANGE_COLUMNS,
    CHECKPOINT_COLUMNS,
    DISC_COLUMNS,
    ENDPOINTS,
    GRAVITY,
    ID,
    MOST_NAME,
    NAME,
    RUN_COLUMNS,
    SAMPLE_COLUMNS,
    SUMMARY_COLUMNS,
    Wall,
    components,
)

NEEDED: dict[str, Sequence[Column]] = {
    "runs": RUN_COLUMNS,
    "events": [column for column in EVENT_COLUMNS if not column.when],
    "checkpoints": (*CHECKPOINT_COLUMNS, VELOCITY),
    "summary": SUMMARY_COLUMNS,
    "changes": CHANGE_COLUMNS,
}
"""Columns that each table has; only the tables of events and of changes may be missing in a log."""

ORDERED = ("time", "row", "epoch", "step", "trial")
"""Columns that are never negative and never decrease."""

MOST_PACKED = 1100
"""Largest number of bytes to which one byte of a file may expand; deflate expands it to at most 1032."""

LARGEST = sys.float_info.max
LEAST, MOST, LONGEST, SLOWEST = 1e-100, 1e50, 1e150, 1e-61
"""Bounds of values, within which products and sums of squares are finite.

LEAST bounds masses and radii from below; MOST bounds masses, radii and velocities from above; LONGEST bounds times,
spins and observables from above; SLOWEST bounds the largest velocity component of a gas from below.
"""

Range = tuple[float, float]


class Rules:
    """The rules for the values of one log.

    Attributes:
        has_time_steps: function that returns whether the run has time steps; called if a disc is outside the box.
    """

    def __init__(
        self,
        box: tuple[float, float],
        discs: int,
        species: int,
        walls: int,
        kinds: Collection[Kind] = (),
        pistons: int = 0,
    ) -> None:
        """Declare the columns and ranges of a log.

        Args:
            box: width and height, length.
            discs: number of discs.
            species: number of species.
            walls: number of walls.
            kinds: optional kinds of events that this log declares.
            pistons: number of pistons.
        """
        self._others = [PARTNERS[kind] for kind in kinds if kind in PARTNERS]
        self._escapes = Kind.ESCAPED in kinds
        self._no_kinds = sorted(set(COUNTED) - set(kinds))
        self.has_time_steps: Callable[[], bool] = lambda: False
        self._box = box
        self._ranges: dict[str, Range] = {
            **dict.fromkeys(ORDERED, (0, LARGEST)),
            "time": (0, LONGEST),
            "disc": (0, discs - 1),
            "partner": (-walls, discs - 1),
            "kind": (0, max(Kind)),
            "species": (0, species - 1),
            **dict.fromkeys(("radius", "mass"), (LEAST, MOST)),
            "velocity": (-MOST, MOST),
            "angular_velocity": (-LONGEST, LONGEST),
            GRAVITY.name: (-MOST, MOST),
            "inertia": (0, LONGEST),
            "piston_position": (0, max(box)),
            "piston_velocity": (-MOST, MOST),
        }
        each = lambda column: column._replace(shape=(discs, *column.shape))  # noqa: E731
        shapes = {name: (len(parts),) for name, parts in components(["wall"] * walls).items()}
        moving = dict.fromkeys(("piston_position", "piston_velocity"), (pistons,))
        self._observed = {**shapes, **moving, "pair_collisions": (species, species)}
        self._declared = {
            **{column.name: column for column in (BOX, GRAVITY)},
            **{f"discs/{column.name}": each(column) for column in (*EVENT_COLUMNS, *DISC_COLUMNS, ID)},
            "discs/inertia": Column("inertia", "f8", (discs,)),
            "discs/species_name": NAME._replace(shape=(species,)),
            "walls/name": NAME._replace(shape=(walls,)),
            "walls/endpoints": ENDPOINTS._replace(shape=(walls, *ENDPOINTS.shape)),
            **{f"runs/{column.name}": column for column in RUN_COLUMNS},
            **{f"summary/{column.name}": column for column in SUMMARY_COLUMNS},
            **{f"changes/{column.name}": column for column in CHANGE_COLUMNS},
            **{f"events/{column.name}": column for column in EVENT_COLUMNS},
            **{f"checkpoints/{column.name}": each(column) for column in EVENT_COLUMNS},
            **{f"checkpoints/{column.name}": column for column in CHECKPOINT_COLUMNS},
            **{f"checkpoints/{name}": Column(name, "f8", shape) for name, shape in moving.items()},
            **{f"particles/discs/{column.name}/value": each(column) for column in EVENT_COLUMNS},
        }
        self._edges: dict[str, tuple[list[int], list[tuple[float, float]]]] = {}

    def check_fixed(self, name: str, stored: StoredColumn) -> None:
        """Check the type and shape of a dataset that was stored before the run, in a single chunk."""
        column = self._declared[name]
        self._check_type(column, stored)
        if stored.shape != column.shape or stored.chunk != column.shape:
            raise ValueError(f"of shape {stored.shape} (allowed {column.shape}, in one chunk)")
        if column.name == NAME.name and stored.dtype.itemsize > MOST_NAME:
            raise ValueError(f"names of {stored.dtype.itemsize:,} bytes (allowed up to {MOST_NAME:,})")

    def check_table(self, columns: Mapping[str, StoredColumn], rows: int, file_size: int) -> None:
        """Check the types, shapes and sizes of the datasets of a table with `rows` committed rows."""
        (chunk, *different) = {column.chunk[0] for column in columns.values()}
        if different:
            raise ValueError(f"{next(iter(columns))}: chunks of {chunk} and {different[0]} rows in one table")
        for path, stored in columns.items():
            try:
                self._check_column(path, stored)
                if rows > stored.extent:
                    raise ValueError(f"{rows:,} rows (allowed up to {stored.extent:,})")
                if stored.extent * math.prod(stored.chunk[1:]) * stored.dtype.itemsize > MOST_PACKED * file_size:
                    raise ValueError(f"{stored.extent:,} rows in a file of {file_size:,} bytes")
            except ValueError as error:
                raise ValueError(f"{path}: {error}") from error

    def _check_column(self, path: str, stored: StoredColumn) -> None:
        table, *names = path.split("/")
        column = self._declared.get(path)
        if column is None and table in ("observables", "particles"):
            shared = {column.name: column for column in SAMPLE_COLUMNS}.get(names[-1])
            shape = self._observed.get(names[0], ())
            column = shared or (
                Column(names[0], "", shape) if table == "observables" and names[-1] == "value" else None
            )
        elif column is None and table == "checkpoints" and len(names) == 1:
            column = Column(names[0], "", stored.chunk[1:])  # column of an effect, or an exact sum
        if column is None:
            raise ValueError("not a column of a log")
        if table == "observables" and stored.dtype.str not in ("<f8", "<i8"):
            raise ValueError(f"of type {stored.dtype} (allowed float64 or int64)")
        self._check_type(column, stored)
        if stored.chunk[1:] != column.shape:
            raise ValueError(f"entries of shape {stored.chunk[1:]} (allowed {column.shape})")

    def _check_type(self, column: Column, stored: StoredColumn) -> None:
        if column.dtype in ("", "S"):
            fits = (stored.dtype.kind == "S") == (column.dtype == "S")
        else:
            fits = stored.dtype == np.dtype(column.dtype)
        if not fits:
            raise ValueError(
                f"of type {stored.dtype} (allowed {np.dtype(column.dtype) if column.dtype else 'numbers'})"
            )

    def check(self, path: str, data: np.ndarray, start: int = 0) -> None:
        """Check the values of a column. start: row of the first value."""
        name = path.removesuffix("/value").rpartition("/")[2]
        if not data.size or data.dtype.kind == "S":
            return
        if name == "partner" and self._others:
            data = np.where(np.isin(data, self._others), 0, data)
        low, high = self._ranges.get(name, self._range_of_others(path))
        in_order = name in ORDERED and bool((data[1:] >= data[:-1]).all())
        if name == "position":
            self._check_positions(path, data, start)
            return
        if not (in_order and low <= data[0] and data[-1] <= high):  # in order, the first and last value are the bounds
            _check_range(data, low, high, start)
        if name == "kind" and (wrong := np.isin(data, self._no_kinds)).any():
            row = int(wrong.argmax())
            raise ValueError(f"{Kind(data[row]).name} in row {start + row}, which this log cannot have")
        if name in ORDERED:
            self._check_order(path, data, start, in_order)
        if name == "time" and (later := data[data.searchsorted(0.0, "right") :]).size and later[0] < LEAST:
            raise ValueError(f"{later[0]:g} in row {start + len(data) - len(later)} (allowed 0, or from {LEAST:g} on)")
        if path == "discs/velocity" and 0 < (largest := np.abs(data).max()) < SLOWEST:  # whose fourth powers underflow
            raise ValueError(f"largest component {largest:g} (allowed from {SLOWEST:g} on, or 0)")

    def _range_of_others(self, path: str) -> Range:
        """Return the range of the values of a column for which no range is declared."""
        if path.startswith("observables/"):
            return -LONGEST, LONGEST
        unknown = path not in self._declared and path.startswith("checkpoints/")  # a time of minus infinity means never
        return (-math.inf, math.inf) if unknown else (-LARGEST, LARGEST)

    def _check_positions(self, path: str, data: np.ndarray, start: int) -> None:
        """Check that positions are in the box; in a run with time steps, discs may leave it after the start.

        Discs that have left the gas have the position nan.
        """
        width, height = self._box
        if self._escapes and path.startswith(("checkpoints/", "particles/")):
            data = np.nan_to_num(data)
        try:
            if width == height:
                _check_range(data, 0, width, start)
            else:
                for axis, most in enumerate(self._box):
                    _check_range(data[..., axis], 0, most, start)
        except ValueError:
            if path.startswith("discs/") or not self.has_time_steps():
                raise
            _check_range(data, -MOST, MOST, start)

    def _check_order(self, path: str, data: np.ndarray, start: int, in_order: bool) -> None:
        """Check that values do not decrease within a chunk, unless `in_order`, or from one chunk to the next.

        Only chunks that have been read can be compared.
        """
        if not in_order and (falls := data[1:] < data[:-1]).any():
            raise ValueError(f"decreases in row {start + 1 + int(falls.argmax())}")
        starts, edges = self._edges.setdefault(path, ([], []))
        index = bisect(starts, start)
        if index and starts[index - 1] == start:
            return
        if (index and edges[index - 1][1] > data[0]) or (index < len(starts) and data[-1] > edges[index][0]):
            raise ValueError("decreases from one chunk to the next")
        starts.insert(index, start)
        edges.insert(index, (data[0].item(), data[-1].item()))


def _check_range(data: np.ndarray, low: float, high: float, start: int) -> None:
    """Check that all numbers are in a range, and that none is nan."""
    if data.min() >= low and data.max() <= high:
        return
    wrong = ~((data >= low) & (data <= high))
    value, row = data[wrong][0].item(), start + int(wrong.reshape(len(data), -1).any(axis=1).argmax())
    allowed = "finite numbers" if (low, high) == (-LARGEST, LARGEST) else f"{low:g} to {high:g}"
    raise ValueError(f"{value:g} in row {row} (allowed {allowed})")


def box_of(data: np.ndarray) -> tuple[float, float]:
    """Return the width and height of the box. Raises ValueError if the data are invalid."""
    if data.shape != BOX.shape or data.dtype != np.dtype(BOX.dtype) or not ((data >= LEAST) & (data <= MOST)).all():
        raise ValueError(f"box: invalid width and height (allowed {LEAST:g} to {MOST:g})")
    width, height = data.tolist()
    return width, height


def check_names(names: Mapping[str, Sequence[str]]) -> None:
    """Check that each table has its required columns. names: names of the columns, by table."""
    for table, columns in NEEDED.items():
        if table in ("events", "changes") and table not in names:
            continue
        if missing := [column.name for column in columns if column.name not in names.get(table, ())]:
            raise ValueError(f"{table}/{missing[0]}: missing")
    for column in EVENT_COLUMNS if "events" in names else ():
        here, there = column.name in names["events"], column.name in names["checkpoints"]
        if column.when not in ("", TRIALS) and here != there:
            raise ValueError(f"{'checkpoints' if here else 'events'}/{column.name}: missing")
    for table, present in names.items():
        if len(set(present)) != len(present):
            raise ValueError(f"{table}: a column appears twice")
        if table in ("observables", "particles") and not any(name.endswith("/time") for name in present):
            raise ValueError(f"{table}: no times")


def check_species(species: np.ndarray, names: Sequence[str]) -> None:
    """Check that each species has at least one disc and a unique name."""
    number = np.bincount(species, minlength=len(names))[: len(names)]
    if not number.all():
        raise ValueError(f"no disc of species {number.argmin()}")
    if not all(names):
        raise ValueError("a species without a name")
    if len(set(names)) != len(names):
        raise ValueError("two species with the same name")


def check_boundary(words: object) -> None:
    """Check the boundary conditions of the box along x and y."""
    if not isinstance(words, list) or len(words) != 2 or not set(words) <= {b"none", b"periodic"}:
        raise ValueError("attribute boundary: invalid (allowed none or periodic, along x and along y)")


def check_images(periodic: bool, names: Sequence[str]) -> None:
    """Check that discs have images if and only if sides are periodic. names: columns of the checkpoints."""
    if periodic != (IMAGE.name in names):
        raise ValueError(f"{'missing, with' if periodic else 'present, without'} periodic sides")


def check_walls(walls: Sequence[Wall], box: tuple[float, float]) -> None:
    """Check that the first walls are the sides of the box, and that the remaining walls are segments inside it."""
    for wall, ends in zip(walls, side_ends(box), strict=False):
        if (wall.start, wall.end) != ends:
            raise ValueError(f"not the sides of a box of {box[0]:g} by {box[1]:g} (got {wall.start} to {wall.end})")
    for wall in walls[len(SIDES) :]:
        inside = all(0 <= end[axis] <= box[axis] for end in (wall.start, wall.end) for axis in range(2))
        if not inside:
            raise ValueError(f"not a segment in the box ({wall.start} to {wall.end})")


def check_sizes(discs: int, species: int, walls: int, file_size: int) -> None:
    """Check the numbers of discs, species and walls."""
    if not 1 <= discs <= file_size:
        raise ValueError(f"discs/id: {discs:,} discs in a file of {file_size:,} bytes")
    if not 1 <= species <= discs:
        raise ValueError(f"discs/species_name: {species} names of {discs} discs")
    if species > MOST_SPECIES:
        raise ValueError(f"discs/species_name: {species:,} names (allowed up to {MOST_SPECIES:,})")
    if not len(SIDES) <= walls <= len(SIDES) + MOST_WALLS:
        most = len(SIDES) + MOST_WALLS
        raise ValueError(f"walls/name: {walls:,} walls (allowed from {len(SIDES)} to {most:,})")

"""Rules for the values in a log: types and shapes as declared, and numbers that are finite, in range and in order.

Every column is checked when it is read, before its numbers are used. A violated rule raises ValueError.
"""

import math
import sys
from bisect import bisect
from collections.abc import Callable, Collection, Mapping

import numpy as np

from idealgas.columns import COUNTED, EVENT_COLUMNS, Column, Kind
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
    components,
)

ORDERED = ("time", "row", "epoch", "step", "trial")
"""Columns whose values are never negative and never decrease."""

MOST_PACKED = 1100
"""Largest allowed ratio of a dataset's size to the size of the file; deflate compresses at most by a factor of 1032."""

LARGEST = sys.float_info.max
LEAST, MOST, LONGEST, SLOWEST = 1e-100, 1e50, 1e150, 1e-61
"""Bounds on the values in a log, within which products and sums of squares do not overflow or underflow.

LEAST is the lower bound on masses, radii and positive times; MOST is the upper bound on masses, radii and velocities;
LONGEST is the upper bound on times, angular velocities and observables; SLOWEST is the lower bound on the largest
velocity component in a moving gas.
"""

Range = tuple[float, float]


class Rules:
    """The rules for the values in one log.

    Before any value is used, `check_fixed` and `check_table` compare the types, shapes and sizes of the datasets with
    their declarations. Whenever part of a column is read, `check` then verifies that its values are in the range of the
    column and that times and counts do not decrease.

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
            kinds: optional kinds of events that the log declares.
            pistons: number of pistons.
        """
        self.has_time_steps: Callable[[], bool] = lambda: False
        self._box = box
        self._escapes = Kind.ESCAPED in kinds
        self._impossible_kinds = sorted(set(COUNTED) - set(kinds))
        self._special_partners = [PARTNERS[kind] for kind in kinds if kind in PARTNERS]
        self._ranges = _ranges(box, discs, species, walls)
        of_pistons = dict.fromkeys(("piston_position", "piston_velocity"), (pistons,))
        of_walls = {name: (len(parts),) for name, parts in components(["wall"] * walls).items()}
        self._declared = _declared_columns(discs, species, walls)
        self._declared |= {f"checkpoints/{name}": Column(name, "f8", shape) for name, shape in of_pistons.items()}
        self._observables = {**of_walls, **of_pistons, "pair_collisions": (species, species)}
        self._chunk_ends: dict[str, tuple[list[int], list[tuple[float, float]]]] = {}

    def check_fixed(self, name: str, stored: StoredColumn) -> None:
        """Check the type and shape of a dataset that was written before the run, in a single chunk."""
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
        column = self._declaration(path, stored)
        if path.startswith("observables/") and stored.dtype.str not in ("<f8", "<i8"):
            raise ValueError(f"of type {stored.dtype} (allowed float64 or int64)")
        self._check_type(column, stored)
        if stored.chunk[1:] != column.shape:
            raise ValueError(f"entries of shape {stored.chunk[1:]} (allowed {column.shape})")

    def _declaration(self, path: str, stored: StoredColumn) -> Column:
        """Return the declared type and shape of a column, including columns of observables and effects."""
        table, *names = path.split("/")
        if path in self._declared:
            return self._declared[path]
        if table in ("observables", "particles"):
            for column in SAMPLE_COLUMNS:  # of each observable
                if column.name == names[-1]:
                    return column
            if table == "observables" and names[-1] == "value":
                return Column(names[0], "", self._observables.get(names[0], ()))
        if table == "checkpoints" and len(names) == 1:  # state of an effect, or an exact sum
            return Column(names[0], "", stored.chunk[1:])
        raise ValueError("not a column of a log")

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
        """Check the values of a column. start: row number of the first value."""
        name = path.removesuffix("/value").rpartition("/")[2]
        if not data.size or data.dtype.kind == "S":
            return
        if name == "position":
            self._check_positions(path, data, start)
        elif name in ORDERED:
            self._check_ordered(path, name, data, start)
        elif name == "partner":
            data = np.where(np.isin(data, self._special_partners), 0, data)
            _check_range(data, *self._range(path, name), start)
        else:
            _check_range(data, *self._range(path, name), start)
        if name == "kind":
            self._check_kinds(data, start)
        if path == "discs/velocity" and 0 < (largest := np.abs(data).max()) < SLOWEST:  # their fourth powers underflow
            raise ValueError(f"largest component {largest:g} (allowed 0 or >= {SLOWEST:g})")

    def _range(self, path: str, name: str) -> Range:
        """Return the range of the values of a column."""
        if name in self._ranges:
            return self._ranges[name]
        if path.startswith("observables/"):
            return -LONGEST, LONGEST
        unknown = path not in self._declared and path.startswith("checkpoints/")  # a time of -inf means never
        return (-math.inf, math.inf) if unknown else (-LARGEST, LARGEST)

    def _check_kinds(self, data: np.ndarray, start: int) -> None:
        """Check that all events are of kinds that this log declares."""
        if (impossible := np.isin(data, self._impossible_kinds)).any():
            row = int(impossible.argmax())
            raise ValueError(f"{Kind(data[row]).name} in row {start + row}, which this log cannot have")

    def _check_positions(self, path: str, data: np.ndarray, start: int) -> None:
        """Check that positions are in the box.

        In a run with time steps, discs may be outside the box after the start. Discs that have left the gas have nan as
        position.
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

    def _check_ordered(self, path: str, name: str, data: np.ndarray, start: int) -> None:
        """Check that the values in a chunk are in range and do not decrease, and that no positive time is too small."""
        low, high = self._range(path, name)
        in_order = bool((data[1:] >= data[:-1]).all())
        if not (in_order and low <= data[0] and data[-1] <= high):  # ordered values lie between the first and the last
            _check_range(data, low, high, start)
        if not in_order:
            raise ValueError(f"decreases in row {start + 1 + int((data[1:] < data[:-1]).argmax())}")
        self._check_neighbouring_chunks(path, data, start)
        if name == "time" and (later := data[data.searchsorted(0.0, "right") :]).size and later[0] < LEAST:
            raise ValueError(f"{later[0]:g} in row {start + len(data) - len(later)} (allowed 0 or >= {LEAST:g})")

    def _check_neighbouring_chunks(self, path: str, data: np.ndarray, start: int) -> None:
        """Check that values do not decrease from one chunk to the next, among the chunks that have been read.

        For each column, the row numbers at which these chunks begin, and the first and last values in each chunk, are
        kept in ascending order.
        """
        starts, ends = self._chunk_ends.setdefault(path, ([], []))
        index = bisect(starts, start)
        if index and starts[index - 1] == start:
            return
        if (index and ends[index - 1][1] > data[0]) or (index < len(starts) and data[-1] > ends[index][0]):
            raise ValueError("decreases from one chunk to the next")
        starts.insert(index, start)
        ends.insert(index, (data[0].item(), data[-1].item()))


def _ranges(box: tuple[float, float], discs: int, species: int, walls: int) -> dict[str, Range]:
    """Return the smallest and largest allowed values of columns, by name; the arguments are those of `Rules`."""
    return {
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


def _declared_columns(discs: int, species: int, walls: int) -> dict[str, Column]:
    """Return all columns that a log may have, by path, except observables and columns of effects."""

    def per_disc(column: Column) -> Column:
        return column._replace(shape=(discs, *column.shape))

    return {
        **{column.name: column for column in (BOX, GRAVITY)},
        **{f"discs/{column.name}": per_disc(column) for column in (*EVENT_COLUMNS, *DISC_COLUMNS, ID)},
        "discs/inertia": Column("inertia", "f8", (discs,)),
        "discs/species_name": NAME._replace(shape=(species,)),
        "walls/name": NAME._replace(shape=(walls,)),
        "walls/endpoints": ENDPOINTS._replace(shape=(walls, *ENDPOINTS.shape)),
        **{f"runs/{column.name}": column for column in RUN_COLUMNS},
        **{f"summary/{column.name}": column for column in SUMMARY_COLUMNS},
        **{f"changes/{column.name}": column for column in CHANGE_COLUMNS},
        **{f"events/{column.name}": column for column in EVENT_COLUMNS},
        **{f"checkpoints/{column.name}": per_disc(column) for column in EVENT_COLUMNS},
        **{f"checkpoints/{column.name}": column for column in CHECKPOINT_COLUMNS},
        **{f"particles/discs/{column.name}/value": per_disc(column) for column in EVENT_COLUMNS},
    }


def _check_range(data: np.ndarray, low: float, high: float, start: int) -> None:
    """Check that all numbers are in a range and none is nan."""
    if data.min() >= low and data.max() <= high:
        return
    wrong = ~((data >= low) & (data <= high))
    value, row = data[wrong][0].item(), start + int(wrong.reshape(len(data), -1).any(axis=1).argmax())
    allowed = "finite numbers" if (low, high) == (-LARGEST, LARGEST) else f"{low:g} to {high:g}"
    raise ValueError(f"{value:g} in row {row} (allowed {allowed})")

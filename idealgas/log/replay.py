"""Compute the state of the gas at any time from a checkpoint, the events that follow it, and free flight."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, overload

import numpy as np

from idealgas.columns import Kind
from idealgas.log.log_file import LogFile, StoredTable
from idealgas.log.schema import CHECKPOINT_COLUMNS
from idealgas.physics.motion import position_after, velocity_after
from idealgas.physics.periodic import wrapped

MOST_BOXES = 2.0**30
"""Largest length of a free flight in box lengths, limited because images are 32-bit integers."""


class LogState(NamedTuple):
    """The state of all discs at one time, in order of id. The values of discs that have left the gas are nan.

    Attributes:
        time: time of the state.
        position: (N, 2), positions, length; nan in a gas whose discs have no positions.
        velocity: (N, 2), velocities, length/time.
        image: (N, 2), number of box lengths to add to each position to unwrap it; None without periodic sides.
        angular_velocity: (N,), angular velocities, 1/time; None without rotation.
    """

    time: float
    position: np.ndarray
    velocity: np.ndarray
    image: np.ndarray | None = None
    angular_velocity: np.ndarray | None = None

    @property
    def inside(self) -> np.ndarray:
        """Whether each disc is still in the gas, (N,)."""
        return ~np.isnan(self.velocity[:, 0])

    def mean(self, values: np.ndarray, members: np.ndarray | bool = True) -> float:
        """Return the mean of values over the discs that are in the gas; 0 if there are none.

        Args:
            values: (N,), one value per disc.
            members: (N,) mask of the discs to include; all by default.
        """
        selected = values[self.inside & members]
        return float(selected.mean()) if len(selected) else 0.0


class Checkpoint(NamedTuple):
    """A state from which a run can be resumed.

    Attributes:
        time: time of the state.
        row: number of event rows before the state.
        epoch: number of epochs before the state.
        arrays: arrays by name, such as the columns with an entry for each disc.
        values: single numbers by name.
    """

    time: float
    row: int
    epoch: int
    arrays: Mapping[str, np.ndarray]
    values: Mapping[str, float]

    @property
    def position(self) -> np.ndarray:
        """Positions, (N, 2), length."""
        return self.arrays["position"]

    @property
    def velocity(self) -> np.ndarray:
        """Velocities, (N, 2), length/time."""
        return self.arrays["velocity"]


class Checkpoints(Sequence[Checkpoint]):
    """The checkpoints of a log; each is read from the file when it is indexed."""

    def __init__(self, file: LogFile, rows: int, check: Callable[[float, int], None]) -> None:
        """Read the times and rows of the checkpoints up to event row `rows`.

        Args:
            file: the file of the log.
            rows: number of valid event rows.
            check: function that is called with the time and row of a checkpoint when it is read, and raises LogError if
                they contradict each other.
        """
        self._file, self._check = file, check
        self.times = file.column("checkpoints/time")
        self.rows = file.column("checkpoints/row")
        if file.rows("events"):
            valid = int(self.rows.searchsorted(rows, "right"))
            self.times, self.rows = self.times[:valid], self.rows[:valid]

    def __len__(self) -> int:
        return len(self.times)

    @overload
    def __getitem__(self, index: int) -> Checkpoint: ...
    @overload
    def __getitem__(self, index: slice) -> list[Checkpoint]: ...
    def __getitem__(self, index: int | slice) -> Checkpoint | list[Checkpoint]:
        if isinstance(index, slice):
            return [self[i] for i in range(len(self))[index]]
        row = range(len(self))[index]
        entries = {name: self._entry(name, row) for name in self._file.names("checkpoints")}
        time, at, epoch = (entries.pop(column.name).item() for column in CHECKPOINT_COLUMNS)
        self._check(time, at)
        arrays = {name: entry for name, entry in entries.items() if entry.ndim}
        values = {name: entry.item() for name, entry in entries.items() if not entry.ndim}
        path = self._file.path
        return Checkpoint(
            time, at, epoch, StoredTable(path, "checkpoints", arrays), StoredTable(path, "checkpoints", values)
        )

    def _entry(self, name: str, row: int) -> np.ndarray:
        path = f"checkpoints/{name}"
        size = self._file.chunk_rows(path)
        return self._file.chunk(path, row // size * size)[row % size]


class Replay:
    """The state of every disc after its latest event, updated as event rows are read in order.

    Attributes:
        row: number of the next event row.
        columns: event columns that `follow` requires.
    """

    def __init__(
        self,
        start: Checkpoint,
        columns: Sequence[str],
        box: tuple[float, float],
        wrapped_axes: Sequence[bool],
        gravity_at: Callable[[np.ndarray], np.ndarray] | None,
        escapes: bool,
    ) -> None:
        self.row = start.row
        self._record = {name: start.arrays[name].copy() for name in LogState._fields[1:] if name in start.arrays}
        self._record.setdefault("position", np.full_like(start.velocity, np.nan))
        self._left = np.isnan(self._record["position"][:, 0]) if escapes else None
        self._state = tuple(name for name in self._record if name in columns)
        self.columns = ("time", "disc", *self._state, *(("kind",) if escapes else ()))
        self._time = np.full(len(start.velocity), start.time)
        self._box, self._wrapped_axes, self._gravity_at = box, wrapped_axes, gravity_at

    def follow(self, block: Any) -> None:
        """Update the states with the next block of event rows."""
        self._time[block.disc] = block.time
        for name in self._state:
            self._record[name][block.disc] = getattr(block, name)
        if self._left is not None:
            self._left[block.disc[block.kind == Kind.ESCAPED]] = True
        self.row += len(block.time)

    def at(self, time: float) -> LogState:
        """Return the state of all discs at a time between the latest event row and the next one.

        Raises:
            ValueError: if a disc crosses more box lengths than an image can count.
        """
        now = {name: values.copy() for name, values in self._record.items()}
        position, velocity = now["position"], now["velocity"]
        delay = time - self._time
        if self._left is not None:
            position[self._left] = 0.0
            delay[self._left] = 0.0
        gravity = None if self._gravity_at is None else self._gravity_at(self._time)
        for axis in range(2):
            acceleration = None if gravity is None else gravity[..., axis]
            coordinate = position_after(position[:, axis], velocity[:, axis], acceleration, delay)
            if acceleration is not None:
                velocity[:, axis] = velocity_after(velocity[:, axis], acceleration, delay)
            if self._wrapped_axes[axis]:
                coordinate, boxes = wrapped(coordinate, self._box[axis])
                if not (np.abs(boxes) < MOST_BOXES).all():
                    raise ValueError(
                        f"a disc flies through {np.abs(boxes).max():g} boxes (allowed up to {MOST_BOXES:g})"
                    )
                now["image"][:, axis] += boxes.astype(np.int32)
            position[:, axis] = coordinate
        for values in now.values() if self._left is not None else ():
            if values.dtype.kind == "f":
                values[self._left] = np.nan
        return LogState(time, **now)

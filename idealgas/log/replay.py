"""States of the gas from what a log holds: checkpoints, and between them the discs' records and free flight."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, overload

import numpy as np

from idealgas.log.log_file import LogFile, Table
from idealgas.log.schema import CHECKPOINT_COLUMNS
from idealgas.physics.motion import position_after, velocity_after
from idealgas.physics.periodic import wrapped

MOST_BOXES = 2.0**30
"""Box lengths of a free flight; images are counted in 32 bits."""


class LogState(NamedTuple):
    """All discs at one time, in order of id.

    position: (N, 2), length; nan in a gas without positions. velocity: (N, 2), length/time. image: (N, 2), number of
    box lengths to add to a position to unwrap it; None without periodic sides. angular_velocity: (N,), 1/time; None
    without rotation.
    """

    time: float
    position: np.ndarray
    velocity: np.ndarray
    image: np.ndarray | None = None
    angular_velocity: np.ndarray | None = None


class Checkpoint(NamedTuple):
    """A state that a run can go on from, after `row` event rows and `epoch` epochs; arrays by disc, and values."""

    time: float
    row: int
    epoch: int
    arrays: Mapping[str, np.ndarray]
    values: Mapping[str, float]

    @property
    def position(self) -> np.ndarray:
        """(N, 2), length."""
        return self.arrays["position"]

    @property
    def velocity(self) -> np.ndarray:
        """(N, 2), length/time."""
        return self.arrays["velocity"]


class Checkpoints(Sequence[Checkpoint]):
    """The checkpoints of a log up to event row `rows`, read when asked for."""

    def __init__(self, file: LogFile, rows: int, check: Callable[[float, int], None]) -> None:
        """check: raises LogError where a time and a row cannot be those of one checkpoint."""
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
        return Checkpoint(time, at, epoch, Table(path, "checkpoints", arrays), Table(path, "checkpoints", values))

    def _entry(self, name: str, row: int) -> np.ndarray:
        path = f"checkpoints/{name}"
        some = self._file.chunk_rows(path)
        return self._file.chunk(path, row // some * some)[row % some]


class Replay:
    """Records of all discs, each as its last event left it; moves on through the event rows.

    state: the columns of a record beside its time.
    """

    def __init__(
        self,
        start: Checkpoint,
        columns: Sequence[str],
        box: tuple[float, float],
        periodic: Sequence[bool],
        gravity: tuple[float, float],
    ) -> None:
        self.row = start.row
        self._record = {name: start.arrays[name].copy() for name in LogState._fields[1:] if name in start.arrays}
        self._record.setdefault("position", np.full_like(start.velocity, np.nan))
        self.state = tuple(name for name in self._record if name in columns)
        self._time = np.full(len(start.velocity), start.time)
        self._box, self._periodic, self._gravity = box, periodic, gravity

    def follow(self, block: Any) -> None:
        """Take the next event rows; of several rows of a disc the last one stays."""
        self._time[block.disc] = block.time
        for name in self.state:
            self._record[name][block.disc] = getattr(block, name)
        self.row += len(block.time)

    def at(self, time: float) -> LogState:
        """All discs in free flight to a time between this row and the next.

        ValueError if a disc flies through more boxes than an image can count.
        """
        now = {name: values.copy() for name, values in self._record.items()}
        position, velocity = now["position"], now["velocity"]
        delay = time - self._time
        for axis, pull in enumerate(self._gravity):
            falls = any(self._gravity)
            place = position_after(position[:, axis], velocity[:, axis], pull if falls else None, delay)
            if falls:
                velocity[:, axis] = velocity_after(velocity[:, axis], pull, delay)
            if self._periodic[axis]:
                place, boxes = wrapped(place, self._box[axis])
                if not (np.abs(boxes) < MOST_BOXES).all():
                    raise ValueError(
                        f"a disc flies through {np.abs(boxes).max():g} boxes (allowed up to {MOST_BOXES:g})"
                    )
                now["image"][:, axis] += boxes.astype(np.int32)
            position[:, axis] = place
        return LogState(time, **now)

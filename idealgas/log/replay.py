"""States of the gas from what a log holds: checkpoints, and between them the discs' records and free flight."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, overload

import numpy as np

from idealgas.log.schema import CHECKPOINT_COLUMNS
from idealgas.log.source import Source


class LogState(NamedTuple):
    """All discs at one time. position, velocity: (N, 2), in order of id."""

    time: float
    position: np.ndarray
    velocity: np.ndarray


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

    def __init__(self, source: Source, rows: int) -> None:
        self._source = source
        self.times = source.column("checkpoints/time")
        self.rows = source.column("checkpoints/row")
        if source.rows("events"):
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
        entries = {name: self._entry(name, row) for name in self._source.names("checkpoints")}
        time, at, epoch = (entries.pop(column.name).item() for column in CHECKPOINT_COLUMNS)
        arrays = {name: entry for name, entry in entries.items() if entry.ndim}
        values = {name: entry.item() for name, entry in entries.items() if not entry.ndim}
        return Checkpoint(time, at, epoch, arrays, values)

    def _entry(self, name: str, row: int) -> np.ndarray:
        path = f"checkpoints/{name}"
        some = self._source.chunk_rows(path)
        return self._source.chunk(path, row // some * some)[row % some]


class Replay:
    """Records of all discs, each as its last event left it; moves on through the event rows."""

    def __init__(self, time: float, row: int, position: np.ndarray, velocity: np.ndarray) -> None:
        self.row = row
        self._time = np.full(len(position), time)
        self._position, self._velocity = position.copy(), velocity.copy()

    def follow(self, block: Any) -> None:
        """Take the next event rows; of several rows of a disc the last one stays."""
        self._time[block.disc] = block.time
        self._position[block.disc] = block.position
        self._velocity[block.disc] = block.velocity
        self.row += len(block.time)

    def at(self, time: float) -> LogState:
        """All discs in free flight to a time between this row and the next."""
        flight = (time - self._time)[:, None] * self._velocity
        return LogState(time, self._position + flight, self._velocity.copy())

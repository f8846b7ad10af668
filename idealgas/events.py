"""What an event is: the columns of the event log and the batches in which they travel from an engine to a log."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

BLOCK = 65_536
"""Rows of a full batch, and of a chunk in the file."""


class Kind(IntEnum):
    """What a disc met. Stored in the log as `events/kind`."""

    DISC = 0
    WALL = 1
    WALL_END = 2
    PISTON = 3


class EventBatch(NamedTuple):
    """Rows of the event log, in order of time; a pair collision is two rows, the smaller id first.

    time: (n,) f8, time. disc: (n,) u4, id. partner: (n,) i4, the other disc's id, or -1 - k for wall k.
    kind: (n,) u1, a `Kind`. position, velocity: (n, 2) f8, length and length/time, after the event; no position
    where the method has none. Only with the effect: angular_velocity: (n,) f8, 1/time, after the event. image: (n, 2)
    i4, box lengths that unwrap the position. Only with Monte Carlo: trial: (n,) u8, number of the trial, from 1.
    """

    time: np.ndarray
    disc: np.ndarray
    partner: np.ndarray
    kind: np.ndarray
    position: np.ndarray | None
    velocity: np.ndarray
    angular_velocity: np.ndarray | None = None
    image: np.ndarray | None = None
    trial: np.ndarray | None = None

    def rows(self, start: int, stop: int) -> "EventBatch":
        """View of some of the rows."""
        return EventBatch(*(None if column is None else column[start:stop] for column in self))  # type: ignore[arg-type]


def empty_batch(
    rows: int = BLOCK, rotating: bool = False, periodic: bool = False, without_positions: bool = False
) -> EventBatch:
    """A batch for an engine to fill; homogeneous: a gas without positions."""
    return EventBatch(
        time=np.empty(rows),
        disc=np.empty(rows, np.uint32),
        partner=np.empty(rows, np.int32),
        kind=np.empty(rows, np.uint8),
        position=None if without_positions else np.empty((rows, 2)),
        velocity=np.empty((rows, 2)),
        angular_velocity=np.empty(rows) if rotating else None,
        image=np.empty((rows, 2), np.int32) if periodic else None,
        trial=np.empty(rows, np.uint64) if without_positions else None,
    )


COLUMN_UNITS = {
    "time": "time",
    "disc": "",
    "partner": "",
    "kind": "",
    "position": "length",
    "velocity": "length/time",
    "angular_velocity": "1/time",
    "image": "",
    "trial": "",
}

BOX_SIDES = ("left", "right", "bottom", "top")
"""Walls 0 to 3; further walls follow in the order of the scene."""

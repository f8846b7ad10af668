"""What an event is: the columns of the event log and the batches in which they travel from an engine to a log.

A column is declared here once. Batches, the tables of a log, checkpoints, snapshots and exports are made from that.
"""

from collections.abc import Collection, Sequence
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


class Column(NamedTuple):
    """One column of a table: `shape` is that of a row's entry, `dtype` and `unit` those of its numbers.

    when: what discs must have for events to have this column, one of the words below; empty for every event. parts:
    names of the components of an entry, for tables in which a column is one number.
    """

    name: str
    dtype: str
    shape: tuple[int, ...] = ()
    unit: str = ""
    when: str = ""
    parts: tuple[str, ...] = ()


POSITIONS, SPINS, IMAGES, TRIALS = "positions", "spins", "images", "trials"
"""What discs may have: a place, an angular velocity, images through periodic sides, and pairs tried by Monte Carlo."""

POSITION = Column("position", "f8", (2,), "length", POSITIONS, ("x", "y"))
VELOCITY = Column("velocity", "f8", (2,), "length/time", parts=("vx", "vy"))
ANGULAR_VELOCITY = Column("angular_velocity", "f8", (), "1/time", SPINS)
IMAGE = Column("image", "i4", (2,), "", IMAGES, ("image_x", "image_y"))

EVENT_COLUMNS = (
    Column("time", "f8", (), "time"),
    Column("disc", "u4"),
    Column("partner", "i4"),
    Column("kind", "u1"),
    POSITION,
    VELOCITY,
    ANGULAR_VELOCITY,
    IMAGE,
    Column("trial", "u8", when=TRIALS),
)
"""All that an event may have, in the order of an `EventBatch`."""


class EventBatch(NamedTuple):
    """Rows of the event log, in order of time; a pair collision is two rows, the smaller id first.

    time: (n,) f8, time. disc: (n,) u4, id. partner: (n,) i4, the other disc's id, or -1 - k for wall k.
    kind: (n,) u1, a `Kind`. position, velocity: (n, 2) f8, length and length/time, after the event; no position
    where the method has none. Only where discs spin: angular_velocity: (n,) f8, 1/time, after the event. Only with
    periodic sides: image: (n, 2) i4, box lengths that unwrap the position. Only with Monte Carlo: trial: (n,) u8,
    number of the trial, from 1.
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


def event_columns(*has: str) -> tuple[Column, ...]:
    """Columns of the events of discs that have these things."""
    return tuple(column for column in EVENT_COLUMNS if not column.when or column.when in has)


def columns_named(names: Collection[str]) -> tuple[Column, ...]:
    """Columns of events by their names, in the order of the declaration."""
    return tuple(column for column in EVENT_COLUMNS if column.name in names)


PLAIN_COLUMNS = event_columns(POSITIONS)
"""Columns of the events of smooth discs in a reflecting box."""


def empty_batch(rows: int = BLOCK, columns: Sequence[Column] = PLAIN_COLUMNS) -> EventBatch:
    """A batch of so many rows with these columns, for an engine to fill; None in the place of the others."""
    made = {column.name: np.empty((rows, *column.shape), column.dtype) for column in columns}
    return EventBatch(*(made.get(name) for name in EventBatch._fields))  # type: ignore[arg-type]

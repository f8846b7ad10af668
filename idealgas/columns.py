"""Definition of an event row: its columns, batches of rows, kinds of events, and wall numbers.

Each column is declared once, here. Batches, tables in a log, checkpoints, snapshots and exports use this declaration.

Walls 0 to 3 are the sides of the box; wall segments follow. In events, the partner -1 - k stands for wall k.
"""

from collections.abc import Collection, Sequence
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

SIDES = ("left", "right", "bottom", "top")
"""Names of walls 0 to 3."""

MOST_SPECIES, MOST_WALLS = 1_000, 10_000
"""Largest number of species (limited because pairs of species are counted), and of wall segments."""

FIRST_SEGMENT = len(SIDES)
"""Number of the first wall segment; further segments follow in the order of the scene."""

HEAT_BATH = 1 << 30
"""Number of the heat bath, which exceeds all wall numbers; in events, the partner BATH stands for it."""

BATH = -1 - HEAT_BATH
"""Partner of a disc in an event of kind THERMOSTAT."""

OUTSIDE = BATH - 1
"""Partner of a disc in an event of kind STEERED."""

OUTWARD = ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0))
"""Unit normals (x, y) of the sides, pointing out of the box."""

Point = tuple[float, float]
"""Coordinates (x, y), length."""

BLOCK = 65_536
"""Number of rows in a full batch, and in a chunk of the file."""


class Kind(IntEnum):
    """Kind of an event: the object with which a disc collided; stored in the log as `events/kind`."""

    DISC = 0
    WALL = 1
    """A wall, or a sheared side through which the disc passes to the opposite side."""
    WALL_END = 2
    PISTON = 3
    THERMOSTAT = 4
    """The heat bath of a thermostat."""
    STEERED = 5
    """Not a collision: the velocity or the acceleration of the disc was changed from outside."""
    ESCAPED = 6
    """An absorbing wall, through which the disc left the gas; this is its last event."""
    FIXED_DISC = 7
    """A fixed disc of the scene, which counts as a wall."""


WALL_HITS = (Kind.WALL, Kind.WALL_END, Kind.FIXED_DISC, Kind.PISTON)
"""Kinds of events in which a disc hits a side, a wall segment, a fixed disc or a piston and stays in the gas."""


class Column(NamedTuple):
    """A column in a table.

    Attributes:
        name: name of the column.
        dtype: NumPy type of its numbers.
        shape: shape of the entry in one row.
        unit: unit of its numbers; empty if there is none.
        when: property that discs must have (see `POSITIONS`) for their events to have this column; empty if all events
            have it.
        parts: names of the components of an entry, for tables in which each column contains a single number per row.
    """

    name: str
    dtype: str
    shape: tuple[int, ...] = ()
    unit: str = ""
    when: str = ""
    parts: tuple[str, ...] = ()


COUNTED = {
    Kind.THERMOSTAT: Column("thermostat_collisions", "i8"),
    Kind.STEERED: Column("steered", "i8"),
    Kind.ESCAPED: Column("escaped", "i8"),
}
"""Checkpoint columns that count events of optional kinds; without such a column, a log has no events of this kind."""

Arrays = dict[Column, np.ndarray]
"""Columns with an entry for each disc."""

Values = dict[Column, Any]
"""Columns with a single entry."""

POSITIONS, SPINS, IMAGES, TRIALS = "positions", "spins", "images", "trials"
"""Properties that discs may have: positions, spins, images across periodic sides, and Monte Carlo trials."""

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
"""All columns that events may have, in the order of the fields of `EventBatch`."""


class EventBatch(NamedTuple):
    """Rows of the event log in time order; a collision of two discs has two rows, the smaller id first.

    Attributes:
        time: (n,) f8, time of the event.
        disc: (n,) u4, id of the disc.
        partner: (n,) i4, id of the other disc, -1 - k for wall k, BATH or OUTSIDE.
        kind: (n,) u1, a `Kind`.
        position: (n, 2) f8, position after the event, length; None if the method has no positions.
        velocity: (n, 2) f8, velocity after the event, length/time.
        angular_velocity: (n,) f8, angular velocity after the event, 1/time; None if discs do not spin.
        image: (n, 2) i4, number of box lengths to be added to the position to unwrap it; None without periodic sides.
        trial: (n,) u8, number of the Monte Carlo trial, from 1; None for other methods.
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
        """Return a view of the rows from `start` up to, but not including, `stop`."""
        return EventBatch(*(None if column is None else column[start:stop] for column in self))  # type: ignore[arg-type]


def event_columns(*has: str) -> tuple[Column, ...]:
    """Return the event columns of discs that have these properties."""
    return tuple(column for column in EVENT_COLUMNS if not column.when or column.when in has)


def columns_named(names: Collection[str]) -> tuple[Column, ...]:
    """Return the event columns with these names, in the order of their declaration."""
    return tuple(column for column in EVENT_COLUMNS if column.name in names)


PLAIN_COLUMNS = event_columns(POSITIONS)
"""Event columns of smooth discs in a reflecting box."""


def empty_batch(rows: int = BLOCK, columns: Sequence[Column] = PLAIN_COLUMNS) -> EventBatch:
    """Return a batch of `rows` rows with these columns, to be filled by an engine; all other columns are None."""
    made = {column.name: np.empty((rows, *column.shape), column.dtype) for column in columns}
    return EventBatch(*(made.get(name) for name in EventBatch._fields))  # type: ignore[arg-type]


def face_names(walls: Sequence[str]) -> list[str]:
    """Return the names of all faces, given the names of the walls: the sides, then both faces of each segment.

    The face on the left, as seen from the start of the segment towards its end, comes first.
    """
    segments = walls[FIRST_SEGMENT:]
    return [*walls[:FIRST_SEGMENT], *(f"{name} {face}" for name in segments for face in ("left", "right"))]


def axis_of(side: int) -> int:
    """Return the axis normal to a side: 0 (x) for left and right, 1 (y) for bottom and top."""
    return side // 2


def is_upper(side: int) -> bool:
    """Return whether a side is at the larger coordinate along its axis, as the right and top sides are."""
    return side % 2 == 1


def sides_across(axis: int) -> tuple[int, int]:
    """Return the numbers of the two sides normal to an axis; the side at the smaller coordinate is first."""
    return 2 * axis, 2 * axis + 1


def opposite(side: int) -> int:
    """Return the number of the opposite side."""
    return side ^ 1


def side_ends(box: tuple[float, float]) -> list[tuple[Point, Point]]:
    """Return the two end points of each side of a box (width, height), length."""
    width, height = box
    left, right = ((0.0, 0.0), (0.0, height)), ((width, 0.0), (width, height))
    return [left, right, ((0.0, 0.0), (width, 0.0)), ((0.0, height), (width, height))]

"""Checks of the tables and columns that a log must have, and of its box, discs, species and walls.

Missing or invalid data raise ValueError.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from idealgas.columns import (
    EVENT_COLUMNS,
    IMAGE,
    MOST_SPECIES,
    MOST_WALLS,
    SIDES,
    TRIALS,
    VELOCITY,
    Column,
    side_ends,
)
from idealgas.log.rules import LEAST, MOST
from idealgas.log.schema import BOX, CHANGE_COLUMNS, CHECKPOINT_COLUMNS, RUN_COLUMNS, SUMMARY_COLUMNS, Wall

NEEDED: dict[str, Sequence[Column]] = {
    "runs": RUN_COLUMNS,
    "events": [column for column in EVENT_COLUMNS if not column.when],
    "checkpoints": (*CHECKPOINT_COLUMNS, VELOCITY),
    "summary": SUMMARY_COLUMNS,
    "changes": CHANGE_COLUMNS,
}
"""Columns that each table must have; only the tables `events` and `changes` may be missing from a log."""


def box_of(data: np.ndarray) -> tuple[float, float]:
    """Return the width and height of the box. Raises ValueError if the data are invalid."""
    if data.shape != BOX.shape or data.dtype != np.dtype(BOX.dtype) or not ((data >= LEAST) & (data <= MOST)).all():
        raise ValueError(f"box: invalid width and height (allowed {LEAST:g} to {MOST:g})")
    width, height = data.tolist()
    return width, height


def check_names(names: Mapping[str, Sequence[str]]) -> None:
    """Check that each table has the required columns. names: names of the columns, by table."""
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
    """Check that checkpoints have a column of images if and only if some sides are periodic.

    Args:
        periodic: whether any sides are periodic.
        names: names of the columns of checkpoints.
    """
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
    """Check that the numbers of discs, species and walls are possible for a file of `file_size` bytes."""
    if not 1 <= discs <= file_size:
        raise ValueError(f"discs/id: {discs:,} discs in a file of {file_size:,} bytes")
    if not 1 <= species <= discs:
        raise ValueError(f"discs/species_name: {species} names for {discs} discs")
    if species > MOST_SPECIES:
        raise ValueError(f"discs/species_name: {species:,} names (allowed up to {MOST_SPECIES:,})")
    if not len(SIDES) <= walls <= len(SIDES) + MOST_WALLS:
        most = len(SIDES) + MOST_WALLS
        raise ValueError(f"walls/name: {walls:,} walls (allowed from {len(SIDES)} to {most:,})")

"""Numbers of the walls: 0 to 3 are the sides of the box, wall segments follow. Events name wall k as partner -1 - k.

A heat bath has a number beyond all walls.
"""

from collections.abc import Sequence

SIDES = ("left", "right", "bottom", "top")
"""Names of walls 0 to 3."""

FIRST_SEGMENT = len(SIDES)
"""Number of the first wall segment; the others follow in the order of the scene."""

HEAT_BATH = 1 << 30
"""Number that stands for a heat bath, which discs meet anywhere: events name it as partner -1 - HEAT_BATH."""

OUTWARD = ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0))
"""Unit normals (x, y) of the sides, pointing out of the box."""

Point = tuple[float, float]


def face_names(walls: Sequence[str]) -> list[str]:
    """Names of all that a disc can hit, by the names of the walls: the sides, then both faces of every segment.

    That on the left of the way from the segment's start to its end comes first.
    """
    segments = walls[FIRST_SEGMENT:]
    return [*walls[:FIRST_SEGMENT], *(f"{name} {face}" for name in segments for face in ("left", "right"))]


def axis_of(side: int) -> int:
    """Axis normal to a side: 0 (x) for left and right, 1 (y) for bottom and top."""
    return side // 2


def is_upper(side: int) -> bool:
    """Whether a side is at the larger coordinate along its axis: right and top."""
    return side % 2 == 1


def sides_across(axis: int) -> tuple[int, int]:
    """Numbers of the two sides normal to an axis, that at the smaller coordinate first."""
    return 2 * axis, 2 * axis + 1


def opposite(side: int) -> int:
    """Number of the opposite side."""
    return side ^ 1


def side_ends(box: tuple[float, float]) -> list[tuple[Point, Point]]:
    """Both end points of each side of a box (width, height), length."""
    width, height = box
    left, right = ((0.0, 0.0), (0.0, height)), ((width, 0.0), (width, height))
    return [left, right, ((0.0, 0.0), (width, 0.0)), ((0.0, height), (width, height))]

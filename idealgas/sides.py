"""Walls by their numbers: 0 to 3 are the sides of the box, the wall segments follow. Events name wall k as -1 - k."""

SIDES = ("left", "right", "bottom", "top")
"""Names of walls 0 to 3."""

FIRST_SEGMENT = len(SIDES)
"""Number of the first wall segment; the others follow in the order of the scene."""

OUTWARD = ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0))
"""Unit normals of the sides out of the box."""

Point = tuple[float, float]


def axis_of(side: int) -> int:
    """The axis that leads through a side: 0 for left and right, 1 for bottom and top."""
    return side // 2


def is_upper(side: int) -> bool:
    """Whether a side is where the coordinate along its axis is largest: right and top."""
    return side % 2 == 1


def sides_across(axis: int) -> tuple[int, int]:
    """The two sides that an axis leads through, the lower one first."""
    return 2 * axis, 2 * axis + 1


def opposite(side: int) -> int:
    """The side that faces a side."""
    return side ^ 1


def side_ends(box: tuple[float, float]) -> list[tuple[Point, Point]]:
    """Both ends of every side of a box (width, height), length."""
    width, height = box
    left, right = ((0.0, 0.0), (0.0, height)), ((width, 0.0), (width, height))
    return [left, right, ((0.0, 0.0), (width, 0.0)), ((0.0, height), (width, height))]

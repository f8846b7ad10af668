"""Layout of a frame: its size, and where the box and the panel beside it are."""

from collections.abc import Sequence
from typing import NamedTuple

from idealgas.movie.piston_track import PistonTrack

BEYOND = 1.25
"""Length of the shown room along the way of a piston, relative to the largest one of the gas."""

LEFT, RIGHT, BOTTOM, TOP, LETTER = 64, 22, 58, 48, 10  # margins, and a letter of a name, pixels of the usual size
PANEL = 0.3
"""Smallest share of a frame for the panel beside or below the box."""

SIZES = ((960, 540), (720, 720), (540, 960))
"""Sizes of a frame, pixels."""

Rectangle = tuple[float, float, float, float]


class Layout(NamedTuple):
    """Rectangles (left, bottom, width, height) of box and panel in pixels, and scale in pixels per unit of length."""

    box: Rectangle
    panel: Rectangle | None
    scale: float


def layout(size: tuple[float, float], box: tuple[float, float], panel: bool = True) -> Layout:
    """Layout with a panel beside the box, or below it if the box is larger then."""
    width, height = size[0] - LEFT - RIGHT, size[1] - TOP - BOTTOM
    if not panel:
        scale = min(width / box[0], height / box[1])
        w, h = scale * box[0], scale * box[1]
        return Layout((LEFT + (width - w) / 2, BOTTOM + (height - h) / 2, w, h), None, scale)
    aside, below = PANEL * size[0], PANEL * size[1]
    beside = min((width - LEFT - aside) / box[0], height / box[1])
    above = min(width / box[0], (height - BOTTOM - below) / box[1])
    scale = max(beside, above)
    w, h = scale * box[0], scale * box[1]
    if beside >= above:
        other = (2 * LEFT + w, BOTTOM, width - LEFT - w, height)
        return Layout((LEFT, BOTTOM + (height - h) / 2, w, h), other, scale)
    other = (LEFT, BOTTOM, width, height - BOTTOM - h)
    return Layout((LEFT + (width - w) / 2, size[1] - TOP - h, w, h), other, scale)


def view(box: tuple[float, float], pistons: Sequence[PistonTrack]) -> tuple[tuple[float, float], tuple[float, float]]:
    """Shown part of a box along x and y, length: the box, but of the room beyond a piston only BEYOND the gas."""
    shown = [(0.0, box[0]), (0.0, box[1])]
    for piston in pistons:
        low, high = shown[piston.axis]
        if piston.outward > 0:
            high = min(high, BEYOND * float(piston.place.max()))
        elif piston.outward < 0:
            low = max(low, high - BEYOND * (high - float(piston.place.min())))
        shown[piston.axis] = low, high
    return shown[0], shown[1]


def lengths(shown: tuple[tuple[float, float], tuple[float, float]]) -> tuple[float, float]:
    """Lengths of the shown part of a box along x and y."""
    (left, right), (low, high) = shown
    return right - left, high - low


def frame_size(shown: tuple[tuple[float, float], tuple[float, float]], panel: bool) -> tuple[int, int]:
    """Size of a frame, of SIZES: the first one, unless the shown part of a box is much larger in another."""
    return max(SIZES, key=lambda size: layout(size, lengths(shown), panel).scale * (1.2 if size == SIZES[0] else 1.0))

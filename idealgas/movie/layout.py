"""Layout of a frame: its size, and the positions of the box and the panel."""

from collections.abc import Sequence
from typing import NamedTuple

from idealgas.movie.piston_track import PistonTrack

BEYOND = 1.25
"""Length of the displayed range along the axis of a piston, relative to the largest length of the gas."""

LEFT, RIGHT, BOTTOM, TOP, LETTER = 64, 22, 58, 48, 10  # margins and width of a letter, pixels at the usual frame size
PANEL = 0.3
"""Smallest fraction of a frame that is used for the panel beside or below the box."""

SIZES = ((960, 540), (720, 720), (540, 960))
"""Default sizes of a frame, pixels."""

Rectangle = tuple[float, float, float, float]


class Layout(NamedTuple):
    """Rectangles (left, bottom, width, height) of box and panel in pixels, and scale in pixels per unit length."""

    box: Rectangle
    panel: Rectangle | None
    scale: float


def layout(size: tuple[float, float], box: tuple[float, float], panel: bool = True) -> Layout:
    """Return the layout of a frame, with the panel beside the box, or below it if this makes the box larger.

    Args:
        size: width and height of the frame, pixels.
        box: width and height of the displayed part of the box, length.
        panel: whether there is a panel.
    """
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
        place = (2 * LEFT + w, BOTTOM, width - LEFT - w, height)
        return Layout((LEFT, BOTTOM + (height - h) / 2, w, h), place, scale)
    place = (LEFT, BOTTOM, width, height - BOTTOM - h)
    return Layout((LEFT + (width - w) / 2, size[1] - TOP - h, w, h), place, scale)


def view(box: tuple[float, float], pistons: Sequence[PistonTrack]) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the ranges of x and y that are shown, length.

    The whole box is shown, apart from most of the empty space beyond a piston (see BEYOND).
    """
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
    """Return the lengths of the displayed part of a box along x and y."""
    (left, right), (low, high) = shown
    return right - left, high - low


def frame_size(shown: tuple[tuple[float, float], tuple[float, float]], panel: bool) -> tuple[int, int]:
    """Return the size of a frame: the first of SIZES, unless another size makes the drawn box much larger."""
    return max(SIZES, key=lambda size: layout(size, lengths(shown), panel).scale * (1.2 if size == SIZES[0] else 1.0))

"""Periodic sides of the box: wrapped positions, images and minimum-image distances.

When a disc crosses a periodic side, its stored position does not change. Instead, `crossed_x` and `crossed_y` count how
often the disc has crossed the boundary along x and y since its local time t, where crossings to the left and downwards
count as -1. The position is wrapped when the disc is next moved. In all functions, `images` are the numbers of box
lengths (x, y) to subtract from the stored position of a disc relative to another disc or to a wall; they matter only if
sides are periodic.
"""

from typing import NamedTuple

import numpy as np

from idealgas.jit import inline
from idealgas.physics.shear import Shear, less_offset_of_nearest

U = np.uintp
NO_IMAGES = (0, 0)


class Periodic(NamedTuple):
    """Periodic sides of the box, and the image of each disc.

    Attributes:
        x: whether the left and the right side are periodic.
        y: whether the bottom and the top side are periodic.
        Lx: width of the box, length.
        Ly: height of the box, length.
        image: (N, 2) i4 by id, numbers of box lengths to add to a disc's stored position to unwrap it.
        shear: motion of the images above and below the box, for kernels; None without sheared sides. With shear, y is
            false, because the crossing of a sheared side is an event.
    """

    x: bool
    y: bool
    Lx: float
    Ly: float
    image: np.ndarray
    shear: Shear | None = None


def periodic_axes(periodic: Periodic | None) -> tuple[bool, bool]:
    """Whether the box is periodic along x, and whether it is periodic along y."""
    return (periodic.x, periodic.y) if periodic else (False, False)


def copy_of(periodic: Periodic | None) -> Periodic | None:
    """Copy of the periodic sides with an independent array of images; None without periodic sides."""
    if periodic is None:
        return None
    return periodic._replace(image=periodic.image.copy())


def unwrapped(position: np.ndarray, periodic: Periodic | None) -> np.ndarray:
    """Unwrapped positions (N, 2) of discs at wrapped positions (N, 2), length."""
    return position if periodic is None else position + periodic.image * (periodic.Lx, periodic.Ly)


@inline
def images_between(periodic, a, b, image):
    """Numbers of box lengths to subtract from the position of disc a relative to disc b; zeros without periodic sides.

    image: the numbers (x, y) that would be subtracted if both positions were wrapped into the box.
    """
    if periodic is not None:
        return (
            np.int64(a.crossed_x) - np.int64(b.crossed_x) + image[0],
            np.int64(a.crossed_y) - np.int64(b.crossed_y) + image[1],
        )
    return NO_IMAGES


@inline
def images_to_wall(periodic, disc, image):
    """Numbers of box lengths to subtract from a disc's position relative to a wall; zeros without periodic sides.

    image: the numbers (x, y) that would be subtracted if the position were wrapped into the box; they select an image
    of the wall.
    """
    if periodic is not None:
        return np.int64(disc.crossed_x) + image[0], np.int64(disc.crossed_y) + image[1]
    return NO_IMAGES


@inline
def shift_by_images(x, y, periodic, images):
    """Subtract numbers of box lengths (x, y) from a relative position (x, y), length."""
    if periodic is not None:
        return x - periodic.Lx * images[0], y - periodic.Ly * images[1]
    return x, y


@inline
def is_periodic(periodic, along_y):
    """Whether the box is periodic along y or, if not along_y, along x."""
    if periodic is not None:
        return periodic.y if along_y else periodic.x
    return False


@inline
def nearest_image(distance, length, is_periodic):
    """Difference of coordinates to the nearest image, length; unchanged if not periodic; numbers or arrays."""
    return distance - length * np.rint(distance / length) if is_periodic else distance


@inline
def nearest_images(x, y, periodic):
    """Numbers of box lengths (x, y) to subtract from a relative position (x, y) to get the minimum image."""
    if periodic is not None:
        images_x = np.int64(round(x / periodic.Lx)) if periodic.x else 0
        images_y = np.int64(round(y / periodic.Ly)) if periodic.y else 0
        return images_x, images_y
    return NO_IMAGES


@inline
def separation(a, b, periodic):
    """Position (x, y), length, of disc a relative to the nearest image of disc b.

    The fields of a and b may be numbers or arrays.
    """
    x = a.x - b.x
    y = a.y - b.y
    if periodic is not None:
        x, y = less_offset_of_nearest(x, y, a.t, periodic.shear)
        x = nearest_image(x, periodic.Lx, periodic.x)
        y = nearest_image(y, periodic.Ly, periodic.y)
    return x, y


@inline
def wrapped(position, length):
    """Coordinate (length) wrapped into the box, and the number of box lengths subtracted; numbers or arrays."""
    boxes = np.floor(position / length)
    return position - boxes * length, boxes


@inline
def wrap(disc, disc_id, periodic):
    """Wrap a disc's position into the box, and update its image and its boundary crossings."""
    if periodic is not None:
        if periodic.x and not 0.0 < disc.x < periodic.Lx:  # rare, and wrapping requires a slow division
            disc.x, boxes = wrapped(disc.x, periodic.Lx)
            periodic.image[U(disc_id), 0] += np.int32(boxes)
            disc.crossed_x -= np.int16(boxes)
        if periodic.y and not 0.0 < disc.y < periodic.Ly:
            disc.y, boxes = wrapped(disc.y, periodic.Ly)
            periodic.image[U(disc_id), 1] += np.int32(boxes)
            disc.crossed_y -= np.int16(boxes)


@inline
def enter_opposite_side(disc, disc_id, rows, periodic):
    """Wrap the position of a disc that has crossed a sheared side.

    rows: 1 if the disc has left through the top, -1 if through the bottom.
    """
    if periodic is not None:
        wrap(disc, disc_id, periodic)
        disc.crossed_x = 0
        periodic.image[U(disc_id), 1] += np.int32(rows)


@inline
def place_in_space(disc, disc_id, periodic):
    """Unwrapped position (x, y), length, of a disc whose stored position is wrapped."""
    if periodic is not None:
        return (
            disc.x + periodic.image[U(disc_id), 0] * periodic.Lx,
            disc.y + periodic.image[U(disc_id), 1] * periodic.Ly,
        )
    return disc.x, disc.y

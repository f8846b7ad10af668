"""Periodic sides: where a disc that went through one comes back, and in which image it meets another."""

from typing import NamedTuple

import numpy as np

from idealgas._jit import inline

U = np.uintp
NO_IMAGES = (0, 0)


class Periodic(NamedTuple):
    """x, y: which sides are joined. Lx, Ly: box, length.

    turns: (N, 2) i4 by id, how often each disc went through them since its record. image: (N, 2) i4 by id, box lengths
    to add to a record's position to unwrap it.
    """

    x: bool
    y: bool
    Lx: float
    Ly: float
    boundary_crossings: np.ndarray
    image: np.ndarray


def periodic_axes(periodic: Periodic | None) -> tuple[bool, bool]:
    """Along which axes sides are joined."""
    return (periodic.x, periodic.y) if periodic else (False, False)


def copy_of(periodic: Periodic | None) -> Periodic | None:
    """One whose counts can change without changing the original's."""
    if periodic is None:
        return None
    return periodic._replace(boundary_crossings=periodic.boundary_crossings.copy(), image=periodic.image.copy())


def begin_epoch(periodic: Periodic, time: float) -> None:
    """Count ways through periodic sides from a time on, at which every record stands."""
    periodic.boundary_crossings[:] = 0


@inline
def images_between(periodic, a_id, b_id, image):
    """Box lengths between the records of a and b, which stand `image` box lengths apart now."""
    if periodic is not None:
        return (
            np.int64(periodic.boundary_crossings[U(a_id), 0] - periodic.boundary_crossings[U(b_id), 0] + image[0]),
            np.int64(periodic.boundary_crossings[U(a_id), 1] - periodic.boundary_crossings[U(b_id), 1] + image[1]),
        )
    return NO_IMAGES


@inline
def images_to_wall(periodic, own, image):
    """Box lengths between a disc's record and a wall that stands `image` box lengths away from its place now."""
    if periodic is not None:
        return np.int64(periodic.boundary_crossings[U(own), 0] + image[0]), np.int64(
            periodic.boundary_crossings[U(own), 1] + image[1]
        )
    return NO_IMAGES


@inline
def shift_by_images(x, y, periodic, images):
    """A relative position across so many box lengths."""
    if periodic is not None:
        return x - periodic.Lx * images[0], y - periodic.Ly * images[1]
    return x, y


@inline
def is_periodic(periodic, along_y):
    """Whether the sides across an axis are joined."""
    if periodic is not None:
        return periodic.y if along_y else periodic.x
    return False


@inline
def boxes_to_nearest(distance, length):
    """How many box lengths to take from a coordinate difference to make it the nearest image's."""
    return round(distance / length)


@inline
def nearest_image(distance, length, is_periodic):
    """A coordinate difference, through joined sides if that is shorter."""
    return distance - length * boxes_to_nearest(distance, length) if is_periodic else distance


@inline
def nearest_images(x, y, periodic):
    """Box lengths from one disc to the nearest image of another, which is (x, y) away."""
    if periodic is not None:
        images_x = np.int64(boxes_to_nearest(x, periodic.Lx)) if periodic.x else 0
        images_y = np.int64(boxes_to_nearest(y, periodic.Ly)) if periodic.y else 0
        return images_x, images_y
    return NO_IMAGES


@inline
def separation(a, b, periodic):
    """Position of a relative to b's nearest image."""
    x = a.x - b.x
    y = a.y - b.y
    if periodic is not None:
        x = nearest_image(x, periodic.Lx, periodic.x)
        y = nearest_image(y, periodic.Ly, periodic.y)
    return x, y


@inline
def wrapped(position, length):
    """A coordinate put back between joined sides, and the box lengths taken from it. Numbers or arrays."""
    boxes = np.floor(position / length)
    return position - boxes * length, boxes


@inline
def wrap(disc, own, periodic):
    """Put a record's position back into the box and keep count."""
    if periodic is not None:
        if periodic.x:
            disc.x, boxes = wrapped(disc.x, periodic.Lx)
            periodic.image[U(own), 0] += np.int32(boxes)
            periodic.boundary_crossings[U(own), 0] -= np.int32(boxes)
        if periodic.y:
            disc.y, boxes = wrapped(disc.y, periodic.Ly)
            periodic.image[U(own), 1] += np.int32(boxes)
            periodic.boundary_crossings[U(own), 1] -= np.int32(boxes)


@inline
def boundary_crossings_along(periodic, own, along_y):
    """How often a disc went through joined sides along an axis since its record, and whether they are joined."""
    if periodic is not None:
        return (
            (periodic.boundary_crossings[U(own), 1], periodic.y)
            if along_y
            else (periodic.boundary_crossings[U(own), 0], periodic.x)
        )
    return np.int32(0), False

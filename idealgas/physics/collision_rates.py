"""How often discs meet discs and sides, by kinetic theory: good enough to choose lengths of time by, not to measure."""

import math
from collections.abc import Sequence

from idealgas.physics.contact_value import contact_value

DENSEST = 0.9  # packing fraction beyond which the contact value is not asked for


def pair_encounters(number: int, mean_diameter: float, packing_fraction: float, box: tuple[float, float]) -> float:
    """Encounters of one disc with the others per length that it moves, 1/length; arguments as below."""
    chi = contact_value(min(packing_fraction, DENSEST))
    return math.sqrt(2.0) * mean_diameter * (number - 1) / (box[0] * box[1]) * chi


def encounters_of_discs(
    number: int,
    mean_diameter: float,
    largest_radius: float,
    packing_fraction: float,
    box: tuple[float, float],
    periodic: Sequence[bool],
) -> float:
    """Encounters of all discs with discs and sides per length that each disc moves, 1/length.

    number: of discs. mean_diameter, largest_radius: length. packing_fraction: area of the discs over that of the box.
    box: width and height, length. periodic: whether the sides along x and along y are. Sides that leave the largest
    disc less room than its diameter do not count.
    """
    pairs = pair_encounters(number, mean_diameter, packing_fraction, box)
    room = [length - 2.0 * largest_radius for length in box]
    paths = [
        free if free > 2.0 * largest_radius else length * on
        for free, length, on in zip(room, box, periodic, strict=True)
    ]
    sides = sum(2.0 / (math.pi * path) for path in paths if path > 0.0)
    return number * (pairs + sides)

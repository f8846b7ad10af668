"""Collision rates of hard discs from kinetic theory.

Two discs with the sum of radii S and the relative speed v sweep the area 2Sv per time, out of the box's area A. A pair
at random positions thus collides at the rate 2Sχv/A, where χ is the contact value of the pair distribution, 1 in a
dilute gas. Such estimates determine the lengths of epochs; they are not measurements. Monte Carlo trials are made at
the rate of the fastest possible pair, and accepted in the ratio of the rates: Novak & Bortz, Am. J. Phys. 38, 1402
(1970); Eger & Kress, Am. J. Phys. 50, 120 (1982).
"""

import math
from collections.abc import Sequence

DENSEST = 0.9  # packing fraction above which the contact value is not evaluated


def contact_value(packing_fraction):
    """Contact value χ = (1 - 7φ/16)/(1 - φ)² of hard discs; packing_fraction: φ, a number or an array.

    Source: Henderson, Mol. Phys. 30, 971 (1975).
    """
    return (1.0 - 7.0 * packing_fraction / 16.0) / (1.0 - packing_fraction) ** 2


def disc_collisions_per_length(
    number: int, mean_diameter: float, packing_fraction: float, box: tuple[float, float]
) -> float:
    """Number of collisions of a disc with other discs per length of its path, 1/length; see `collisions_per_length`."""
    chi = contact_value(min(packing_fraction, DENSEST))
    return math.sqrt(2.0) * mean_diameter * (number - 1) / (box[0] * box[1]) * chi


def collisions_per_length(
    number: int,
    mean_diameter: float,
    largest_radius: float,
    packing_fraction: float,
    box: tuple[float, float],
    periodic: Sequence[bool],
) -> float:
    """Number of collisions of all discs with discs and sides per length that each disc moves, 1/length.

    Opposite sides that leave the largest disc less room than its diameter are left out.

    Args:
        number: number of discs.
        mean_diameter: length.
        largest_radius: length.
        packing_fraction: area of the discs divided by the area of the box.
        box: width and height, length.
        periodic: whether the box is periodic along x and along y.
    """
    pairs = disc_collisions_per_length(number, mean_diameter, packing_fraction, box)
    room = [length - 2.0 * largest_radius for length in box]
    paths = [
        free if free > 2.0 * largest_radius else length * on
        for free, length, on in zip(room, box, periodic, strict=True)
    ]
    sides = sum(2.0 / (math.pi * path) for path in paths if path > 0.0)
    return number * (pairs + sides)


def mean_trial_time(number: int, area: float, packing_fraction: float, largest_reach: float, v_ref: float) -> float:
    """Mean time between trials, A/(N(N - 1) S χ v_ref).

    N(N - 1)/2 pairs are tried, each at the rate 2Sχv_ref/A. In equilibrium a disc then collides at the rate (1 - 1/N)
    2Snχ√(πT/m) of kinetic theory.

    Args:
        number: number N of discs.
        area: area A of the box, length².
        packing_fraction: packing fraction, from which χ follows.
        largest_reach: largest sum S of two radii, length.
        v_ref: upper bound of the relative speed, length/time.
    """
    pairs = number * (number - 1)
    return area / (pairs * largest_reach * contact_value(packing_fraction) * v_ref)

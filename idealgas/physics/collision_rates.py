"""Collision rates of hard discs from kinetic theory.

Two discs that move at relative speed v sweep an area 2Sv per unit time, where S is the sum of their radii. In a box of
area A, two discs at random positions therefore collide at a rate 2Sχv/A, where χ is the contact value of the pair
distribution function, which is 1 in a dilute gas. These estimates determine the lengths of epochs; they are not
measurements. Monte Carlo trials take place at the rate of the fastest possible pair. Each trial is accepted with a
probability equal to the rate of the pair that is tried divided by the rate of the fastest: Novak & Bortz, Am. J. Phys.
38, 1402 (1970); Eger & Kress, Am. J. Phys. 50, 120 (1982).
"""

import math
from collections.abc import Sequence

DENSEST = 0.9  # largest packing fraction for which the contact value is evaluated; beyond it, χ stays constant


def contact_value(packing_fraction):
    """Contact value χ = (1 - 7φ/16)/(1 - φ)² of the pair distribution function of hard discs.

    packing_fraction: φ, a number or an array. Source: Henderson, Mol. Phys. 30, 971 (1975).
    """
    return (1.0 - 7.0 * packing_fraction / 16.0) / (1.0 - packing_fraction) ** 2


def disc_collisions_per_length(
    number: int, mean_diameter: float, packing_fraction: float, box: tuple[float, float]
) -> float:
    """Mean number of collisions of one disc with other discs per unit length of its path, 1/length.

    The arguments are as in `collisions_per_length`.
    """
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
    """Collisions with discs and sides, summed over all discs, per unit length that each disc moves, 1/length.

    A collision of two discs counts for both of them. Two opposite sides that are not periodic are ignored if the
    largest disc can move between them by no more than its diameter.

    Args:
        number: number of discs.
        mean_diameter: mean diameter of the discs, length.
        largest_radius: largest radius of a disc, length.
        packing_fraction: area of the discs divided by the area of the box.
        box: width and height of the box, length.
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
    """Mean time between Monte Carlo trials, A/(N(N - 1) S χ v_ref).

    Each of the N(N - 1)/2 pairs is tried at a rate 2Sχv_ref/A. In equilibrium at temperature T, a disc among N equal
    discs of mass m then collides at a rate (1 - 1/N) 2Snχ√(πT/m), where n = N/A. Apart from the factor 1 - 1/N, this is
    the rate from kinetic theory.

    Args:
        number: number N of discs.
        area: area A of the box, length².
        packing_fraction: packing fraction, which determines χ.
        largest_reach: largest sum S of two radii, length.
        v_ref: upper bound of the relative speed, length/time.
    """
    pairs = number * (number - 1)
    return area / (pairs * largest_reach * contact_value(packing_fraction) * v_ref)

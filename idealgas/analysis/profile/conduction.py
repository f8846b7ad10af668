"""Heat conducted through a dilute gas of equal discs between two thermal sides: Fourier's law with jumps at the sides.

Where no disc comes from behind, the gas next to a thermal side is not at its temperature: T differs from it by the
gradient times JUMP mean free paths. Source: Maxwell, Phil. Trans. 170, 231 (1879).
"""

import math
from typing import NamedTuple

from idealgas.analysis.theory import hard_discs

JUMP = 2.7
"""Length over which the gradient would go on beyond a side that takes up discs completely, in mean free paths.

Temperatures in ten strips were measured with boxes 2.8 to 23 mean free paths wide and walls of 1 and 2, or 1 and 4.
"""

JUMP_ERROR = 0.3
"""Root mean square of their deviations from this law, relative to the mean jump; 0.17 to 0.28 were found."""

LEAST_INSIDE = 0.4
"""Least part of the difference of temperatures that is left in the gas; in narrower boxes the law is another."""

ROUNDS, STEP = 200, 0.25


class Conduction(NamedTuple):
    """Temperatures of the gas at the lower and at the higher side, and the error of temperatures, energy."""

    low: float
    high: float
    error: float


def conduct(low: float, high: float, size: float, density: float, diameter: float) -> Conduction | None:
    """Temperatures of a gas between sides of temperatures low and high, energy; None where the jumps are too large.

    size: distance of the sides, length. density: mean number density, 1/length². diameter: of a disc, length. T^(3/2)
    changes evenly from side to side, as the conductivity goes with √T, and nT is the same everywhere.
    """
    a, b = low, high
    for _ in range(ROUNDS):
        if (b - a) / (high - low) < LEAST_INSIDE / 2:
            return None
        rise = b**1.5 - a**1.5
        pressure = density * rise / (3 * (math.sqrt(b) - math.sqrt(a)))  # density over the mean of 1/T
        jump = JUMP * hard_discs.mean_free_path(diameter, pressure, 0.0) * 2 / 3 * rise / size
        a += STEP * (low + jump * math.sqrt(a) - a)
        b += STEP * (high - jump * math.sqrt(b) - b)
    if (b - a) / (high - low) < LEAST_INSIDE:
        return None
    return Conduction(a, b, JUMP_ERROR * (abs(a - low) + abs(b - high)) / 2)

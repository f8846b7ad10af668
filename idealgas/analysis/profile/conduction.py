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
    ratio = high / low
    a, b = 1.0, ratio  # in units of the lower side's
    for _ in range(ROUNDS):
        if (b - a) / (ratio - 1) < LEAST_INSIDE / 2:
            return None
        pressure = density * (a + math.sqrt(a * b) + b) / 3  # density over the mean of 1/T
        gradient = (b**1.5 - a**1.5) / size  # of T^(3/2)
        jump = JUMP * hard_discs.mean_free_path(diameter, pressure, 0.0) * 2 / 3 * gradient
        a += STEP * (1.0 + jump * math.sqrt(a) - a)
        b += STEP * (ratio - jump * math.sqrt(b) - b)
    if (b - a) / (ratio - 1) < LEAST_INSIDE:
        return None
    return Conduction(low * a, low * b, JUMP_ERROR * low * (abs(a - 1.0) + abs(b - ratio)) / 2)

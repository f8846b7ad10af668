"""Free energy of few discs in a box: exact for one and two, from the second virial coefficient for more."""

import math

import numpy as np

from idealgas.state import Gas
from idealgas.theory import two_discs
from idealgas.theory.values import Theory

THIRD = 0.391
"""Half of B₃/B₂², the coefficient of the third virial term of the free energy: Tonks, Phys. Rev. 50, 955 (1936)."""


MOST_RADII = 32
"""Largest number of different radii; integrals over pairs of more radii would take seconds."""


def log_configurations(gas: Gas, box: tuple[float, float], periodic: tuple[bool, bool]) -> Theory | None:
    """Return the logarithm ln Q of the volume of all configurations of the discs of a gas in a box.

    The result is None if the discs do not fit, or if there are more than MOST_RADII different radii. Pairs are treated
    exactly, so that Q is exact for two discs. The estimated error is the neglected contribution of correlations of
    three or more discs.
    """
    single, pairs = 0.0, 0.0
    radii, numbers = np.unique(gas.radius, return_counts=True)
    if len(radii) > MOST_RADII:
        return None
    room = []
    for radius, number in zip(radii.tolist(), numbers.tolist(), strict=True):
        sides = [length if around else length - 2 * radius for length, around in zip(box, periodic, strict=True)]
        if min(sides) <= 0:
            return None
        room.append((radius, number, math.prod(sides)))
        single += number * math.log(math.prod(sides))
    for k, (radius, number, area) in enumerate(room):
        for second, second_number, second_area in room[k:]:
            count = number * (number - 1) / 2 if second == radius else number * second_number
            both = two_discs.configurations((radius, second), box, periodic)
            if count and both <= 0:
                return None
            pairs += count * math.log(both / (area * second_area)) if count else 0.0
    error = THIRD * pairs**2 / len(gas) if len(gas) > 2 else 0.0
    return Theory(single + pairs, error, "exact" if len(gas) <= 2 else "second virial coefficient")

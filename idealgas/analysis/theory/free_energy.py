"""Free energy of a few discs in a box: exact for one and two, by the second virial coefficient for more."""

import math

import numpy as np

from idealgas.analysis.theory import two_discs
from idealgas.analysis.theory.values import Theory
from idealgas.state import Gas

THIRD = 0.391
"""Half of B₃/B₂², the part of the third virial coefficient in the free energy: Tonks, Phys. Rev. 50, 955 (1936)."""


MOST_RADII = 32
"""Largest number of different radii; the integrals over pairs of them would take seconds from there on."""


def log_configurations(gas: Gas, box: tuple[float, float], periodic: tuple[bool, bool]) -> Theory | None:
    """Logarithm ln Q of the volume of all configurations of the discs of a gas in a box.

    None without room, or for more than MOST_RADII different radii.

    Pairs are exact, so that Q is exact for two discs; three and more at once are left out, which is the error.
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
        for other, others, its_area in room[k:]:
            count = number * (number - 1) / 2 if other == radius else number * others
            both = two_discs.configurations((radius, other), box, periodic)
            if count and both <= 0:
                return None
            pairs += count * math.log(both / (area * its_area)) if count else 0.0
    error = THIRD * pairs**2 / len(gas) if len(gas) > 2 else 0.0
    return Theory(single + pairs, error, "exact" if len(gas) <= 2 else "second virial coefficient")

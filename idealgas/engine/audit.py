"""What must hold, measured when all discs stand at one time."""

import math
from typing import NamedTuple

import numpy as np

from idealgas._jit import inline, njit
from idealgas.gas.state import Gas
from idealgas.physics.periodic import separation

U = np.uintp


class Audit(NamedTuple):
    """kinetic_energy: energy. momentum: (2,), mass * velocity.

    overlap: deepest overlap of two discs, in units of the sum of their radii, or 0. outside: how far any disc
    reaches beyond a side of the box, in units of its diameter, or 0.
    """

    kinetic_energy: float
    momentum: np.ndarray
    overlap: float
    outside: float


@inline
def overlap_of(a, b, periodic):
    """Depth to which two discs overlap, as a share of the sum of their radii; negative if they do not."""
    x, y = separation(a, b, periodic)
    return 1.0 - math.hypot(x, y) / (a.r + b.r)


@njit
def deepest_overlap_of_all(record, periodic):
    """The same over all pairs."""
    deepest = 0.0
    for i in range(record.shape[0]):
        for j in range(i):
            deepest = max(deepest, overlap_of(record[i], record[j], periodic))
    return deepest


def audit(gas: Gas, overlap: float) -> Audit:
    """The audit of a gas whose deepest overlap is known."""
    reach = np.maximum(gas.radius[:, None] - gas.position, gas.position + gas.radius[:, None] - np.array(gas.box))
    outside = float(max((reach / (2 * gas.radius[:, None])).max(), 0.0))
    momentum = (gas.mass[:, None] * gas.velocity).sum(axis=0)
    return Audit(gas.kinetic_energy, momentum, overlap, outside)

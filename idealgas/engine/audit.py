"""What must hold, measured when all discs stand at one time."""

import math
from typing import NamedTuple

import numpy as np

from idealgas._jit import borrowed, inline, njit
from idealgas.engine.cells import cell_index
from idealgas.gas import Gas

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
def overlap_of(a, b):
    """Depth to which two discs overlap, as a share of the sum of their radii; negative if they do not."""
    return 1.0 - math.hypot(a.x - b.x, a.y - b.y) / (a.r + b.r)


@njit
def deepest_overlap(record, cells):
    """Deepest overlap among records at one time that stand in their cells."""
    record, cells = borrowed((record, cells))
    deepest = 0.0
    for i in range(record.shape[0]):
        corner = cell_index(cells, record[U(i)]) - cells.columns - 1
        for place in range(9):
            j = cells.head[U(corner + place // 3 * cells.columns + place % 3)]
            while j >= 0:
                if j < i:
                    deepest = max(deepest, overlap_of(record[U(i)], record[U(j)]))
                j = cells.link[U(j)].next
    return deepest


@njit
def deepest_overlap_of_all(record):
    """The same over all pairs."""
    deepest = 0.0
    for i in range(record.shape[0]):
        for j in range(i):
            deepest = max(deepest, overlap_of(record[i], record[j]))
    return deepest


def audit(gas: Gas, overlap: float) -> Audit:
    """The audit of a gas whose deepest overlap is known."""
    reach = np.maximum(gas.radius[:, None] - gas.position, gas.position + gas.radius[:, None] - np.array(gas.box))
    outside = float(max((reach / (2 * gas.radius[:, None])).max(), 0.0))
    momentum = (gas.mass[:, None] * gas.velocity).sum(axis=0)
    return Audit(gas.kinetic_energy, momentum, overlap, outside)

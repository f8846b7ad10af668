"""Conserved quantities and overlaps of a gas, measured when all discs are at one time."""

import math
from typing import NamedTuple

import numpy as np

from idealgas.jit import inline, njit
from idealgas.physics.absorbing import has_left, inside
from idealgas.physics.periodic import separation
from idealgas.state import Gas

U = np.uintp


class Diagnostics(NamedTuple):
    """Conserved quantities and overlaps of a gas at one time.

    Attributes:
        kinetic_energy: sum over the discs, mass length²/time².
        momentum: (2,) f8, sum over the discs, mass length/time.
        overlap: deepest overlap of two discs, divided by the sum of their radii; 0 without any.
        outside: largest distance by which a disc reaches beyond a side that is not periodic, divided by its diameter;
            0 without any.
    """

    kinetic_energy: float
    momentum: np.ndarray
    overlap: float
    outside: float


@inline
def overlap_of(a, b, periodic):
    """Overlap of two discs divided by the sum of their radii; negative if they are apart."""
    x, y = separation(a, b, periodic)
    return 1.0 - math.hypot(x, y) / (a.r + b.r)


@njit
def deepest_overlap_of_all(record, periodic, absorbing):
    """Deepest overlap of all pairs of discs, divided by the sum of their radii; 0 without any."""
    deepest = 0.0
    for i in range(record.shape[0]):
        for j in range(0 if has_left(record[i], absorbing) else i):
            if not has_left(record[j], absorbing):
                deepest = max(deepest, overlap_of(record[i], record[j], periodic))
    return deepest


def check_invariants(
    gas: Gas, overlap: float, absorbing: np.ndarray | None, periodic: tuple[bool, bool]
) -> Diagnostics:
    """Measure a gas whose deepest overlap (divided by the sum of the radii) is known.

    periodic: whether the sides along x and along y are periodic, so that no disc can be beyond them.
    """
    here = inside(gas.position[:, 0], absorbing)
    radius, position = gas.radius[here], gas.position[here]
    reach = (
        np.maximum(radius - x, x + radius - side)
        for x, side, wraps in zip(position.T, gas.box, periodic, strict=True)
        if not wraps
    )
    outside = max((float((beyond / (2 * radius)).max(initial=0.0)) for beyond in reach), default=0.0)
    momentum = (gas.mass[:, None] * gas.velocity).sum(axis=0)
    return Diagnostics(gas.kinetic_energy, momentum, overlap, outside)

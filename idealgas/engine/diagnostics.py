"""Conserved quantities and overlaps of a gas whose discs are all at the same time."""

from typing import NamedTuple

import numpy as np

from idealgas.pairs import MARGIN, near_pairs
from idealgas.physics.absorbing import inside
from idealgas.physics.periodic import Periodic, separation
from idealgas.physics.shear import offset_at
from idealgas.state import Gas


class Diagnostics(NamedTuple):
    """Conserved quantities and overlaps of a gas at one time.

    Attributes:
        kinetic_energy: sum over the discs, mass length²/time².
        momentum: (2,) f8, sum over the discs, mass length/time.
        overlap: deepest overlap of two discs, divided by the sum of their radii; 0 if no discs overlap.
        outside: largest distance by which a disc protrudes beyond a side that is not periodic, divided by the diameter
            of the disc; 0 if no disc protrudes.
    """

    kinetic_energy: float
    momentum: np.ndarray
    overlap: float
    outside: float


class Points(NamedTuple):
    """Coordinates (n,) of discs, length, at a local time; the field names are those of a record."""

    x: np.ndarray
    y: np.ndarray
    t: float = 0.0


def deepest_overlap(gas: Gas, periodic: Periodic | None, absorbing: np.ndarray | None) -> float:
    """Return the deepest overlap of two discs, divided by the sum of their radii; 0 if no discs overlap.

    periodic: periodic sides; their shear must be in its state at the time of the gas, from which local times count.
    """
    present = inside(gas.position[:, 0], absorbing)
    position, radius, disc = gas.position[present], gas.radius[present], np.arange(len(gas))[present]
    period, deepest = (0.0, 0.0), 0.0
    if periodic is not None:
        period = (periodic.Lx * periodic.x, periodic.Ly * periodic.y)
        if periodic.shear is not None:  # discs near the bottom meet those near the top as images above the box
            low = position[:, 1] < 2 * (1 + MARGIN) * radius.max(initial=0.0)
            above = position[low] + (offset_at(periodic.shear, 0.0), periodic.shear.Ly)
            position, radius, disc = (
                np.concatenate(both) for both in ((position, above), (radius, radius[low]), (disc, disc[low]))
            )
    for i, k in near_pairs(position, radius, period):
        a, b = disc[i], disc[k]
        a, b = a[a != b], b[a != b]
        x, y = separation(Points(*gas.position[a].T), Points(*gas.position[b].T), periodic)
        overlap = 1.0 - np.hypot(x, y) / (gas.radius[a] + gas.radius[b])
        deepest = max(deepest, float(overlap.max(initial=0.0)))
    return deepest


def check_invariants(
    gas: Gas, overlap: float, absorbing: np.ndarray | None, periodic: tuple[bool, bool]
) -> Diagnostics:
    """Measure the conserved quantities of a gas, and how far discs protrude beyond the box.

    Args:
        gas: the gas.
        overlap: deepest overlap in the gas, divided by the sum of the radii; it is only passed on to the result.
        absorbing: see `inside`.
        periodic: whether the sides along x and along y are periodic, so that discs cannot protrude there.

    Returns:
        The conserved quantities, the overlap and the largest protrusion.
    """
    present = inside(gas.position[:, 0], absorbing)
    radius, position = gas.radius[present], gas.position[present]
    reach = (
        np.maximum(radius - x, x + radius - side)
        for x, side, wraps in zip(position.T, gas.box, periodic, strict=True)
        if not wraps
    )
    outside = max((float((beyond / (2 * radius)).max(initial=0.0)) for beyond in reach), default=0.0)
    momentum = (gas.mass[:, None] * gas.velocity).sum(axis=0)
    return Diagnostics(gas.kinetic_energy, momentum, overlap, outside)

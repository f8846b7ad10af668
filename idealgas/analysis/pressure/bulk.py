"""Momentum that flows through the bulk of a gas to its walls, which says how well the force on a wall is known."""

import numpy as np

from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.impacts import Impacts
from idealgas.analysis.core.samples import SampledImpacts
from idealgas.analysis.core.window import Window
from idealgas.gas.state import Gas
from idealgas.sides import OUTWARD, SIDES, axis_of


def momentum_in_bulk(
    gas: Gas, window: Window, moments: Moments | None, impacts: Impacts | SampledImpacts
) -> tuple[np.ndarray, np.ndarray]:
    """Flow of momentum with the discs, Σ m vx² and Σ m vy² (B, 2), and the force on each side by the bulk (4, B).

    That force is what the discs carry and what collisions pass on. `moments` belong to the sums over events, and are
    None beside those of samples.
    """
    if moments is not None and isinstance(impacts, Impacts):
        flights = window.of(moments.flights)[:, :, 1:3]
        first = np.unique(gas.species, return_index=True)[1]
        reach = np.array(gas.box) - 2 * gas.radius[first, None]
        carried = (flights / reach).sum(axis=1)
        return flights.sum(axis=1), _on_sides(carried) + window.of(impacts.passed_on).T
    assert isinstance(impacts, SampledImpacts)
    flow = window.of(impacts.kinetic_flow)[:, ::2]
    if np.ptp(gas.radius) == 0 and not impacts.dragged:
        reach = np.array(gas.box) - 2 * gas.radius[0]
        return flow, _on_sides((flow + window.of(impacts.collision_flow)[:, :3:2]) / reach)
    # where each disc was in the box when momentum was passed on is not in the samples: the walls speak for themselves
    push = window.of(impacts.impulse[:, : len(SIDES)]) * np.array(OUTWARD)
    return flow, push.sum(axis=2).T


def _on_sides(along: np.ndarray) -> np.ndarray:
    """Force (4, B) on each side of the box from that along x and y, (B, 2)."""
    return np.array([along[:, axis_of(k)] for k in range(len(SIDES))])

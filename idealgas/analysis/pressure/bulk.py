"""Momentum that flows through the bulk of a gas to its walls, which says how well the force on a wall is known."""

import numpy as np

from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.impacts import Impacts
from idealgas.analysis.core.samples import SampledImpacts
from idealgas.analysis.core.window import Window
from idealgas.gas.state import Gas
from idealgas.sides import SIDES, axis_of


def flow_in_events(gas: Gas, window: Window, moments: Moments, impacts: Impacts) -> tuple[np.ndarray, np.ndarray]:
    """Flow of momentum with the discs, Σ m vx² and Σ m vy² (B, 2), and the force on each side by the bulk (4, B).

    That force is what the discs carry and what collisions pass on.
    """
    flights = window.of(moments.flights)[:, :, 1:3]
    first = np.unique(gas.species, return_index=True)[1]
    reach = np.array(gas.box) - 2 * gas.radius[first, None]
    carried = (flights / reach).sum(axis=1)
    return flights.sum(axis=1), _on_sides(carried) + window.of(impacts.passed_on).T


def flow_in_samples(gas: Gas, window: Window, impacts: SampledImpacts) -> tuple[np.ndarray, np.ndarray | None]:
    """The same from sums in samples; no force for discs of several radii or walls that drag, where they do not tell it.

    It would take where in the box each disc was when momentum was passed on.
    """
    flow = window.of(impacts.kinetic_flow)[:, ::2]
    if np.ptp(gas.radius) > 0 or impacts.dragged:
        return flow, None
    reach = np.array(gas.box) - 2 * gas.radius[0]
    return flow, _on_sides((flow + window.of(impacts.collision_flow)[:, :3:2]) / reach)


def _on_sides(along: np.ndarray) -> np.ndarray:
    """Force (4, B) on each side of the box from that along x and y, (B, 2)."""
    return np.array([along[:, axis_of(k)] for k in range(len(SIDES))])

"""Momentum that flows through the bulk of a gas to its walls, which says how well the force on a wall is known."""

from typing import NamedTuple

import numpy as np

from idealgas.analysis.core.equilibration import Window
from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.impacts import Impacts
from idealgas.analysis.core.samples import SampledImpacts
from idealgas.columns import SIDES, axis_of
from idealgas.state import Gas


class Bulk(NamedTuple):
    """What the walls get by the bulk of a gas, in B blocks of time; None where it is not known.

    sides: (4, B), force on each side of the box, mass·length/time². virial: (B,), of all walls by Clausius's theorem,
    the kinetic energy and Σ r·Δp of all other events, energy.
    """

    sides: np.ndarray | None
    virial: np.ndarray | None


def bulk_in_events(gas: Gas, periodic: tuple[bool, bool], window: Window, moments: Moments, impacts: Impacts) -> Bulk:
    """What discs carry to the walls, and what collisions and the thermostat pass on."""
    flights = window.of(moments.flights)[:, :, 1:3]
    first = np.unique(gas.species, return_index=True)[1]
    carried = (flights / _reach(gas)[first]).sum(axis=1)
    virial = _across(flights.sum(axis=1), periodic) + window.of(impacts.inner_virial)
    return Bulk(_on_sides(carried) + window.of(impacts.passed_on).T, virial)


def bulk_in_samples(
    gas: Gas, periodic: tuple[bool, bool], window: Window, impacts: SampledImpacts, has_thermostat: bool
) -> Bulk:
    """The same from sums in samples, with the mean room of discs of several radii.

    Unknown for discs in a heat bath, and the force for walls that drag: it would take where each disc was then.
    """
    if has_thermostat:
        return Bulk(None, None)
    flow = window.of(impacts.kinetic_flow)[:, ::2]
    passed_on = window.of(impacts.collision_flow)[:, :3:2]
    virial = _across(flow, periodic) + window.of(impacts.inner_virial)
    return Bulk(None if impacts.dragged else _on_sides((flow + passed_on) * (1 / _reach(gas)).mean(axis=0)), virial)


def _reach(gas: Gas) -> np.ndarray:
    """Room (N, 2) along x and y that the centre of each disc has, length."""
    return np.asarray(np.array(gas.box) - 2 * gas.radius[:, None])


def _across(flow: np.ndarray, periodic: tuple[bool, bool]) -> np.ndarray:
    """Sum (B,) of a flow along x and y, (B, 2), over the axes that have walls."""
    return np.asarray(flow[:, ~np.array(periodic)].sum(axis=1))


def _on_sides(along: np.ndarray) -> np.ndarray:
    """Force (4, B) on each side of the box from that along x and y, (B, 2)."""
    return np.array([along[:, axis_of(k)] for k in range(len(SIDES))])

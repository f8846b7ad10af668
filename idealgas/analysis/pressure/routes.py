"""Pressure and Z of a uniform gas by each way of measuring.

Momentum flows through the bulk of the gas to its walls: the bulk says how well the force on a wall is known.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from idealgas.analysis.core.equilibration import Window
from idealgas.analysis.core.fields import OMITTED, Key
from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.impacts import Impacts
from idealgas.analysis.core.samples import SampledImpacts
from idealgas.analysis.core.statistics import Estimate, mean, mean_of_flux
from idealgas.analysis.theory.values import BoxTheory, Theory
from idealgas.columns import OUTWARD, SIDES, axis_of
from idealgas.state import Gas

WALLS, PAIRS = "walls, virial", "pairs, virial"
"""Beginnings of the names of the routes that `Pressure.check` compares with theory.

Where only one axis is periodic, the pressures along both differ, and names of the virials along one end in its name;
PAIRS alone is the mean of both.
"""


@dataclass(frozen=True)
class Route:
    """Pressure (energy/length²) and compressibility factor Z = PA/NT (no unit) by one way of measuring.

    source: which theory both have; None without one.
    """

    name: Annotated[str, Key("route")]
    pressure: Estimate
    compressibility_factor: Estimate
    source: Annotated[str | None, OMITTED] = None


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


def routes_of(
    gas: Gas,
    temperature: float,
    periodic: tuple[bool, bool],
    theory: BoxTheory,
    window: Window,
    bulk: Bulk,
    impacts: Impacts | SampledImpacts,
    tensor: dict[str, Estimate],
) -> tuple[Route, ...]:
    """Pressure by the momentum given to each wall, by the virial of all walls and by that of the pairs of discs."""
    ideal = len(gas) * temperature / gas.area
    sides = [k for k in range(len(SIDES)) if not periodic[axis_of(k)]]
    push = (window.of(impacts.impulse[:, : len(SIDES)]) * np.array(OUTWARD)).sum(axis=2).T
    through = push if bulk.sides is None else bulk.sides
    length = [gas.box[1 - axis_of(k)] for k in range(len(SIDES))]
    at_wall = {k: theory.sides[axis_of(k)] for k in sides}
    store = gas.mass.sum() * temperature / 3 / window.width**2
    routes = [
        _wall(f"{SIDES[k]} wall", push[k], through[k], length[k] * ideal, store, ideal, at_wall[k]) for k in sides
    ]
    if sides:
        perimeter = sum(length[k] for k in sides)
        at_walls = _average([(at_wall[k], length[k] / perimeter) for k in sides])
        pushed, carried = (series[sides].sum(axis=0) for series in (push, through))
        routes.append(_wall("all walls", pushed, carried, perimeter * ideal, len(sides) / 2 * store, ideal, at_walls))
        unit = len(sides) / 2 * gas.area * ideal
        virial = window.of(impacts.wall_virial)
        inner = virial if bulk.virial is None else bulk.virial
        reach = np.array(gas.box)[~np.array(periodic)] - 2 * gas.radius[:, None]
        moment = temperature * float((gas.mass[:, None] * reach**2).sum()) / 12 / window.width**2
        along = "xy"[axis_of(sides[0])] if any(periodic) else ""
        routes.append(_wall(f"{WALLS}, {along}" if along else WALLS, virial, inner, unit, moment, ideal, theory.walls))
        if along:
            source = theory.pairs.source if theory.pairs else None
            virials = {axis: tensor[2 * axis] for axis in "xy"}
            routes += [Route(f"{PAIRS}, {axis}", p, p.times(1 / ideal), source) for axis, p in virials.items()]
    z = mean(1 + window.of(impacts.pair_virial) / (2 * gas.area * ideal), theory.pairs)
    return (*routes, _of(PAIRS, z, ideal, theory.pairs))


def _wall(
    name: str, flux: np.ndarray, bulk: np.ndarray, unit: float, stored: float, ideal: float, theory: Theory | None
) -> Route:
    """Pressure by a momentum flux to walls (n,), in units of one of the `ideal` pressure, beside that of the bulk.

    stored: variance of the momentum that the gas stores on the way. Momenta of equilibrium are independent of each
    other and of places: it is the sum of m T over discs, times the mean square of the share of it that has reached a
    wall, which grows evenly from 0 at one wall to 1 at the other.
    """
    if not flux.any():  # the error of a wall that was never hit is unknown
        z = Estimate(0.0, math.nan, 0.0, *((theory.value, theory.error) if theory else ()))
    else:
        z = mean_of_flux(flux / unit, bulk / unit, theory, stored / unit**2)
    return _of(name, z, ideal, theory)


def _of(name: str, z: Estimate, ideal: float, theory: Theory | None) -> Route:
    """Route with Z and with the pressure, Z times that of the ideal gas."""
    return Route(name, z.times(ideal), z, theory.source if theory else None)


def _average(parts: Sequence[tuple[Theory | None, float]]) -> Theory | None:
    """Weighted mean of theories with a common error; None if one of them has no value."""
    known = [(theory, weight) for theory, weight in parts if theory]
    if not known or len(known) < len(parts):
        return None
    value, error = (sum(getattr(theory, name) * weight for theory, weight in known) for name in ("value", "error"))
    return Theory(value, error, known[0][0].source)


def _reach(gas: Gas) -> np.ndarray:
    """Room (N, 2) along x and y that the centre of each disc has, length."""
    return np.asarray(np.array(gas.box) - 2 * gas.radius[:, None])


def _across(flow: np.ndarray, periodic: tuple[bool, bool]) -> np.ndarray:
    """Sum (B,) of a flow along x and y, (B, 2), over the axes that have walls."""
    return np.asarray(flow[:, ~np.array(periodic)].sum(axis=1))


def _on_sides(along: np.ndarray) -> np.ndarray:
    """Force (4, B) on each side of the box from that along x and y, (B, 2)."""
    return np.array([along[:, axis_of(k)] for k in range(len(SIDES))])

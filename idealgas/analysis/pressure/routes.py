"""Pressure and Z of a uniform gas by each route.

Momentum flows through the bulk of the gas to its walls, so that the flux through the bulk determines the standard error
of the force on a wall.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from idealgas.columns import OUTWARD, SIDES, axis_of
from idealgas.fields import OMITTED, Key
from idealgas.state import Gas
from idealgas.statistics.estimates import Estimate, mean, mean_of_flux
from idealgas.tallies.equilibration import Window
from idealgas.tallies.flights import Moments
from idealgas.tallies.impacts import Impacts
from idealgas.tallies.samples import SampledImpacts
from idealgas.theory.values import BoxTheory, Theory

WALLS, PAIRS = "walls, virial", "pairs, virial"
"""Beginnings of the names of the routes that `Pressure.check` compares with theory.

If only one axis is periodic, the pressures along the two axes differ, and the name of a virial along one axis ends with
the name of the axis; PAIRS alone is the mean over both axes.
"""


@dataclass(frozen=True)
class PressureRoute:
    """Pressure (energy/length²) and compressibility factor Z = PA/NT (no unit) by one route.

    Attributes:
        name: name of the route.
        pressure: pressure.
        compressibility_factor: Z.
        source: name of the theory of both quantities; None if there is no theory.
    """

    name: Annotated[str, Key("route")]
    pressure: Estimate
    compressibility_factor: Estimate
    source: Annotated[str | None, OMITTED] = None


class Bulk(NamedTuple):
    """Momentum flux to the walls, calculated from the bulk of a gas, in B blocks of time; None if unknown.

    Attributes:
        sides: (4, B), force on each side of the box, mass·length/time².
        virial: (B,), virial of all walls according to Clausius' theorem, energy: the kinetic term plus Σ r·Δp per time
            of all events other than wall hits.
    """

    sides: np.ndarray | None
    virial: np.ndarray | None


def bulk_in_events(gas: Gas, periodic: tuple[bool, bool], window: Window, moments: Moments, impacts: Impacts) -> Bulk:
    """Return the flux of the momentum that discs carry to the walls and that collisions and the thermostat transfer."""
    flights = window.of(moments.flights)[:, :, 1:3]
    first = np.unique(gas.species, return_index=True)[1]
    carried = (flights / _reach(gas)[first]).sum(axis=1)
    virial = _across(flights.sum(axis=1), periodic) + window.of(impacts.inner_virial)
    return Bulk(_on_sides(carried) + window.of(impacts.passed_on).T, virial)


def bulk_in_samples(
    gas: Gas, periodic: tuple[bool, bool], window: Window, impacts: SampledImpacts, has_thermostat: bool
) -> Bulk:
    """Return the same fluxes from the sums in samples, using a mean over the discs if their radii differ.

    Neither flux is known for discs in a heat bath, and the force on the sides is not known if walls drag discs along:
    both would require the position of each disc at the time of the event.
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
) -> tuple[PressureRoute, ...]:
    """Return the pressure from the momentum given to each wall, the virial of all walls and the virial of the pairs."""
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
            routes += [PressureRoute(f"{PAIRS}, {axis}", p, p.times(1 / ideal), source) for axis, p in virials.items()]
    z = mean(1 + window.of(impacts.pair_virial) / (2 * gas.area * ideal), theory.pairs)
    return (*routes, _of(PAIRS, z, ideal, theory.pairs))


def _wall(
    name: str, flux: np.ndarray, bulk: np.ndarray, unit: float, stored: float, ideal: float, theory: Theory | None
) -> PressureRoute:
    """Return the pressure from a momentum flux to walls, with the error that follows from the flux through the bulk.

    Args:
        name: name of the route.
        flux: momentum flux in each block, (n,).
        bulk: momentum flux through the bulk in each block, (n,).
        unit: flux that corresponds to the pressure `ideal`.
        stored: variance of the momentum that is on its way to the walls. In equilibrium the momenta of the discs are
            independent of each other and of the positions. The variance is then the sum of m T over the discs, times
            the mean square of the fraction of a momentum that counts as having reached a wall; this fraction grows
            linearly from 0 at one wall to 1 at the other.
        ideal: pressure of the ideal gas, energy/length².
        theory: theory of Z.
    """
    if not flux.any():  # the error of a wall that was never hit is unknown
        z = Estimate(0.0, math.nan, 0.0, *((theory.value, theory.error) if theory else ()))
    else:
        z = mean_of_flux(flux / unit, bulk / unit, theory, stored / unit**2)
    return _of(name, z, ideal, theory)


def _of(name: str, z: Estimate, ideal: float, theory: Theory | None) -> PressureRoute:
    """Return the route with Z and with the pressure, which is Z times the pressure of the ideal gas."""
    return PressureRoute(name, z.times(ideal), z, theory.source if theory else None)


def _average(parts: Sequence[tuple[Theory | None, float]]) -> Theory | None:
    """Return the weighted mean of theories with fully correlated errors; None if one of them is not available."""
    known = [(theory, weight) for theory, weight in parts if theory]
    if not known or len(known) < len(parts):
        return None
    value, error = (sum(getattr(theory, name) * weight for theory, weight in known) for name in ("value", "error"))
    return Theory(value, error, known[0][0].source)


def _reach(gas: Gas) -> np.ndarray:
    """Return the lengths of the box along x and y that the centre of each disc can reach, (N, 2), length."""
    return np.asarray(np.array(gas.box) - 2 * gas.radius[:, None])


def _across(flow: np.ndarray, periodic: tuple[bool, bool]) -> np.ndarray:
    """Return the sum (B,) of a flux (B, 2), given along x and y, over the axes that have walls."""
    return np.asarray(flow[:, ~np.array(periodic)].sum(axis=1))


def _on_sides(along: np.ndarray) -> np.ndarray:
    """Return the force on each side of the box, (4, B), from the forces along x and y, (B, 2)."""
    return np.array([along[:, axis_of(k)] for k in range(len(SIDES))])

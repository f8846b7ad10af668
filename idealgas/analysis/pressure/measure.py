"""Pressure from the walls and from the virial, and the compressibility factor Z = PA/NT with its error bar.

Virial theorem of Clausius, in equilibrium over a time τ: 2E + Σ r_ij·Δp_ij/τ = -Σ r·Δp/τ, with pair collisions on the
left and wall hits on the right. Each side gives Z by its own events; they differ only by the change of Σ r·p between
the start and the end. The force per length of wall is larger than the pressure, as walls act on the centres of the
discs one radius inside the box.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from idealgas.analysis.core.chambers import Chambers
from idealgas.analysis.core.check import CheckResult, check_theory
from idealgas.analysis.core.collisions import (
    CollisionRate,
    FreePath,
    collision_rates,
    expected_rates,
    free_paths,
    theory_of,
)
from idealgas.analysis.core.currents import Currents, pressure_tensor
from idealgas.analysis.core.ensemble import becomes_uniform, known_ensemble, nonstationary_reason
from idealgas.analysis.core.equilibration import Window, measure, unsteady
from idealgas.analysis.core.fields import INLINE, OMITTED, Key, reported
from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.impacts import Impacts
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.samples import SampledImpacts, sampled
from idealgas.analysis.core.statistics import Estimate, mean, mean_of_flux
from idealgas.analysis.core.walls import SampledWalls, WallGauge, moving_wall
from idealgas.analysis.pressure.bulk import Bulk, bulk_in_events, bulk_in_samples
from idealgas.analysis.pressure.mechanical import Mechanical, mechanical
from idealgas.analysis.theory import hard_discs
from idealgas.analysis.theory.ensemble import Composition, composition
from idealgas.analysis.theory.values import (
    FREEZING,
    MIXTURE,
    SOLID,
    BoxTheory,
    NoTheoryError,
    Theory,
    crystal,
    fluid,
    mixture_error,
)
from idealgas.columns import OUTWARD, SIDES, axis_of
from idealgas.errors import NotApplicableError, UserError, unknown
from idealgas.log import Log
from idealgas.scene.walls import walls_inside
from idealgas.state import Gas

WALLS, PAIRS = "walls, virial", "pairs, virial"
"""Beginnings of the names of the routes that `Pressure.check` compares with theory.

Where only one axis is periodic, the pressures along both differ, and names of the virials along one end in its name;
PAIRS alone is the mean of both.
"""

IDEAL = "ideal gas"
"""Name of its theory, Z = 1."""


@dataclass(frozen=True)
class Route:
    """Pressure (energy/length²) and compressibility factor Z = PA/NT (no unit) by one way of measuring.

    source: which theory both have; None without one.
    """

    name: Annotated[str, Key("route")]
    pressure: Estimate
    compressibility_factor: Estimate
    source: Annotated[str | None, OMITTED] = None


@dataclass(frozen=True)
class Pressure(Result):
    """Pressure of one log by every route, with theory, collision rates and free paths from the same events.

    window: the time that was used. number: of discs. area: of the box, length². temperature: energy (k_B = 1).
    packing_fraction: no unit. routes: pressure and Z by each way of measuring. known_theories: Z by the name of
    each theory that applies. collision_rates: of each pair of species. free_paths: of each species; empty without
    events. tensor: components xx, yy and xy of the pressure tensor, energy/length².
    no_theory: why there is no theory of this gas in its box, as part of a sentence; None if there is.
    mechanical: pressure of every wall of a gas without an equation of state; None for others. For such a gas area
    is what it has on average, temperature the mean of m v²/2 over discs and time, and there are no routes,
    theories, rates and paths.
    """

    window: Window
    number: int
    area: float
    temperature: float
    packing_fraction: float
    routes: tuple[Route, ...]
    known_theories: Annotated[dict[str, Theory], OMITTED]
    collision_rates: tuple[CollisionRate, ...]
    free_paths: tuple[FreePath, ...]
    tensor: Annotated[dict[str, Estimate], Key("pressure_tensor")]
    no_theory: str | None = None
    mechanical: Annotated[Mechanical | None, INLINE] = None

    @property
    @reported
    def theories(self) -> dict[str, float]:
        """Z by the name of each theory that applies."""
        return {name: theory.value for name, theory in self.known_theories.items()}

    @property
    @reported
    def theory_errors(self) -> dict[str, float]:
        """Standard deviation of the error of Z by the name of each theory."""
        return {name: theory.error for name, theory in self.known_theories.items()}

    def route(self, name: str) -> Route:
        """Pressure by one way of measuring.

        Raises:
            UserError: if the gas has no such route, with the reason if it has none at all.
        """
        if not self.routes:
            raise UserError(self.no_theory or "")
        names = [route.name for route in self.routes]
        if name not in names:
            raise unknown("route", name, names)
        return self.routes[names.index(name)]

    def check(self) -> CheckResult:
        """Check that Z by the virial of the walls and of the pairs agrees with theory.

        Raises:
            UserError: if a route with a theory has no error bar.
        """
        virials = (route for route in self.routes if route.name.startswith((WALLS, PAIRS)))
        return check_theory(((r.name, r.source, r.compressibility_factor) for r in virials), self.no_theory)


def pressure(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Pressure:
    """Measure the pressure of a gas between two times of its log, and compare Z = PA/NT with theory.

    The routes: momentum given to each wall per time and length, and by Clausius's virial theorem that given to all
    walls and that passed on in collisions of discs. Theory is that of hard discs in this box, see `hard_disc_theories`;
    collision rates and free paths come from the same events. Without events the sums of `log.pressure = true` give the
    same from sample to sample, but no free paths.

    Where the virial theorem needs further terms, or no temperature is known, there is no such Z: with gravity, wall
    segments, a piston, collisions that lose energy or walls of two temperatures. The result then has the mechanical
    pressure of every wall, the momentum that it gets per time and length.

    start, end: times; by default from detected equilibrium to the end of the log. progress(done, in all) is called as
    events are read.

    Raises UserError if no disc moves, or if there are no events or too few samples in the window.
    """
    if not log.has_positions:
        raise NotApplicableError(f"{log.path}: discs without positions have no pressure")
    equilibrium = known_ensemble(log)
    if equilibrium is None or not becomes_uniform(log, start):
        return _without_theory(log, start, end, progress)
    if not equilibrium.temperature > 0:
        raise UserError(f"{log.path}: no disc moves")
    gas, discs = log.discs, composition(log.discs)
    theory = theory_of(log)
    expected = expected_rates(gas.box, equilibrium, theory)
    impacts: Impacts | SampledImpacts
    if log.has_events:
        moments, events, currents = Moments(), Impacts(len(log.walls), log.periodic), Currents(log.periodic)
        window, impacts = measure(log, [moments, events, currents], start, end, progress), events
        flow = currents.flow
        paths = free_paths(discs, expected, equilibrium, window, moments, events)
        bulk = bulk_in_events(gas, log.periodic, window, moments, events)
    else:
        window, samples = sampled(log, start, end, ())
        impacts, paths, flow = samples, (), samples.flow
        bulk = bulk_in_samples(gas, log.periodic, window, samples, log.scene.properties.thermostat_rate > 0)
    tensor = pressure_tensor(log, equilibrium, theory, window.of(flow))
    return Pressure(
        window=window,
        number=len(gas),
        area=gas.area,
        temperature=equilibrium.temperature,
        packing_fraction=gas.packing_fraction,
        routes=_routes(gas, equilibrium.temperature, log.periodic, theory, window, bulk, impacts, tensor),
        known_theories=hard_disc_theories(equilibrium.discs, gas, theory),
        collision_rates=collision_rates(discs, expected, window, impacts),
        free_paths=paths,
        tensor=tensor,
        no_theory=theory.why_not or None,
        caveats=_slow(gas, window, impacts),
    )


def _slow(gas: Gas, window: Window, impacts: Impacts | SampledImpacts) -> tuple[str, ...]:
    """Sentences on a dense gas, which changes slowly or is ordered."""
    if gas.packing_fraction <= hard_discs.HIGHEST:
        return ()
    ordered = "Discs this dense order, and a run may keep one arrangement of them: the errors are those of that one."
    drifting = unsteady("The virial of the pairs", window.of(impacts.pair_virial), window.edges[window.first : -1])
    return (ordered,) * (gas.packing_fraction >= FREEZING) + drifting


def _without_theory(
    log: Log, start: float | None, end: float | None, progress: Callable[[int, int], None] | None
) -> Pressure:
    """Mechanical pressure of a gas without an equation of state; one that never settles is averaged from its start."""
    gas = log.discs
    if start is None and nonstationary_reason(log):
        start = log.start_time
    if log.has_events:
        gauge, moments = WallGauge(log), Moments(log.gravity)
        window = measure(log, [moments, *gauge.tallies], start, end, progress)
        energies = window.of(moments.flights)[:, :, 1:3].sum(axis=(1, 2))
    elif (moving := moving_wall(log)) and not moving.both:
        raise UserError(f"{log.path}: has no events, and samples do not follow a piston closely enough")
    else:
        window, impacts = sampled(log, start, end, ())
        gauge = WallGauge(log, SampledWalls(log, impacts))
        energies = window.of(impacts.kinetic_flow)[:, :3:2].sum(axis=1)
    found = mechanical(log, gauge, window)
    causes = log.scene.lacking("uniform", "conserves_energy")
    return Pressure(
        window=window,
        number=len(gas),
        area=found.area,
        temperature=float(energies.mean()) / (2 * len(gas)),
        packing_fraction=gas.packing_fraction * gas.area / found.area,
        routes=(),
        known_theories={},
        collision_rates=(),
        free_paths=(),
        tensor={},
        no_theory=f"no equation of state holds under {', '.join(causes) or 'several temperatures'}",
        mechanical=found,
        caveats=(*_ends(log), *_chambers(log, window)),
    )


def _ends(log: Log) -> tuple[str, ...]:
    """Sentence on faces of walls inside the box, where no events tell the ends of a wall from its faces."""
    if log.has_events or not walls_inside(log.scene):
        return ()
    return ("Without events the pressure on a face has also what discs give to the ends of its wall.",)


def _chambers(log: Log, window: Window) -> tuple[str, ...]:
    """Sentence for each wall inside with gas on both its sides at sides of the box: a mean over chambers."""
    found, chambers = [], Chambers(log, window.end)
    for wall in walls_inside(log.scene):
        places = [(wall.start[axis_of(k)], wall.end[axis_of(k)]) for k in range(len(SIDES))]
        meets = [k for k, ends in enumerate(places) if log.box[axis_of(k)] * (k % 2) in ends]
        met = [SIDES[k] for k in meets if chambers.divided_gas(k, wall.start[1 - axis_of(k)])]
        absent = any(opens <= window.start < window.end <= closes for opens, closes in wall.absences)
        if met and not absent and not wall.radius:
            found.append(
                f"{wall.name} meets the {' and the '.join(met)} wall: the pressure there is a mean over both its sides."
            )
    if chambers.area < log.discs.area:
        found.append(f"Lengths of sides and A = {chambers.area:g} are those of the chambers with gas, until they open.")
    return tuple(found)


def hard_disc_theories(discs: Composition, gas: Gas, in_box: BoxTheory) -> dict[str, Theory]:
    """Compressibility factor Z at the packing fraction of a gas, by the name of each theory that applies to it."""
    phi = gas.packing_fraction
    theories = {IDEAL: Theory(1.0, 0.0, IDEAL)}
    if in_box.pairs:
        theories[in_box.pairs.source] = in_box.pairs
    if phi >= SOLID and np.ptp(discs.radius) == 0:
        solid = crystal(phi)
        return theories | {solid.source: solid}
    try:
        series = fluid(phi)
    except NoTheoryError:
        return theories
    if np.ptp(discs.radius) > 0:
        z = hard_discs.mixture_compressibility_factor(discs.radius, discs.number, gas.area)
        error = mixture_error(phi, hard_discs.likeness(discs.radius, discs.number))
        return theories | {MIXTURE: Theory(z, error * (z - 1), MIXTURE)}
    others = {
        "virial series to B10": float(hard_discs.virial_series(phi)),
        "Henderson 1975": float(hard_discs.henderson_compressibility_factor(phi)),
    }
    endless = {name: Theory(z, math.hypot(z - series.value, series.error), name) for name, z in others.items()}
    return theories | {series.source: series} | endless


def _routes(
    gas: Gas,
    temperature: float,
    periodic: tuple[bool, bool],
    theory: BoxTheory,
    window: Window,
    bulk: Bulk,
    impacts: Impacts | SampledImpacts,
    tensor: dict[str, Estimate],
) -> tuple[Route, ...]:
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
    if not flux.any():  # walls that were never hit tell nothing of their error
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

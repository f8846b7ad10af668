"""Pressure from the walls and from the virial, and the compressibility factor Z = PA/NT with its standard error.

By Clausius' virial theorem, 2E + Σ r_ij·Δp_ij/τ = -Σ r·Δp/τ in equilibrium over a time τ, where the sums run over the
pair collisions on the left and over the wall hits on the right. Either side alone gives Z, from different events; the
two values differ only by the change in Σ r·p between the start and the end. The force per length on a wall is larger
than the pressure, because walls act on the centres of the discs, one radius inside the box.
"""

import math
from collections.abc import Callable

import numpy as np

from idealgas.analysis.pressure.mechanical import mechanical
from idealgas.analysis.pressure.result import Pressure
from idealgas.analysis.pressure.routes import bulk_in_events, bulk_in_samples, routes_of
from idealgas.columns import SIDES, axis_of
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import Log
from idealgas.scene.walls import walls_inside
from idealgas.state import Gas
from idealgas.tallies.chambers import Chambers, outward
from idealgas.tallies.collisions import collision_rates, expected_rates, free_paths, theory_of
from idealgas.tallies.currents import Currents, pressure_tensor
from idealgas.tallies.equilibration import Window, measure, unsteady
from idealgas.tallies.equilibrium import becomes_uniform, known_ensemble, nonstationary_reason
from idealgas.tallies.flights import Moments
from idealgas.tallies.impacts import Impacts
from idealgas.tallies.samples import SampledImpacts, sampled
from idealgas.tallies.walls import SampledWalls, WallGauge
from idealgas.theory import hard_discs
from idealgas.theory.ensemble import Composition, composition
from idealgas.theory.values import (
    FREEZING,
    IDEAL,
    MIXTURE,
    SOLID,
    BoxTheory,
    NoTheoryError,
    Theory,
    crystal,
    fluid,
    mixture_error,
)


def pressure(
    log: Log, start: float | None = None, end: float | None = None, progress: Callable[[int, int], None] | None = None
) -> Pressure:
    """Measure the pressure of a gas between two times of its log, and compare Z = PA/NT with theory.

    The first route is the momentum that each wall receives per time and length. The other routes follow from Clausius'
    virial theorem: one uses the momentum given to all walls, the other the momentum transferred in collisions between
    discs. The theory is that of hard discs in this box, see `hard_disc_theories`. Collision rates and free paths are
    measured from the same events. A log without events must contain the sums of `log.pressure = true`, which give the
    same quantities except for the free paths.

    Z is not defined if the virial theorem has further terms or if the temperature is not known: with gravity, wall
    segments, a piston, collisions that lose energy or walls of two temperatures. The result then contains the
    mechanical pressure on every wall, which is the momentum that the wall receives per time and length.

    Raises:
        UserError: if discs have no positions, if no disc moves, or if there are no events or too few samples in the
            window.
    """
    if not log.has_positions:
        raise NotApplicableError(f"{log.path}: the pressure requires discs with positions")
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
        interacting = log.scene.properties.interacting
        paths = free_paths(discs, expected, equilibrium, window, moments, events) if interacting else ()
        bulk = bulk_in_events(gas, log.periodic, window, moments, events)
    else:
        window, samples = sampled(log, start, end, ())
        impacts, paths, flow = samples, (), samples.flow
        bulk = bulk_in_samples(gas, log.periodic, window, samples, log.scene.properties.thermostat_rate > 0)
    tensor = pressure_tensor(log, equilibrium, theory, window.of(flow))
    theories = hard_disc_theories(equilibrium.discs, gas, theory)
    return Pressure(
        window=window,
        number=len(gas),
        area=gas.area,
        temperature=equilibrium.temperature,
        packing_fraction=gas.packing_fraction,
        routes=routes_of(gas, equilibrium.temperature, log.periodic, theory, window, bulk, impacts, tensor),
        theories={name: z.value for name, z in theories.items()},
        theory_errors={name: z.error for name, z in theories.items()},
        collision_rates=collision_rates(discs, expected, window, impacts),
        free_paths=paths,
        tensor=tensor,
        no_theory=theory.reason or None,
        caveats=_slow(gas, window, impacts),
    )


def _slow(gas: Gas, window: Window, impacts: Impacts | SampledImpacts) -> tuple[str, ...]:
    """Return caveats for a dense gas, which changes slowly or may be ordered."""
    if gas.packing_fraction <= hard_discs.HIGHEST:
        return ()
    ordered = "At this density discs may order and keep a single arrangement, to which the standard errors then apply."
    drifting = unsteady("The virial of the pairs", window.of(impacts.pair_virial), window.edges[window.first : -1])
    return (ordered,) * (gas.packing_fraction >= FREEZING) + drifting


def _without_theory(
    log: Log, start: float | None, end: float | None, progress: Callable[[int, int], None] | None
) -> Pressure:
    """Return the mechanical pressure of a gas without an equation of state.

    If the gas never becomes stationary and no start is given, the average starts at the beginning of the log.
    """
    gas = log.discs
    if start is None and nonstationary_reason(log):
        start = log.start_time
    if log.has_events:
        gauge, moments = WallGauge(log), Moments(log.gravity)
        window = measure(log, [moments, *gauge.tallies], start, end, progress)
        energies = window.of(moments.flights)[:, :, 1:3].sum(axis=(1, 2))
    elif any(outward(log, piston) for piston in log.scene.piston):
        raise UserError(f"{log.path}: has no events, and samples do not follow a piston closely enough")
    else:
        window, impacts = sampled(log, start, end, ())
        gauge = WallGauge(log, SampledWalls(log, impacts))
        energies = window.of(impacts.kinetic_flow)[:, :3:2].sum(axis=1)
    area = float(gauge.area(window.edges)[window.first :].mean())
    causes = log.scene.lacking("uniform", "conserves_energy")
    return Pressure(
        window=window,
        number=len(gas),
        area=area,
        temperature=float(energies.mean()) / (2 * len(gas)),
        packing_fraction=gas.packing_fraction * gas.area / area,
        routes=(),
        theories={},
        theory_errors={},
        collision_rates=(),
        free_paths=(),
        tensor={},
        no_theory=f"no equation of state holds under {', '.join(causes) or 'several temperatures'}",
        mechanical=mechanical(log, gauge, window),
        caveats=(*_ends(log), *_chambers(log, window)),
    )


def _ends(log: Log) -> tuple[str, ...]:
    """Return a caveat if there are walls inside the box but no events to distinguish their ends from their faces."""
    if log.has_events or not walls_inside(log.scene):
        return ()
    return ("Without events the pressure on a face includes the momentum that discs give to the ends of its wall.",)


def _chambers(log: Log, window: Window) -> tuple[str, ...]:
    """Return caveats on inner walls that meet a side of the box, with gas on both sides, and on empty chambers."""
    sentences, chambers = [], Chambers(log, window.end)
    for wall in walls_inside(log.scene):
        places = [(wall.start[axis_of(k)], wall.end[axis_of(k)]) for k in range(len(SIDES))]
        meets = [k for k, ends in enumerate(places) if log.box[axis_of(k)] * (k % 2) in ends]
        met = [SIDES[k] for k in meets if chambers.divided_gas(k, wall.start[1 - axis_of(k)])]
        absent = any(opens <= window.start < window.end <= closes for opens, closes in wall.absences)
        if met and not absent and not wall.radius:
            sentences.append(
                f"{wall.name} meets the {' and the '.join(met)} wall: the pressure there is a mean over the gas on "
                f"both sides of {wall.name}."
            )
    if chambers.area < log.discs.area:
        sentences.append(
            f"The lengths of sides and A = {chambers.area:g} are those of the chambers with gas, until these open."
        )
    return tuple(sentences)


def hard_disc_theories(discs: Composition, gas: Gas, in_box: BoxTheory) -> dict[str, Theory]:
    """Return Z at the packing fraction of a gas according to each theory that applies, by the name of the theory."""
    phi = gas.packing_fraction
    theories = {IDEAL: Theory(1.0, 0.0, IDEAL)}
    if in_box.pairs:
        theories[in_box.pairs.source] = in_box.pairs
        if in_box.pairs.source == IDEAL:
            return theories
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
    equations = {
        "virial series to B10": float(hard_discs.virial_series(phi)),
        "Henderson 1975": float(hard_discs.henderson_compressibility_factor(phi)),
    }
    infinite = {name: Theory(z, math.hypot(z - series.value, series.error), name) for name, z in equations.items()}
    return theories | {series.source: series} | infinite

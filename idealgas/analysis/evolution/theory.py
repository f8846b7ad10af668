"""Theory of the temperature of a gas over time, of the positions of pistons, and of the discs beyond a wall."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from idealgas.fields import OMITTED
from idealgas.log import Log
from idealgas.scene.walls import walls_inside
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.chambers import beside_pistons, outward
from idealgas.tallies.equilibrium import becomes_uniform, column_temperature, known_ensemble
from idealgas.theory import granular, hard_discs
from idealgas.theory.adiabatic_piston import relaxation
from idealgas.theory.conserved import centre_of_mass_velocity, degrees_of_freedom
from idealgas.theory.ensemble import composition

SLOW = 0.05
"""Largest speed of a piston, relative to the mean speed of the discs, at which the adiabat is accurate."""

FEW = 5
"""Number of discs below which theory does not predict how discs and a piston share the energy."""

DILUTE = 0.1
"""Largest packing fraction at which one compressibility factor is used for both gases beside an inner piston."""

EQUAL = 3
"""Largest difference between two pressures, in standard deviations, at which a piston counts as in equilibrium.

The piston vibrates between two gases that it compresses without heat exchange. As the mean potential energy of this
vibration is T/2, the variance of the pressure difference is 2 (1/N₁ + 1/N₂) P².
"""

STEPS = 128
"""Number of steps in the numerical integration of the adiabat."""

REST_ERROR = 0.12
"""Relative error of the predicted mean length of a gas below a piston, multiplied by the number of discs N.

In 30 runs, the mean length was larger than predicted by 1.1 % for 10 discs, and by 0.15 % for 50 discs at φ = 0.5.
"""


@dataclass(frozen=True)
class EvolutionLaw:
    """Theoretical prediction for a gas at F times.

    Attributes:
        text: name of the law.
        temperature: (F,), mean of m v²/2 over the discs, energy.
        spin: mean of I ω² over the discs, energy; None without prediction.
        piston: mean coordinate of the piston in equilibrium, length; None without prediction.
        pressure: external pressure on the piston, energy/length²; None without external pressure.
        caveats: sentences about conditions of the law that are not met or not checked.
        piston_error: error of `piston`, length.
        chambers: (F,), mean of m v²/2 over the discs on each side of an inner piston, energy, by name as in
            `beside_pistons`.
        steady: whether the law describes an equilibrium that the gas approaches.
        area: (F,), area of a gas that a piston compresses without heat exchange, length²; None for other laws.
    """

    text: str
    temperature: np.ndarray
    spin: float | None = None
    piston: float | None = None
    pressure: Annotated[float | None, OMITTED] = None
    caveats: Annotated[tuple[str, ...], OMITTED] = ()
    piston_error: Annotated[float, OMITTED] = 0.0
    chambers: Annotated[dict[str, np.ndarray], OMITTED] = field(default_factory=dict)
    steady: Annotated[bool, OMITTED] = False
    area: Annotated[np.ndarray | None, OMITTED] = None


@dataclass(frozen=True)
class StateLines:
    """Isotherm and adiabat of a gas below a piston, through its initial state.

    Attributes:
        area: (L,), areas of the gas, length².
        isotherm: (L,), pressure on the piston at constant temperature, energy/length².
        adiabat: (L,), pressure on the piston without heat exchange, energy/length²; None if heat is exchanged or discs
            spin.
    """

    area: np.ndarray
    isotherm: np.ndarray
    adiabat: np.ndarray | None


def expected_law(
    log: Log, time: np.ndarray, apart: Mapping[str, np.ndarray] | None = None, start: float = 0.0
) -> EvolutionLaw | None:
    """Return the theoretical prediction for a gas at times (F,); None if no simple theory applies to the scene.

    Args:
        log: log of the gas.
        time: (F,), times.
        apart: (F,), mean kinetic energy per disc on each side of an inner piston, energy, by name.
        start: coordinate of the piston at the first time, length; used for inner pistons only.
    """
    properties, ones = log.scene.properties, np.ones(len(time))
    discs = composition(log.discs)
    single = len(log.scene.lacking("uniform", "conserves_motion")) == 1  # no other effects change the kinetic energy
    alone = (
        properties.interacting
        and len(discs.name) == 1
        and not log.discs.unlike
        and discs.radius[0] > 0
        and log.discs.packing_fraction <= hard_discs.HIGHEST
    )
    if single and alone and not properties.elastic and log.has_positions:
        return _haff(log, time)
    if len(log.scene.piston) > 1:
        return None
    piston = next(iter(log.scene.piston), None)
    if piston and piston.inner and (piston.mass or not outward(log, piston)):
        known = piston.mass and single and not log.discs.unlike
        return _adiabatic_piston(log, time, apart or {}, start) if known else None
    if single and alone and not properties.fixed_walls:
        if piston is None or (piston.mass and properties.varies):
            return None
        return _at_rest(log, ones) if piston.mass else _adiabat(log, time)
    if properties.later_accelerations or properties.escapes:
        return None
    if any(log.gravity):
        axis = int(log.gravity[1] != 0)
        t = None if not properties.empty or log.gravity[1 - axis] else column_temperature(log, axis)
        return (
            None if t is None else EvolutionLaw(f"in equilibrium T = {t:.6g} at all heights", t * ones, t, steady=True)
        )
    if log.discs.unlike or (equilibrium := known_ensemble(log)) is None:
        return None
    t = equilibrium.temperature
    kinetic = float(discs.number @ equilibrium.of_species / discs.number.sum())
    return EvolutionLaw(f"in equilibrium T = {t:.6g} for each degree of freedom", kinetic * ones, t, steady=True)


def _haff(log: Log, time: np.ndarray) -> EvolutionLaw | None:
    """Return Haff's law T = T₀/(1 + t/τ)², where τ = 4/((1 - e²) Γ (1 + 3a₂/16)) (`granular.cooling_time`).

    Here e is the restitution coefficient, Γ the collision rate of a disc at the start from Enskog theory, and a₂ the
    fourth cumulant of the velocities. If momentum is conserved, the motion of the centre of mass does not contribute to
    the temperature.
    """
    gas, table, kinetic = log.discs, log.scene.restitution, _kinetic(log)
    if table is None or not log.scene.properties.constant_restitution or not gas.kinetic_energy > 0:
        return None
    if table.wall < 1 or table.normal < granular.TESTED_FROM:
        return None
    n, share = len(gas), degrees_of_freedom(log.scene, log.discs) / (2 * len(gas))
    contacts = hard_discs.box_contacts(gas.radius[:1], [n], gas.box, log.periodic)[0, 0]
    rate = float(contacts) * hard_discs.mean_relative_speed(kinetic / (n * share), gas.mass[0])
    tau = share * granular.cooling_time(granular.GranularParameters(table.normal), rate)
    caveat = "Haff's law assumes a uniform gas; `idealgas cooling` checks this."
    return EvolutionLaw(
        f"Haff: T = T₀/(1 + t/τ)², τ = {tau:.4g}", kinetic / n / (1 + time / tau) ** 2, caveats=(caveat,)
    )


def _kinetic(log: Log) -> float:
    """Return the initial kinetic energy, without that of the centre of mass along axes with conserved momentum."""
    gas = log.discs
    return float(
        (gas.mass * ((gas.velocity - centre_of_mass_velocity(log.scene, log.discs)) ** 2).sum(axis=1)).sum() / 2
    )


def _track(log: Log) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the times of the samples, and the coordinates and velocities of the only piston at these times."""
    time, place = log.observables["piston_position"]
    return time, place[:, 0], log.observables["piston_velocity"][1][:, 0]


def room(log: Log, place: np.ndarray) -> np.ndarray:
    """Return the length (P,) of the gas along the axis of the only piston, from coordinates (P,) of the piston."""
    (table,) = log.scene.piston
    return place if outward(log, table) >= 0 else log.box[table.axis] - place


def piston_force(log: Log, length: float) -> float:
    """Return the force on a piston at rest, divided by N T, 1/length.

    For a gas of length L it is Z/(L - 2R), because the centres of the discs remain one radius away from both ends.
    """
    gas, size = log.discs, list(log.box)
    size[log.scene.piston[0].axis] = length
    z = hard_discs.box_compressibility_factor(gas.radius[:1], [len(gas)], (size[0], size[1]), log.periodic)
    return z / (length - 2 * float(gas.radius[0]))


def state_lines(log: Log, areas: np.ndarray) -> StateLines | None:
    """Return the isotherm and adiabat through the initial state of a gas below a piston, over the range of its areas.

    The result is None if theory is not available: for several species or pistons, above the freezing density, or if the
    gas is not uniform.
    """
    gas, lacking = log.discs, log.scene.lacking("uniform", "straight_flight", "elastic", "interacting")
    if len(log.scene.piston) != 1 or len(lacking) > 1 or len(gas.species_names) > 1 or gas.unlike:
        return None
    if not gas.radius[0] > 0:
        return None
    across = log.box[1 - log.scene.piston[0].axis]
    first = float(room(log, _track(log)[1][:1])[0])
    lengths = np.linspace(min(areas.min() / across, first), max(areas.max() / across, first), STEPS + 1)
    if is_crowded(log, lengths[0]):
        return None
    temperature = _kinetic(log) / len(gas)
    pressure = np.array([piston_force(log, length) for length in lengths]) * len(gas) * temperature / across
    adiabat = None
    if len(log.scene.lacking("uniform", "conserves_motion")) == 1:
        adiabat = pressure * np.exp(work_integral(log, lengths, first) - work_integral(log, lengths, lengths))
    return StateLines(lengths * across, pressure, adiabat)


def is_crowded(log: Log, length: float) -> bool:
    """Return whether a gas of the given length below the piston is too dense for a fluid."""
    gas, across = log.discs, log.box[1 - log.scene.piston[0].axis]
    return bool(gas.packing_fraction * gas.area > hard_discs.HIGHEST * length * across)


def work_integral(log: Log, grid: np.ndarray, lengths: np.ndarray | float) -> np.ndarray:
    """Return the work ∫ F dL of a gas on a piston, divided by N T, from the length grid[0] to other lengths.

    Args:
        log: log with a single piston.
        grid: (G,), ascending lengths at which the integral is evaluated.
        lengths: lengths at which the integral ends.
    """
    slope = np.array([piston_force(log, length) for length in (grid[1:] + grid[:-1]) / 2])
    return np.interp(lengths, grid, np.append(0.0, np.cumsum(slope * np.diff(grid))))


def _adiabat(log: Log, time: np.ndarray) -> EvolutionLaw | None:
    """Return the adiabat d ln T = -F dL/NT, which holds if the piston moves slowly compared with the discs.

    The result is None if the gas does not remain a fluid.
    """
    at, places, speeds = _track(log)
    lengths = room(log, np.interp(time, at, places))
    first = float(room(log, places[:1])[0])
    grid = np.linspace(min(lengths.min(), first), max(lengths.max(), first), STEPS + 1)
    if is_crowded(log, grid[0]):
        return None
    exponent = work_integral(log, grid, first) - work_integral(log, grid, lengths)
    fastest = float(np.abs(speeds).max())
    at_first = _kinetic(log) / len(log.discs)
    share = fastest / hard_discs.mean_speed(at_first, float(log.discs.mass[0]))
    caveat = (
        f"The piston moves at up to {share:.2g} of the mean speed of the discs, but the adiabat assumes a slow piston."
    )
    text = "slow piston: T A = const, for discs d ln T = -Z d ln A"
    area = lengths * log.box[1 - log.scene.piston[0].axis]
    return EvolutionLaw(text, at_first * np.exp(exponent), caveats=(caveat,) if share > SLOW else (), area=area)


def _at_rest(log: Log, ones: np.ndarray) -> EvolutionLaw | None:
    """Return the mean position of a piston of finite mass and the temperature in equilibrium.

    They follow from the total energy N T + T/2 + P L X, whose terms are the energies of the discs, of the motion of the
    piston and of its position X; L is the length of the piston. At fixed energy E, the probability of a position is
    proportional to X^N (E - P L X)^(N - 1/2) in a dilute gas, and the mean position is returned. The result is None for
    few discs, or if the piston rests on its end stop.
    """
    (table,), (_, places, speeds) = log.scene.piston, _track(log)
    if not table.pressure or len(log.discs) < FEW:
        return None
    n, diameter = len(log.discs), 2 * float(log.discs.radius[0])
    force = table.pressure * log.box[1 - table.axis]
    start = float(room(log, places[:1])[0])
    speed = float(speeds[0])
    energy = _kinetic(log) + (table.mass or 0.0) * speed**2 / 2 + force * (start - diameter)
    length, t = start, 0.0
    for _ in range(100):
        z = piston_force(log, length) * (length - diameter)
        t = energy / (n + 0.5 + n * z + 1)
        length = diameter + (n * z + 1) * t / force
    piston = length if table.outward > 0 else log.box[table.axis] - length
    if is_crowded(log, length) or table.outward * piston >= table.outward * table.stop(log.box):
        return None
    text = f"in equilibrium P A = N T Z, T = {t:.6g}, piston at {piston:.6g}"
    return EvolutionLaw(text, t * ones, None, piston, table.pressure, piston_error=REST_ERROR / n * length, steady=True)


def _adiabatic_piston(log: Log, time: np.ndarray, apart: Mapping[str, np.ndarray], start: float) -> EvolutionLaw | None:
    """Return the equilibrium of an inner piston of finite mass with two gases, and the relaxation of both gases.

    In equilibrium, the probability of a position X between dilute gases of N₁ and N₂ discs is proportional to
    X^N₁ (L - X)^N₂. Once the pressures are equal, the temperatures follow `adiabatic_piston.relaxation`. If the initial
    pressures differ, theory does not predict the temperatures at which they become equal.
    """
    (table,), gas = log.scene.piston, log.discs
    if len(apart) < 2 or not log.scene.properties.interacting or not gas.radius[0] > 0 or gas.packing_fraction > DILUTE:
        return None
    n, diameter = len(gas), 2 * float(gas.radius[0])
    number = np.array([members.sum() for members in beside_pistons(log).values()])
    length = log.box[table.axis] - 2 * diameter
    speed = float(_track(log)[2][0])
    t = (_kinetic(log) + table.mass * speed**2 / 2) / (n + 0.5)
    rest = diameter + length * float(number[0] + 1) / (n + 2)
    text = f"in equilibrium T = {t:.6g} on both sides, piston at {rest:.6g}"
    law = EvolutionLaw(text, t * np.ones(len(time)), piston=rest, piston_error=REST_ERROR / n * length, steady=True)
    first = np.array([series[0] for series in apart.values()])
    pressure = number * first / [start - diameter, length - (start - diameter)]
    if abs(pressure[0] - pressure[1]) > EQUAL * pressure.mean() * math.sqrt(2 * (1 / number).sum()):
        return law
    z = hard_discs.box_compressibility_factor(gas.radius[:1], [n], gas.box, log.periodic)
    temperatures = relaxation(first, number, float(gas.mass[0]), table.mass, z, length, time - time[0])
    return replace(law, chambers=dict(zip(apart, temperatures, strict=True)))


def first_passable(log: Log) -> tuple[int, float] | None:
    """Return the axis normal to the first straight gate or permeable wall along an axis, and its coordinate.

    The result is None if there is no such wall.
    """
    walls = (wall for wall in walls_inside(log.scene) if wall.is_passable and wall.is_straight)
    return next(((k, wall.start[k]) for wall in walls for k in range(2) if wall.start[k] == wall.end[k]), None)


def equilibrium_spread(log: Log, end: float) -> dict[str, Estimate]:
    """Return the equilibrium fraction of the discs of each species beyond a wall.

    The wall is that of `first_passable`. The result is empty if there is no such wall, or if the discs do not become
    uniformly distributed over both sides by the time `end`.
    """
    wall, gas = first_passable(log), log.discs
    if wall is None or gas.unlike or known_ensemble(log) is None or not becomes_uniform(log, end):
        return {}
    axis, place = wall
    reach = gas.radius[np.unique(gas.species, return_index=True)[1]] * (not log.periodic[axis])
    share = (log.box[axis] - reach - place) / (log.box[axis] - 2 * reach)
    error = np.sqrt(share * (1 - share) / np.bincount(gas.species))
    both = zip(gas.species_names, share.tolist(), error.tolist(), strict=True)
    return {name: Estimate(value, spread, math.inf) for name, value, spread in both}

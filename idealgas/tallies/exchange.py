"""Times in which heat, discs and energy are exchanged across a gas or through inner pistons, from kinetic theory.

Differences between parts of a gas decay as slowly as its longest wave, and two states of the gas are independent only
if this decay lies between them. A log that is only a few such times long does not show how much a profile or a
temperature fluctuates.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from idealgas.log import Log
from idealgas.statistics.estimates import Estimate
from idealgas.theory import adiabatic_piston, hard_discs, waves
from idealgas.theory.conserved import are_fixed, centre_of_mass_energy
from idealgas.theory.ensemble import classes

INDEPENDENT = 42.0
"""Smallest length of a window, in times of the slowest exchange, for standard errors to be right to within 10 %."""


class Exchange(NamedTuple):
    """A slow exchange within a gas.

    Attributes:
        time: time after which states are independent, at least twice the correlation time; 0 if there is no exchange.
        process: description of the process in words.
    """

    time: float
    process: str


NOTHING = Exchange(0.0, "")
"""Value that stands for no slow exchange."""


def across(log: Log, axis: int) -> Exchange:
    """Return the slowest exchange of heat or, in a mixture, of discs across the box along an axis.

    Its time is L²/2D, in which the rms displacement due to diffusion reaches the length L. D is the thermal diffusivity
    or the diffusion coefficient from Enskog theory, and L is the distance between the walls or half the length of a
    periodic box; either is half the wavelength of the longest wave. This wave has a correlation time L²/π²D and
    contributes to densities and temperatures in strips, most of all beside walls, where its amplitude is largest:
    standard errors there have the fewest degrees of freedom. It is assumed that a mixture conducts heat like equal
    discs at its packing fraction and mean mass. Its diffusion coefficient is that of its slowest discs.
    """
    gas, temperature = log.discs, _temperature(log)
    moving = ~are_fixed(gas.mass) & log.scene.properties.interacting
    if not temperature > 0 or not gas.packing_fraction > 0 or not gas.radius[moving].any():
        return NOTHING
    fraction = min(gas.packing_fraction, hard_discs.HIGHEST)
    diameter = 2 * math.sqrt(fraction * gas.area / (math.pi * float(moving.sum())))
    fluid = waves.sound_of_discs(fraction, temperature, float(gas.mass[moving].mean()), diameter)
    slowest, carried = fluid.spreading, "heat crosses"
    discs = classes(gas)
    if len(discs.name) > 1:
        rate = hard_discs.mixture_collision_rate(discs.radius, discs.mass, discs.number, gas.area, temperature)
        friction = (2 * discs.mass / (discs.mass[:, None] + discs.mass) * rate).sum(axis=1)
        diffusion = (temperature / (discs.mass * friction))[~are_fixed(discs.mass)].min()
        if diffusion < slowest:
            slowest, carried = float(diffusion), "discs diffuse across"
    length = log.box[axis] / (2 if log.periodic[axis] else 1)
    return Exchange(length**2 / (2 * slowest), f"{carried} the box along {'xy'[axis]}")


def through_pistons(log: Log) -> Exchange:
    """Return the slowest exchange of energy between gases through inner pistons of finite mass."""
    if (gases := _gases_in_a_row(log)) is None:
        return NOTHING
    rate = adiabatic_piston.slowest_rate(gases.conductance, gases.capacity)
    return Exchange(2 / rate, "energy crosses the inner pistons") if rate > 0 else NOTHING


def with_pistons(estimate: Estimate, log: Log, discs: np.ndarray, duration: float) -> Estimate:
    """Return the mean temperature of a part of a gas, with an error that includes the exchange through pistons.

    If the window is shorter than INDEPENDENT times the time of the exchange, the error is at least its theoretical
    value. The temperatures of gases at a common pressure and a fixed total energy have variances T² (1/C - 1/ΣC), where
    C is the heat capacity of each gas at constant pressure, and they are correlated over the time of the exchange.

    Args:
        estimate: mean over a window, with an error from the fluctuations in the window, energy.
        log: log of the gas.
        discs: (N,), whether each disc belongs to the part.
        duration: duration of the window, time.
    """
    time, gases = through_pistons(log).time, _gases_in_a_row(log)
    if gases is None or not log.scene.properties.isolated or duration >= INDEPENDENT * time:
        return estimate
    held = gases.capacity > 0
    share = np.bincount(gases.chamber[discs], minlength=len(held))[held] / np.count_nonzero(discs)
    capacity, memory = gases.capacity[held], time / 2 / duration
    variance = max(float((share**2 / capacity).sum() - 1 / capacity.sum()), 0.0) * gases.temperature**2
    error = math.sqrt(variance * 2 * memory * (1 + memory * math.expm1(-1 / memory)))
    if error <= estimate.standard_error:
        return estimate
    return replace(estimate, standard_error=error, independent_samples=math.inf, blocks=())


class _Gases(NamedTuple):
    """Gases in a row, separated by pistons.

    Attributes:
        chamber: (N,), number of the gas to which each disc belongs.
        conductance: (K,), conductance of each piston, 1/time.
        capacity: (K + 1,), heat capacities of the gases at constant pressure.
        temperature: mean temperature of all discs, energy.
    """

    chamber: np.ndarray
    conductance: np.ndarray
    capacity: np.ndarray
    temperature: float


def _gases_in_a_row(log: Log) -> _Gases | None:
    """Return the gases that inner pistons of finite mass separate; None without such pistons or if no disc moves."""
    pistons, temperature = log.scene.piston, _temperature(log)
    inner = [k for k, piston in enumerate(pistons) if piston.inner and piston.mass]
    if not inner or not temperature > 0:
        return None
    gas, axis = log.discs, pistons[inner[0]].axis
    places = log.observables["piston_position"][1].mean(axis=0)
    ends = [0.0, log.box[axis]]
    for piston, place in zip(pistons, places.tolist(), strict=True):
        if not piston.inner and piston.axis == axis:
            ends[int(piston.outward > 0)] = place
    cuts = np.array([ends[0], *places[inner], ends[1]])
    chamber = np.searchsorted([pistons[k].start(log.box) for k in inner], gas.position[:, axis])
    number, solid = (np.bincount(chamber, weight, len(cuts) - 1) for weight in (None, math.pi * gas.radius**2))
    fraction = np.clip(solid / (np.diff(cuts) * log.box[1 - axis]), 0.0, hard_discs.HIGHEST)
    z = hard_discs.compressibility_factor(fraction)
    force = (z * temperature / np.diff(cuts))[chamber]  # for each disc
    conductance = np.zeros(len(inner))
    for k, piston in enumerate(inner):
        each = adiabatic_piston.conductance(temperature, temperature, force, gas.mass, pistons[piston].mass or 0.0)
        low, high = np.bincount(chamber, each, len(cuts) - 1)[k : k + 2]
        conductance[k] = low * high / (low + high)
    return _Gases(chamber, conductance, number * (1 + z), temperature)


def _temperature(log: Log) -> float:
    """Return the mean kinetic energy of a disc that is not fixed, averaged over the whole log, energy."""
    moving = int((~are_fixed(log.discs.mass)).sum())
    energies = log.observables["kinetic_energy"][1]
    return float(energies.mean() - centre_of_mass_energy(log.scene, log.discs)) / moving if len(energies) else 0.0

"""Conserved quantities of a gas, and its equilibrium: whether it comes to one, and how discs share the energy there."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import special

from idealgas.analysis.core.statistics import mean
from idealgas.analysis.theory import conserved
from idealgas.analysis.theory.barometric import barometric_temperature
from idealgas.errors import NotApplicableError
from idealgas.log import Log
from idealgas.state import Gas


class Composition(NamedTuple):
    """Names, radii (length), masses (mass) and numbers of discs of the S species of a gas.

    name: S names. radius, mass, number: arrays of shape (S,), one entry for each species.
    """

    name: tuple[str, ...]
    radius: np.ndarray
    mass: np.ndarray
    number: np.ndarray

    def packing_fraction(self, density: np.ndarray) -> float:
        """Packing fraction φ of a gas whose species have the number densities `density` (S,), in 1/length²."""
        return float(np.pi * (density * self.radius**2).sum())


def composition(gas: Gas) -> Composition:
    """Composition of a gas; all discs of one species have the same radius and the same mass."""
    _, first, number = np.unique(gas.species, return_index=True, return_counts=True)
    return Composition(gas.species_names, gas.radius[first], gas.mass[first], number)


UNLIKELY = 1e-5
"""Probability that a gas in equilibrium is refused because of its mean temperatures."""

FAR = 2.0
"""Largest deviation of a mean temperature from its theory, in standard deviations of the temperature at an instant.

Beyond it, energy is exchanged more slowly than the log is long, and error bars from the log are too small.
"""

ROUNDING = 1e-9
"""Relative change below which a quantity is constant."""


@dataclass(frozen=True)
class Ensemble:
    """Ensemble of a gas in equilibrium: at fixed energy (and momentum, if conserved), or in a heat bath.

    centre_of_mass_velocity: (2,), subtracted from all velocities, length/time; 0 along axes of no conserved momentum.
    dof: number D of degrees of freedom of translation and spin that share the energy; infinite in a heat bath.
    temperature: T = 2E/D, energy (k_B = 1).
    of_axes: (S, 2), mean m vx² and m vy² of a disc of each species, energy. It is T where this component of momentum is
    not conserved, and T(1 - m/M) for a disc of mass m where it is, with the mass M of all discs.
    """

    centre_of_mass_velocity: np.ndarray
    dof: float
    temperature: float
    of_axes: np.ndarray

    @property
    def of_species(self) -> np.ndarray:
        """Mean kinetic energy of translation (S,) of a disc of each species, energy."""
        return self.of_axes.mean(axis=1)


def conserved_momentum(log: Log) -> np.ndarray:
    """Whether the total momentum of the discs is conserved along x and along y: (2,) bool; see `conserved`."""
    return conserved.conserved_momentum(log.scene)


def centre_of_mass_velocity(log: Log) -> np.ndarray:
    """Velocity (2,) of the centre of mass, length/time; 0 along axes where momentum is not conserved."""
    return conserved.centre_of_mass_velocity(log.scene, log.discs)


def centre_of_mass_energy(log: Log) -> float:
    """Kinetic energy of the motion of the whole gas that is conserved, energy."""
    return conserved.centre_of_mass_energy(log.scene, log.discs)


def degrees_of_freedom(log: Log) -> int:
    """Number D of directions of motion of all discs, without those of a momentum that is conserved."""
    return 2 * len(log.discs) - int(conserved_momentum(log).sum())


def ensemble(log: Log) -> Ensemble:
    """Ensemble of the gas of a log.

    Raises:
        UserError: if the effects of the scene leave the temperature in equilibrium unknown.
    """
    found = known_ensemble(log)
    if found is None:
        causes = log.scene.lacking("conserves_energy") or log.scene.lacking("isolated")
        given = f"under {', '.join(causes)}" if causes else "for a single disc, which shares it with no other"
        raise NotApplicableError(f"{log.path}: no temperature is known beforehand {given}")
    return found


def known_ensemble(log: Log) -> Ensemble | None:
    """Ensemble of the gas of a log; None if the energy is neither conserved nor set by heat of one temperature.

    None too for a single disc whose momentum is conserved, as none of its energy is heat, or whose spin has some of it.
    """
    properties, gas, mass = log.scene.properties, log.discs, composition(log.discs).mass
    if not properties.conserves_energy or len(properties.temperatures) > 1:
        return None
    kept, frame = conserved_momentum(log), centre_of_mass_velocity(log)
    dof = 2 * len(gas) - int(kept.sum())
    energy = float((gas.mass * ((gas.velocity - frame) ** 2).sum(axis=1)).sum())  # twice
    if log.inertia is not None:
        dof += len(gas)
        spin = log.state_at(log.start_time).angular_velocity
        energy += 0.0 if spin is None else float((log.inertia * spin**2).sum())
    if dof == 0 or (len(gas) == 1 and properties.isolated and log.inertia is not None):
        return None
    share = 1 - kept * mass[:, None] / gas.mass.sum()
    if properties.temperatures:  # a heat bath has no limit to its energy
        (temperature,) = properties.temperatures
        return Ensemble(frame, math.inf, temperature, temperature * share)
    temperature = energy / dof
    return Ensemble(frame, dof, temperature, temperature * share)


def column_temperature(log: Log, axis: int, discs: Composition) -> float | None:
    """Equilibrium temperature (energy, k_B = 1) of a gas under gravity along `axis`, 0 for x or 1 for y.

    It is the temperature of thermal walls or a thermostat or, without them, the one at which a dilute gas has the
    conserved energy of the start: kinetic energy, spin and height in the barometric distribution. None if other effects
    leave it unknown, and for a single disc, which cannot share its energy.
    """
    properties, gas = log.scene.properties, log.discs
    if not properties.fixed_walls or not properties.lossless or log.periodic[1 - axis] or len(gas) == 1:
        return None
    if baths := properties.temperatures:
        return min(baths) if len(baths) == 1 else None
    g = log.gravity[axis]
    start = log.state_at(log.start_time)
    freedom, energy = 2.0 * len(gas), gas.kinetic_energy
    if log.inertia is not None and start.angular_velocity is not None:
        energy += float(log.inertia @ start.angular_velocity**2) / 2
        freedom += len(gas)
    above = start.position[:, axis] if g < 0 else log.box[axis] - start.position[:, axis]
    energy += abs(g) * float(gas.mass @ (above - gas.radius))
    height = log.box[axis] - 2 * discs.radius
    return barometric_temperature(energy, freedom, discs.mass, discs.number, abs(g), height)


def nonstationary_reason(log: Log) -> str:
    """Why a gas never comes to a stationary state, as part of a sentence; empty if nothing is known to prevent it.

    Such a gas is driven by a moving wall, or loses energy that no wall gives back.
    """
    scene, properties = log.scene, log.scene.properties
    if properties.driven:
        return f"the gas is driven ({', '.join(scene.lacking('fixed_walls'))})"
    if not properties.lossless and properties.isolated:
        return f"the gas loses energy ({', '.join(scene.lacking('lossless'))})"
    return ""


def nonequilibrium_reason(log: Log) -> str:
    """Why a gas never comes to equilibrium, as part of a sentence; empty if nothing is known to prevent it."""
    if why := nonstationary_reason(log):
        return why
    scene, properties = log.scene, log.scene.properties
    if len(properties.temperatures) > 1:
        sources = "walls" if properties.bath is None else "walls and heat bath"
        return f"{sources} have {len(properties.temperatures)} temperatures"
    if not properties.lossless:
        return f"the gas loses energy ({', '.join(scene.lacking('lossless'))})"
    return ""


def equipartition_violation(log: Log, energies: np.ndarray) -> str:
    """Why the energy of a gas is not shared as in equilibrium, as part of a sentence; empty if it may be.

    energies: (B, S, 2), sums of m vx² and of m vy² over the discs of each species in blocks of time, energy; or
    (B, 1, 2), over all discs. Velocities are relative to the gas as a whole where nothing stops that.
    """
    ensemble, gas = known_ensemble(log), composition(log.discs)
    if ensemble is None or not conserved.is_ergodic(log.scene, log.discs):
        return ""
    if len(log.discs) == 1 and ensemble.dof < math.inf:  # it has no other to share with
        return ""
    number = gas.number[:, None]
    expected, names = number * ensemble.of_axes, [f" of {name}" for name in gas.name]
    if energies.shape[1] == 1:
        expected, number, names = expected.sum(axis=0, keepdims=True), number.sum(keepdims=True), [""]
    for s, name in enumerate(names):
        for axis, letter in enumerate("xy"):
            theory = float(expected[s, axis] / number[s, 0])
            found = mean(energies[:, s, axis] / number[s], theory)
            dof, deviation = max(found.independent_samples - 1, 1.0), abs(found.deviation or 0.0)
            far = FAR * theory * math.sqrt(2.0 / number[s, 0]) + ROUNDING * ensemble.temperature
            if abs(found.value - theory) > far or special.stdtr(dof, -deviation) < UNLIKELY / 2:
                return f"m v{letter}²{name} is {found.value:.4g} on average, and {theory:.4g} in equilibrium"
    return ""


def must_apply(log: Log, start: float | None, needs: Sequence[str]) -> None:
    """Refuse a log whose scene lacks a needed property, or, without a given start, whose gas never becomes stationary.

    Raises:
        NotApplicableError: in both cases.
    """
    if strange := log.scene.lacking(*needs):
        raise NotApplicableError(f"{log.path}: this analysis has no answer for a gas with {', '.join(strange)}")
    if start is None and (why := nonstationary_reason(log)):
        raise not_steady(log, why)


def must_be_shared(log: Log, energies: np.ndarray) -> None:
    """Refuse a log whose gas looks steady but does not have the temperatures of equilibrium.

    energies: see `equipartition_violation`.
    """
    if why := equipartition_violation(log, energies):
        raise not_steady(log, why)


def kind_of_state(log: Log) -> str:
    """State that a gas reaches: "equilibrium", or "steady state" if energy flows through it."""
    return "steady state" if nonequilibrium_reason(log) else "equilibrium"


def not_steady(log: Log, why: str) -> NotApplicableError:
    """Error for a gas that does not reach its state, with the commands that apply; why: part of a sentence."""
    state = "equilibrium" if nonstationary_reason(log) else kind_of_state(log)
    return NotApplicableError(
        f"{log.path}: no {state}, as {why}: `idealgas evolution` follows it in time; --from T sets a start by hand"
    )

"""Theoretical distributions of velocities, energies and free flights, and the reasons why they may not apply."""

from dataclasses import dataclass

import numpy as np

from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.tallies.collisions import expected_rates, theory_of
from idealgas.tallies.equilibrium import known_ensemble, nonequilibrium_reason
from idealgas.theory import distributions
from idealgas.theory.conserved import KEPT, centre_of_mass_energy
from idealgas.theory.ensemble import Composition, Ensemble, ensemble_at
from idealgas.theory.hard_discs import mean_speed

MAXWELL = "Maxwell-Boltzmann"

FEWEST_DOF = 3
"""Number of degrees of freedom up to which the law of velocities at fixed energy has an unbounded density."""

FEW = 30
"""Number of discs below which free flights and waiting times deviate from the laws for many discs."""

RECOLLISIONS = 0.011
"""Largest error of the distribution function of free flights of many discs, due to recollisions.

For equal discs with φ = 0.02 to 0.6, the error is largest at φ = 0.2: 0.0105(10) for 1000 discs in a periodic box.
"""

FINITE_NUMBER = 0.16
"""Largest error of the distribution functions of free flights and waiting times, multiplied by the number of discs.

For the waiting times of 30 discs the error is 0.0046(5). For the free times, it is larger by 0.002 with 64 discs than
with 1000.
"""

DENSEST_COUNTS = 0.5
"""Packing fraction up to which numbers of collisions are compared with theory; in denser gases, discs are caged."""


def count_errors(log: Log) -> tuple[float, float, float]:
    """Return the errors of the law of a dilute gas for the number of collisions in ten mean free times.

    The three errors are the largest error of the distribution function, and the errors of the second and third
    cumulants over the mean. In denser gases, collisions are more regular. With 1000 discs at φ = 0.003, 0.03, 0.1, 0.2,
    0.3 and 0.5, the distribution function deviates by 0.003, 0.004, 0.010, 0.014, 0.017 and 0.011, and the measured
    variance over the mean is smaller than predicted by 0.004(7), 0.035(6), 0.064(7), 0.111(6), 0.122(9) and 0.043(8).
    With 100 discs at φ = 0.03 and 0.1, it is smaller by 0.079(8) and 0.150(7).
    """
    phi, number = log.discs.packing_fraction * log.has_positions, len(log.discs)
    return 0.1 * phi + 1 / number, 0.8 * phi + 5 / number, phi + 10 / number


@dataclass(frozen=True)
class Expectation:
    """What is known about a gas before the events in its log are read.

    Attributes:
        ensemble: ensemble at the known temperature; None if the temperature must be measured, or if no law applies.
        scale: temperature that sets the range of histograms, energy.
        reason: why no law applies, as part of a sentence; empty if a law applies.
    """

    ensemble: Ensemble | None
    scale: float
    reason: str

    @property
    def needs_temperature(self) -> bool:
        """Whether a law applies, but at a temperature that must be measured."""
        return not self.reason and self.ensemble is None


def expectation(log: Log, start: float | None, end: float | None) -> Expectation:
    """Return what is known about a gas between two times of its log before the events are read.

    Raises:
        UserError: if no disc moves.
    """
    ensemble = known_ensemble(log)
    if ensemble:
        if not ensemble.temperature > 0:
            raise UserError(f"{log.path}: no disc moves")
        if ensemble.dof <= FEWEST_DOF:
            few = f"{ensemble.dof} degrees of freedom are too few"
            return Expectation(None, ensemble.temperature, few)
        return Expectation(ensemble, ensemble.temperature, "" if log.scene.properties.shares_energy else KEPT)
    reason = nonequilibrium_reason(log)
    if len(log.discs) == 1 and not reason:
        reason = "a single disc cannot share its energy"
    scale, baths = _highest(log, start, end), log.scene.properties.temperatures
    if reason or not baths:
        return Expectation(None, scale, reason)
    return Expectation(ensemble_at(log.scene, log.discs, min(baths), np.inf), scale, "")


def _highest(log: Log, start: float | None, end: float | None) -> float:
    """Return the highest kinetic energy per disc between two times, in the frame of the centre of mass."""
    time, kinetic = log.observables["kinetic_energy"]
    first, last = log.start_time if start is None else start, log.end_time if end is None else end
    inside = (time >= first) & (time <= last)
    highest = (float(kinetic[inside].max(initial=0.0)) - centre_of_mass_energy(log.scene, log.discs)) / len(log.discs)
    highest = max(highest, log.discs.temperature) if not inside.any() else highest
    if not highest > 0:
        raise UserError(f"{log.path}: no disc moves")
    return highest


def velocity_laws(
    quantity: str, known: Expectation, species: int, measured: Ensemble | None
) -> dict[str, distributions.Law]:
    """Return the laws for a velocity quantity of one species, by name.

    They are the Maxwell-Boltzmann distribution and, for a gas at fixed energy, the distribution at that energy.

    Args:
        quantity: name of the quantity.
        known: what is known about the gas.
        species: index of the species.
        measured: ensemble at the measured temperature; None if the temperature was not measured.
    """
    ensemble = known.ensemble or measured
    if known.reason or ensemble is None or not ensemble.of_axes[species].any():  # no law applies to fixed discs
        return {}
    if known.ensemble is None:
        return {f"{MAXWELL}, measured T": ensemble.velocity_law(quantity, species)}
    laws = {MAXWELL: ensemble.velocity_law(quantity, species, np.inf)}
    if (dof := ensemble.dof) < np.inf:
        laws[f"fixed energy ({dof} degrees of freedom)"] = ensemble.velocity_law(quantity, species)
    return laws


def free_flight_rates(
    log: Log, discs: Composition, start: float | None, end: float | None
) -> tuple[float, np.ndarray, np.ndarray, np.ndarray, str]:
    """Return the collision rates that determine the free flights of K kinds of discs in S species.

    If no law applies, the rates and speeds are means over the gas that only set the range of the histogram.

    Returns:
        temperature: temperature, energy.
        rates: (K, K), collision rates between the kinds, 1/time.
        errors: (K, K), relative errors of the rates.
        speeds: (S,), mean speeds, length/time.
        reason: why no law applies, as part of a sentence; empty if a law applies.

    Raises:
        UserError: if no disc moves, or if there are too few collisions.
    """
    known = expectation(log, start, end)
    reason = known.reason
    if uneven := log.scene.lacking("uniform"):
        reason = reason or f"the gas is not uniform ({', '.join(uneven)})"
    if log.scene.properties.thermostat_rate:
        reason = reason or "a heat bath changes velocities during flights"
    if known.ensemble and known.ensemble.dof < 2 * FEW:
        reason = reason or f"theory assumes many discs, but this gas has only {len(log.discs)}"
    if known.ensemble and not reason:
        gas = known.ensemble
        theory = theory_of(log) if log.has_positions else None
        rates, errors = expected_rates(log.box, gas, theory).of_kinds
        if (rates.sum(axis=1) > 0).all():
            return gas.temperature, rates, errors, gas.mean_speed, ""
        reason = theory.reason if theory and theory.reason else "discs do not collide"
    time, collisions = log.observables["disc_collisions"]
    if not len(time) or not (collisions[-1] > collisions[0] and time[-1] > time[0]):
        raise UserError(f"{log.path}: too few collisions between discs for a distribution")
    rate = float(collisions[-1] - collisions[0]) / float(time[-1] - time[0]) / len(log.discs)
    speed = discs.shares @ mean_speed(known.scale, discs.mass)
    rates = np.diag(np.full(len(discs.name), rate))
    return known.scale, rates, 0 * rates, speed, reason

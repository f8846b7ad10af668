"""Laws of velocities, energies and free flights, and the reasons for which a gas has none."""

from dataclasses import dataclass

import numpy as np

from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.tallies.collisions import expected_rates, theory_of
from idealgas.tallies.equilibrium import known_ensemble, nonequilibrium_reason
from idealgas.theory import distributions
from idealgas.theory.conserved import centre_of_mass_energy
from idealgas.theory.ensemble import Composition, Ensemble, ensemble_at
from idealgas.theory.hard_discs import mean_speed

MAXWELL = "Maxwell-Boltzmann"

FEWEST_DOF = 3
"""Largest number of degrees of freedom at which the velocity density of a gas of fixed energy is unbounded."""

FEW = 30
"""Number of discs below which free paths and waiting times deviate from the law of many discs."""

RECOLLISIONS = 0.011
"""Largest error of the distribution function of free flights in many discs, where two discs may soon collide again.

Among equal discs at φ = 0.02 to 0.6, it is largest at φ = 0.2: 0.0105(10) with 1000 discs in a periodic box.
"""

FINITE_NUMBER = 0.16
"""Largest error of the distribution functions of free flights and waiting times times the number of discs.

The waiting times of 30 discs are off by 0.0046(5), and the free times of 64 discs by 0.002 more than those of 1000.
"""

DENSEST_COUNTS = 0.5
"""Packing fraction up to which the law of the number of collisions is tested; in denser gases discs are caged."""


def count_errors(log: Log) -> tuple[float, float, float]:
    """Return the errors of the dilute law of the number of collisions in ten mean free times.

    The three errors are that of the distribution function (its largest value) and those of the second and third
    cumulant over the mean. In denser gases collisions are more regular. With 1000 discs at φ = 0.003, 0.03, 0.1, 0.2,
    0.3 and 0.5 the distribution function is off by 0.003, 0.004, 0.010, 0.014, 0.017 and 0.011, and the variance is too
    small by 0.004(7), 0.035(6), 0.064(7), 0.111(6), 0.122(9) and 0.043(8). With 100 discs at φ = 0.03 and 0.1 the
    variance is too small by 0.079(8) and 0.150(7).
    """
    phi, number = log.discs.packing_fraction * log.has_positions, len(log.discs)
    return 0.1 * phi + 1 / number, 0.8 * phi + 5 / number, phi + 10 / number


@dataclass(frozen=True)
class Expectation:
    """What is known of a gas before the events of its log are read.

    Attributes:
        ensemble: ensemble of a gas of known temperature; None if the temperature must be measured, or if no law holds.
        scale: temperature that sets the range of histograms, energy.
        reason: why no law holds, as part of a sentence; empty if one does.
    """

    ensemble: Ensemble | None
    scale: float
    reason: str

    @property
    def needs_temperature(self) -> bool:
        """Whether a law holds at a temperature that must be measured."""
        return not self.reason and self.ensemble is None


def expectation(log: Log, start: float | None, end: float | None) -> Expectation:
    """Return what is known of the gas of a log between two times before its events are read.

    Raises:
        UserError: if no disc moves.
    """
    ensemble = known_ensemble(log)
    if ensemble:
        if not ensemble.temperature > 0:
            raise UserError(f"{log.path}: no disc moves")
        if ensemble.dof <= FEWEST_DOF:
            few = f"{ensemble.dof} degrees of freedom are too few for a law"
            return Expectation(None, ensemble.temperature, few)
        return Expectation(ensemble, ensemble.temperature, "")
    reason = nonequilibrium_reason(log)
    if len(log.discs) == 1 and not reason:
        reason = "a single disc cannot share its energy"
    scale, baths = _highest(log, start, end), log.scene.properties.temperatures
    if reason or not baths:
        return Expectation(None, scale, reason)
    return Expectation(ensemble_at(log.scene, log.discs, min(baths), np.inf), scale, "")


def _highest(log: Log, start: float | None, end: float | None) -> float:
    """Return the highest kinetic energy per disc between two times, relative to the centre of mass."""
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
    """Return the laws of a velocity quantity of one species by name.

    They are the Maxwell-Boltzmann distribution and, for a gas at fixed energy, the distribution of its ensemble.

    Args:
        quantity: name of the quantity.
        known: what is known of the gas.
        species: number of the species.
        measured: ensemble at the measured temperature; None if it was not measured.
    """
    ensemble = known.ensemble or measured
    if known.reason or ensemble is None or not ensemble.of_axes[species].any():  # fixed discs have no law
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
    """Return the rates that determine the free flights of K kinds of discs of S species.

    If no law holds, the rates and speeds are means over the gas that only set the range of the histogram.

    Returns:
        temperature: energy.
        rates: (K, K), collision rates, 1/time.
        errors: (K, K), their relative errors.
        speeds: (S,), mean speeds, length/time.
        reason: why no law holds; empty if one does.

    Raises:
        UserError: if no disc moves, or if there are too few collisions.
    """
    known = expectation(log, start, end)
    reason = known.reason
    if uneven := log.scene.lacking("uniform"):
        reason = reason or f"the gas is not uniform ({', '.join(uneven)})"
    if log.scene.properties.thermostat_rate:
        reason = reason or "a heat bath changes velocities in flight"
    if known.ensemble and known.ensemble.dof < 2 * FEW:
        reason = reason or f"the law is for many discs, and this gas has {len(log.discs)}"
    if known.ensemble and not reason:
        gas = known.ensemble
        theory = theory_of(log) if log.has_positions else None
        rates, errors = expected_rates(log.box, gas, theory).of_kinds
        if (rates.sum(axis=1) > 0).all():
            return gas.temperature, rates, errors, gas.mean_speed, ""
        reason = theory.reason if theory and theory.reason else "discs do not collide"
    time, collisions = log.observables["disc_collisions"]
    if not len(time) or not (collisions[-1] > collisions[0] and time[-1] > time[0]):
        raise UserError(f"{log.path}: too few collisions of discs for a distribution")
    rate = float(collisions[-1] - collisions[0]) / float(time[-1] - time[0]) / len(log.discs)
    speed = discs.shares @ mean_speed(known.scale, discs.mass)
    rates = np.diag(np.full(len(discs.name), rate))
    return known.scale, rates, 0 * rates, speed, reason

"""Measure the heat capacity by every route that the logs allow.

Logs at several temperatures give the slope dE/dT. A single log gives the heat capacity from E/T in a closed box, where
T is measured from the pressure on the walls, from Var(E)/T² in a heat bath, or from the fluctuations of the kinetic
energy in an isolated gas with spin, gravity or a piston.

DIR is the folder of a sweep with the analysis "heat-capacity".
"""

import math
from dataclasses import replace

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.heat_capacity.combine import (
    BATH,
    CLOSED,
    GRAVITY,
    PISTON,
    ROUGH,
    HeatCapacity,
    Measured,
    combine_logs,
)
from idealgas.analysis.heat_capacity.fluctuations import (
    bath_fluctuations,
    energy_series,
    expected_capacity,
    kinetic_fluctuations,
    too_few,
)
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.pressure.routes import WALLS
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import Log
from idealgas.statistics.estimates import Estimate, mean
from idealgas.tallies.equilibrium import nonequilibrium_reason
from idealgas.tallies.stream import ReadProgress
from idealgas.theory.conserved import centre_of_mass_energy, degrees_of_freedom


class HeatCapacityAnalysis(Analysis):
    """Heat capacity per disc."""

    position = 100
    headline = "routes.*"
    results = (Measured, HeatCapacity)
    sections = (Section("Heat capacity", "Heat capacity per disc from every route with standard errors, and theory"),)
    averages = True
    combine = staticmethod(combine_logs)

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Measured:
        """Measure the heat capacity per disc, in units of k_B, by the route that a log allows.

        In a closed box, it is E/T, where T is measured from the pressure on the walls. In a heat bath, it is Var(E)/T².
        In an isolated gas with spin, gravity or a piston, it follows from the fluctuations of the kinetic energy at
        fixed total energy. If there are too few independent samples, the result contains no value, and `caveats`
        contains the reason.

        Raises:
            UserError: if no equilibrium exists or is known, for example because walls have different temperatures,
                collisions lose energy, a piston is driven or the discs have no positions.
        """
        scene, properties, n = log.scene, log.scene.properties, len(log.discs)
        if not log.has_positions:
            raise NotApplicableError(f"{log.path}: the heat capacity requires discs with positions")
        if why := nonequilibrium_reason(log):
            follow = "use `idealgas evolution` to follow the gas over time"
            if not properties.fixed_walls:
                follow = "use `idealgas evolution` for γ of an adiabatic compression"
            raise NotApplicableError(f"{log.path}: the heat capacity requires equilibrium, but {why}; {follow}")
        has_piston = any(piston.mass for piston in scene.piston)
        if has_piston and (scene.piston[0].inner or len(scene.piston) > 1):
            raise UserError(
                f"{log.path}: the heat capacity requires at most one piston, with gas on one side of it only"
            )
        present = {
            BATH: not properties.isolated,
            ROUGH: properties.spins,
            GRAVITY: not properties.straight_flight,
            PISTON: has_piston,
        }
        kinds = [kind for kind, there in present.items() if there]
        if not kinds:
            return _closed_box(log, start, end, progress)
        series, dof = energy_series(log, start, end), degrees_of_freedom(log.scene, log.discs)
        capacity, excess = expected_capacity(log, series)
        of_piston = 1.5 if has_piston else 0.0
        if BATH in kinds:
            (bath,) = properties.temperatures
            temperature = Estimate(bath, 0.0, math.inf)
            thermometer = "thermal walls" if properties.bath is None else "heat bath"
            route, fluctuating = "Var(E)/T²", series.energy
            capacity_of_route = bath_fluctuations(series.energy, n, bath, of_piston, capacity)
        else:
            temperature, thermometer = mean(2 * series.kinetic / dof), "kinetic energy"
            route, fluctuating = "fluctuations of the kinetic energy", series.kinetic
            capacity_of_route = kinetic_fluctuations(series.kinetic, n, dof, of_piston, capacity)
        why = too_few(capacity_of_route, fluctuating)
        return Measured(
            str(log.path),
            ", ".join(kinds),
            n,
            _mean_energy(series.energy / n),
            temperature,
            thermometer,
            {} if why else {route: capacity_of_route},
            None if capacity is None else capacity.value,
            excess,
            0.0 if capacity is None else capacity.error,
            refused={route: why} if why else {},
            caveats=(f"No heat capacity from {route}: {why}.",) if why else (),
        )


def _mean_energy(energy: np.ndarray) -> Estimate:
    """Return the mean of a series of energies, with an error of 0 if the series varies only by rounding errors."""
    if np.ptp(energy) <= 1e-9 * np.abs(energy).max():
        return Estimate(float(energy.mean()), 0.0, math.inf)
    return mean(energy)


def _closed_box(log: Log, start: float | None, end: float | None, progress: ReadProgress | None) -> Measured:
    """Return the heat capacity E/T of a gas in a closed box.

    As hard discs have no energy scale, E is proportional to T.
    """
    measured = pressure(log, start, end, progress)
    walls = next((route.compressibility_factor for route in measured.routes if route.name.startswith(WALLS)), None)
    if walls is None or walls.theory is None or not walls.value > 0:
        raise UserError(
            f"{log.path}: E/T requires the temperature from walls, but no wall was hit, or theory is not available"
        )
    temperature, relative = measured.temperature, walls.theory_error / walls.theory
    t = replace(walls.times(temperature / walls.theory), theory=temperature)  # Z was computed with E/N as temperature
    n, expected = measured.number, degrees_of_freedom(log.scene, log.discs) / (2 * measured.number)
    energy = (log.discs.kinetic_energy - centre_of_mass_energy(log.scene, log.discs)) / n
    error = energy * t.standard_error / t.value**2
    routes = {"E/T": Estimate(energy / t.value, error, t.independent_samples, expected, relative * expected)}
    exact, how, theory = Estimate(energy, 0.0, math.inf), "pressure on the walls", (expected, None, relative * expected)
    return Measured(str(log.path), CLOSED, n, exact, t, how, routes, *theory, caveats=measured.caveats)

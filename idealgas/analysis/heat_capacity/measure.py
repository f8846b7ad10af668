"""Heat capacity from one log: energy, temperature, and the routes that need no other log.

The temperature must be measured independently of the energy: by the pressure on the walls where all energy is kinetic,
as the temperature of thermal walls or of a thermostat in a heat bath, and by the kinetic energy where that is a part of
the energy.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from idealgas.analysis.core.autoregression import inefficiency
from idealgas.analysis.core.ensemble import centre_of_mass_energy, degrees_of_freedom
from idealgas.analysis.core.fields import Key
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, estimate, mean
from idealgas.analysis.heat_capacity.energy_series import EnergySeries, energy_series
from idealgas.analysis.pressure.measure import WALLS, pressure
from idealgas.analysis.theory import hard_discs, values
from idealgas.analysis.theory.values import Theory
from idealgas.errors import UserError
from idealgas.log import Log

LEAST_SAMPLES = 32
"""Least number of independent samples for heat capacities from fluctuations; the error of a variance is then 25 %."""

LARGEST_ERROR = 0.5
"""Largest standard error of such a heat capacity, relative to it."""

FEW_IN_COLUMN = 0.47
"""Relative error, times N, of the heat capacity of many discs under gravity for N discs of a fixed energy.

The largest part of it over all heights of the box, by exact integration over the states of 2 to 20 points.
"""

SOURCE = "degrees of freedom"
"""Name of the theory."""

CLOSED, BATH, ROUGH, GRAVITY, PISTON = "closed box", "heat bath", "rough discs", "gravity", "piston"


@dataclass(frozen=True)
class Measured(Result):
    """Measurements of one log that concern the heat capacity.

    path: of the log. kind: kind of gas, such as a closed box or a heat bath. number: of discs. energy: mean energy per
    disc from an arbitrary zero, energy. temperature: energy (k_B = 1). thermometer: how the temperature was measured.
    routes: heat capacity per disc (k_B = 1) by the name of each route. theory: heat capacity per disc by theory.
    excess: C_P - C_A per disc by theory, None without a piston. theory_error: error of the theory.
    """

    path: str
    kind: str
    number: int
    energy: Annotated[Estimate, Key("energy_per_disc")]
    temperature: Estimate
    thermometer: str
    routes: dict[str, Estimate]
    theory: float | None
    excess: float | None
    theory_error: float = 0.0

    @classmethod
    def from_dict(cls, found: dict[str, Any]) -> "Measured":
        """Make the result again from the values of `as_dict`."""
        return cls(
            found["path"],
            found["kind"],
            found["number"],
            Estimate.from_dict(found["energy_per_disc"]),
            Estimate.from_dict(found["temperature"]),
            found["thermometer"],
            {name: Estimate.from_dict(route) for name, route in found["routes"].items()},
            found["theory"],
            found["excess"],
            found["theory_error"],
        )


def heat_capacity(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Measured:
    """Measure the heat capacity per disc, in units of k_B, by all the routes that one log allows.

    A closed box gives E/T, with T from the pressure on its walls; a heat bath Var(E)/T²; discs with spin, gravity or a
    piston the fluctuations of the kinetic energy at fixed total energy (Lebowitz, Percus & Verlet, Phys. Rev. 153, 250,
    1967). Fluctuations in fewer than LEAST_SAMPLES independent samples give none; `caveats` says so.

    start, end: times; by default from detected equilibrium to the end of the log. progress(done, in all) is called as
    events are read. Raises UserError if there is no equilibrium, or none known: walls of two temperatures, collisions
    that lose energy, a piston that is driven, a gas without positions.
    """
    scene, properties, n = log.scene, log.scene.properties, len(log.discs)
    settles = properties.lossless and not properties.driven and len(properties.temperatures) <= 1
    if not settles or not log.has_positions:
        raise UserError(f"{log.path}: no equilibrium, or none known, and so no heat capacity")
    kinds = []
    if not properties.isolated:
        kinds.append(BATH)
    kinds += [name for name, there in ((ROUGH, properties.spins), (GRAVITY, not properties.straight_flight)) if there]
    if scene.piston and scene.piston.mass:
        kinds.append(PISTON)
    if not kinds:
        return _closed_box(log, start, end, progress)
    series, dof = energy_series(log, start, end), degrees_of_freedom(log)
    capacity, excess = expected_capacity(log, series)
    if BATH in kinds:
        (bath,) = properties.temperatures
        temperature, thermometer = (
            Estimate(bath, 0.0, math.inf),
            "the walls' own" if properties.bath is None else "the heat bath's own",
        )
        route = "Var(E)/T²"
        found, fluctuating = _bath_fluctuations(series, n, bath, capacity, PISTON in kinds), series.energy
    else:
        temperature, thermometer = mean(2 * series.kinetic / dof), "kinetic energy"
        route = "fluctuations of the kinetic energy"
        found, fluctuating = _kinetic_fluctuations(series, n, dof, capacity, PISTON in kinds), series.kinetic
    lacking = too_few(route, found, len(fluctuating) / inefficiency(fluctuating))
    routes, measured = {} if lacking else {route: found}, (_mean_energy(series.energy / n), temperature, thermometer)
    value, error = (None, 0.0) if capacity is None else (capacity.value, capacity.error)
    return Measured(str(log.path), ", ".join(kinds), n, *measured, routes, value, excess, error, caveats=lacking)


def _mean_energy(energy: np.ndarray) -> Estimate:
    """Mean of a series of energies; known exactly if only rounding changes it."""
    if np.ptp(energy) <= 1e-9 * np.abs(energy).max():
        return Estimate(float(energy.mean()), 0.0, math.inf)
    return mean(energy)


def too_few(route: str, found: Estimate, samples: float) -> tuple[str, ...]:
    """Why fluctuations give no heat capacity, as one sentence; empty if there are enough independent samples."""
    error = found.standard_error
    if samples >= LEAST_SAMPLES and 0 < error <= LARGEST_ERROR * found.value:
        return ()
    if samples < LEAST_SAMPLES:
        why = f"{samples:.0f} independent samples of the energy are too few ({LEAST_SAMPLES} needed)"
    else:
        why = f"its error is too large ({found.value:.2g} ± {error:.2g})"
    return (f"No heat capacity from {route}: {why}; a longer run, or samples at shorter times, would give one.",)


def expected_capacity(log: Log, series: EnergySeries) -> tuple[Theory | None, float | None]:
    """Heat capacity C per disc by theory, and C_P - C_A per disc with a piston (k_B = 1); None where theory is unknown.

    Each degree of freedom adds 1/2; a conserved momentum takes one away. The position of a disc under gravity adds
    1 - x² eˣ/(eˣ - 1)² with x = m g h/T and the height h that its centre can reach; N discs of a fixed energy differ
    from that by a part 1/N. A piston adds Z²/(Z + φZ') = T (∂P/∂T)²/(-∂P/∂A).
    """
    scene, gas, part = log.scene, log.discs, 0.0
    motion = degrees_of_freedom(log) / (2 * len(gas))
    per_disc = motion + (0.5 if scene.properties.spins else 0.0)
    pull = np.array(log.gravity)
    equilibrated = len(gas.species_names) > 1
    if pull.any() and (not (scene.properties.fixed_walls and scene.properties.empty) or pull.all() or equilibrated):
        return None, None
    if pull.any():
        axis = int(np.flatnonzero(pull)[0])
        temperature = float(series.kinetic.mean() / (len(gas) * motion))
        x = float(gas.mass[0] * abs(pull[axis]) * (gas.box[axis] - 2 * gas.radius[0]) / temperature)
        per_disc += 1 - x * x * math.exp(-x) / math.expm1(-x) ** 2
        part = FEW_IN_COLUMN / len(gas) if scene.properties.isolated else 0.0
        if part > values.LARGEST_ERROR:
            return None, None
    if series.position is None or scene.piston is None:
        return Theory(per_disc, part * per_disc, SOURCE), None
    if equilibrated:
        return None, None
    across = gas.box[1 - scene.piston.axis]
    room = abs(series.position.mean() - (gas.box[scene.piston.axis] - scene.piston.stop(gas.box)))
    phi = gas.packing_fraction * gas.area / (room * across)
    if phi > hard_discs.HIGHEST:
        return None, None
    z, step = float(hard_discs.compressibility_factor(phi)), 1e-4 * phi
    slope = float(hard_discs.compressibility_factor(phi + step) - hard_discs.compressibility_factor(phi - step)) / (
        2 * step
    )
    excess = z * z / (z + phi * slope)
    return Theory(per_disc + excess, 0.0, SOURCE), excess


def _closed_box(
    log: Log, start: float | None, end: float | None, progress: Callable[[int, int], None] | None
) -> Measured:
    """Heat capacity E/T of a gas in a closed box: hard discs have no energy scale, so that E is proportional to T."""
    measured = pressure(log, start, end, progress)
    walls = next((route.compressibility_factor for route in measured.routes if route.name == WALLS), None)
    if walls is None or walls.theory is None or not walls.value > 0:
        raise UserError(f"{log.path}: walls that give no temperature: none, never hit, or without a theory")
    temperature, relative = measured.temperature, walls.theory_error / walls.theory
    t = replace(walls.times(temperature / walls.theory), theory=temperature)  # undoes that Z has E/N as temperature
    n, expected = measured.number, degrees_of_freedom(log) / (2 * measured.number)
    energy = (log.discs.kinetic_energy - centre_of_mass_energy(log)) / n
    error = energy * t.standard_error / t.value**2
    per_disc = Estimate(energy / t.value, error, t.independent_samples, expected, relative * expected)
    exact = Estimate(energy, 0.0, math.inf)
    routes, how, said = {"E/T": per_disc}, "pressure on the walls", measured.caveats
    theory = expected, None, relative * expected
    return Measured(str(log.path), CLOSED, n, exact, t, how, routes, *theory, caveats=said)


def _bath_fluctuations(series: EnergySeries, n: int, bath: float, capacity: Theory | None, piston: bool) -> Estimate:
    """Heat capacity C = Var(E)/T² per disc in a heat bath, corrected for the variance of the mean of the series."""
    energy = series.energy - series.energy.mean()
    lost = mean(energy).standard_error ** 2
    other = 1.5 if piston else 0.0
    return estimate(
        lambda e, square: ((square - e**2 + lost) / bath**2 - other) / n, energy, energy**2, theory=capacity
    )


def _kinetic_fluctuations(series: EnergySeries, n: int, dof: int, capacity: Theory | None, piston: bool) -> Estimate:
    """Heat capacity per disc from the variance of the kinetic energy K at fixed energy E, exact at finite N.

    All states of one energy are equally probable, so that K/E follows Beta(a, b) with a = D/2 and a + b = C, and
    r = a Var(K)/⟨K⟩² is b/(a + b + 1). Position and motion of a piston contribute 3/2 to C. Source: Lebowitz, Percus
    & Verlet, Phys. Rev. 153, 250 (1967).
    """
    a, unit = dof / 2, series.kinetic.mean()
    kinetic = series.kinetic / unit - 1
    lost, other = mean(kinetic).standard_error ** 2, 1.5 if piston else 0.0

    def per_disc(k: float, square: float) -> float:
        r = a * (square - k**2 + lost) / (1 + k) ** 2
        return (a + r * (a + 1) / (1 - r) - other) / n

    return estimate(per_disc, kinetic, kinetic**2, theory=capacity)

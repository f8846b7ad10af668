"""What one log tells of a heat capacity: energy, temperature, and the routes that it allows alone.

A thermometer must not know the energy whose capacity it helps to find: it is the pressure on the walls where all energy
is kinetic, the temperature of thermal walls in a heat bath, and the kinetic energy where that is a part of the whole.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from idealgas.analysis.core.equilibrium import kept_momentum
from idealgas.analysis.core.statistics import Estimate, estimate, mean
from idealgas.analysis.heat_capacity.energy_series import EnergySeries, energy_series
from idealgas.analysis.pressure.measure import WALLS, pressure
from idealgas.analysis.theory import hard_discs
from idealgas.errors import UserError
from idealgas.log import Log

CLOSED, BATH, ROUGH, GRAVITY, PISTON = "closed box", "heat bath", "rough discs", "gravity", "piston"


@dataclass(frozen=True)
class Measured:
    """What one log gives. kind: of gas, see above. energy: per disc, by whichever zero. routes: C per disc, by name.

    theory: C per disc. excess: C_P - C_A per disc by theory, with a piston.
    """

    path: str
    kind: str
    number: int
    energy: Estimate
    temperature: Estimate
    thermometer: str
    routes: dict[str, Estimate]
    theory: float | None
    excess: float | None

    @classmethod
    def from_dict(cls, found: dict[str, Any]) -> "Measured":
        """What `as_dict` was made from."""
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
        )

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "path": self.path,
            "kind": self.kind,
            "number": self.number,
            "energy_per_disc": self.energy.as_dict(),
            "temperature": self.temperature.as_dict(),
            "thermometer": self.thermometer,
            "routes": {name: route.as_dict() for name, route in self.routes.items()},
            "theory": self.theory,
            "excess": self.excess,
        }


def heat_capacity(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Measured:
    """Measure the heat capacity per disc, in units of k_B, by all the routes that one log allows.

    A closed box gives E/T, with T from the pressure on its walls; a heat bath Var(E)/T²; discs with spin, gravity or a
    piston the fluctuations of the kinetic energy at fixed total energy (Lebowitz, Percus & Verlet, Phys. Rev. 153, 250,
    1967).

    start, end: times; by default from detected equilibrium to the end of the log. progress(done, in all) is called as
    events are read. Raises UserError if there is no equilibrium, or none known: walls of two temperatures, collisions
    that lose energy, a piston that is driven, a gas without positions.
    """
    scene, properties, n = log.scene, log.scene.properties, len(log.discs)
    settles = properties.elastic and not properties.driven and len(properties.temperatures) <= 1
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
    series = energy_series(log, start, end)
    dof = 2 * n - int(kept_momentum(log).sum())
    capacity, excess = expected_capacity(log, series)
    if BATH in kinds:
        (bath,) = properties.temperatures
        temperature, thermometer = Estimate(bath, 0.0, math.inf), "the walls' own"
        routes = {"Var(E)/T²": _bath_fluctuations(series, n, bath, capacity, PISTON in kinds)}
    else:
        temperature, thermometer = mean(2 * series.kinetic / dof), "kinetic energy"
        found = _kinetic_fluctuations(series, n, dof, capacity, PISTON in kinds)
        routes = {"fluctuations of the kinetic energy": found}
    energy = mean(series.energy / n)
    return Measured(str(log.path), ", ".join(kinds), n, energy, temperature, thermometer, routes, capacity, excess)


def expected_capacity(log: Log, series: EnergySeries) -> tuple[float | None, float | None]:
    """(C per disc, C_P - C_A per disc with a piston); None where no simple theory applies.

    Each degree of freedom has 1/2. The place of a disc in a column of height h that it can reach, x = m g h/T, adds
    1 - x² eˣ/(eˣ - 1)²; a piston Z²/(Z + φZ'), which is T (∂P/∂T)²/(-∂P/∂A).
    """
    scene, gas = log.scene, log.discs
    per_disc = 1.5 if scene.properties.spins else 1.0
    pull = np.array(log.gravity)
    equilibrated = len(gas.species_names) > 1
    if pull.any() and (scene.piston or not scene.properties.empty or pull.all() or equilibrated):
        return None, None
    if pull.any():
        axis = int(np.flatnonzero(pull)[0])
        temperature = float(series.kinetic.mean() / len(gas))
        x = float(gas.mass[0] * abs(pull[axis]) * (gas.box[axis] - 2 * gas.radius[0]) / temperature)
        per_disc += 1 - x * x * math.exp(-x) / math.expm1(-x) ** 2
    if series.position is None or scene.piston is None:
        return per_disc, None
    if equilibrated:
        return None, None
    across = gas.box[1 - scene.piston.axis]
    room = abs(series.position.mean() - (gas.box[scene.piston.axis] - scene.piston.stop(gas.box)))
    phi = gas.packing_fraction * gas.area / (room * across)
    z, step = float(hard_discs.compressibility(phi)), 1e-4 * phi
    slope = float(hard_discs.compressibility(phi + step) - hard_discs.compressibility(phi - step)) / (2 * step)
    excess = z * z / (z + phi * slope)
    return per_disc + excess, excess


def _closed_box(
    log: Log, start: float | None, end: float | None, progress: Callable[[int, int], None] | None
) -> Measured:
    """Hard discs have no energy scale: E is proportional to T, and E/T is the heat capacity."""
    measured = pressure(log, start, end, progress)
    walls = next((route.compressibility for route in measured.routes if route.name == WALLS), None)
    if walls is None or walls.theory is None or not walls.value > 0:
        raise UserError(f"{log.path}: walls that give no temperature: none, never hit, or of a gas too dense")
    unit = measured.temperature / walls.theory  # Z was taken with E/N for T; undone here
    t = Estimate(walls.value * unit, walls.standard_error * unit, walls.independent_samples, measured.temperature)
    n, energy = measured.number, log.discs.kinetic_energy / measured.number
    per_disc = Estimate(energy / t.value, energy * t.standard_error / t.value**2, t.independent_samples, theory=1.0)
    exact = Estimate(energy, 0.0, math.inf)
    return Measured(str(log.path), CLOSED, n, exact, t, "pressure on the walls", {"E/T": per_disc}, 1.0, None)


def _bath_fluctuations(series: EnergySeries, n: int, bath: float, capacity: float | None, piston: bool) -> Estimate:
    """C = Var(E)/T². The mean is the series' own, which takes a little of the variance away: made good here."""
    energy = series.energy - series.energy.mean()
    lost = mean(energy).standard_error ** 2
    other = 1.5 if piston else 0.0
    return estimate(
        lambda e, square: ((square - e**2 + lost) / bath**2 - other) / n, energy, energy**2, theory=capacity
    )


def _kinetic_fluctuations(series: EnergySeries, n: int, dof: int, capacity: float | None, piston: bool) -> Estimate:
    """C from Var(K) at fixed energy: Lebowitz, Percus & Verlet, Phys. Rev. 153, 250 (1967), exact at finite N.

    All of phase space at an energy is as likely, so that K/E follows Beta(a, b), a = D/2 and a + b = C;
    r = a Var(K)/⟨K⟩² is b/(a + b + 1). A piston's own place and motion have 3/2 of C.
    """
    a, unit = dof / 2, series.kinetic.mean()
    kinetic = series.kinetic / unit - 1
    lost, other = mean(kinetic).standard_error ** 2, 1.5 if piston else 0.0

    def per_disc(k: float, square: float) -> float:
        r = a * (square - k**2 + lost) / (1 + k) ** 2
        return (a + r * (a + 1) / (1 - r) - other) / n

    return estimate(per_disc, kinetic, kinetic**2, theory=capacity)

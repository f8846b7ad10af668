"""Heat capacity at constant area, from the energy and a thermometer that knows nothing of it: the wall pressure."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from idealgas.analysis.pressure import WALLS, pressure
from idealgas.analysis.statistics import Estimate
from idealgas.errors import UserError
from idealgas.log import Log

ONE_LOG = (
    "One log of an isolated gas has one energy: no slope dE/dT, and no fluctuation of E to tell a heat capacity from. "
    "Hard discs have no energy scale, so that E is proportional to T, and E/T is the heat capacity; T is measured by "
    "the pressure on the walls. Give logs of different temperatures for a slope."
)
SLOPE = "Slope dE/dT by weighted least squares; T is measured by the pressure on the walls, which does not know E."


@dataclass(frozen=True)
class Point:
    """One log: energy per disc, and the temperature that its walls feel; theory: E/N."""

    path: str
    number: int
    energy: float
    temperature: Estimate

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "path": self.path,
            "number": self.number,
            "energy_per_disc": self.energy,
            "temperature": self.temperature.as_dict(),
        }


@dataclass(frozen=True)
class HeatCapacity:
    """per_disc: C/N (theory 1). number: N, or None if the logs differ in it. intercept: E/N at T = 0 by the fit."""

    per_disc: Estimate
    number: int | None
    intercept: float
    route: str
    explanation: str
    points: tuple[Point, ...]

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "per_disc": self.per_disc.as_dict(),
            "number": self.number,
            "intercept": self.intercept,
            "route": self.route,
            "explanation": self.explanation,
            "points": [point.as_dict() for point in self.points],
        }


def heat_capacity(
    logs: Sequence[Log],
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> HeatCapacity:
    """Heat capacity from one log (E/T) or several (dE/dT), each between two times or from detected equilibrium on."""
    points = tuple(_point(log, start, end, progress) for log in logs)
    numbers = {point.number for point in points}
    number = numbers.pop() if len(numbers) == 1 else None
    if len(points) == 1:
        (point,) = points
        t = point.temperature
        per_disc = point.energy / t.value
        error = per_disc * t.standard_error / t.value
        ratio = Estimate(per_disc, error, t.independent_samples, theory=1.0)
        return HeatCapacity(ratio, number, 0.0, "E/T", ONE_LOG, points)
    slope, intercept = _fit(points)
    return HeatCapacity(slope, number, intercept, "dE/dT", SLOPE, points)


def _point(log: Log, start: float | None, end: float | None, progress: Callable[[int, int], None] | None) -> Point:
    measured = pressure(log, start, end, progress)
    walls = next(route.compressibility for route in measured.routes if route.name == WALLS)
    if walls.theory is None or not walls.value > 0:
        raise UserError(f"{log.path}: the walls give no temperature: no hits, or no theory at this packing fraction")
    unit = measured.temperature / walls.theory  # Z was taken with E/N for T; undone here
    thermometer = Estimate(
        walls.value * unit, walls.standard_error * unit, walls.independent_samples, theory=measured.temperature
    )
    return Point(str(log.path), measured.number, log.discs.kinetic_energy / measured.number, thermometer)


def _fit(points: Sequence[Point]) -> tuple[Estimate, float]:
    """(dE/dT per disc, E/N at T = 0). Energies are exact, temperatures are not: T is fitted over E, then inverted."""
    energy = np.array([point.energy for point in points])
    measured = np.array([point.temperature.value for point in points])
    weight = np.array([point.temperature.standard_error for point in points]) ** -2.0
    if not np.ptp(energy) > 1e-9 * energy.max():
        raise UserError("no slope dE/dT: all logs have the same energy per disc")
    if not np.isfinite(weight).all():
        raise UserError("no slope dE/dT: a log has too few events for the error of its temperature")
    middle = (weight * energy).sum() / weight.sum()
    spread = (weight * (energy - middle) ** 2).sum()
    slope = (weight * (energy - middle) * measured).sum() / spread
    at_middle = (weight * measured).sum() / weight.sum()
    samples = sum(point.temperature.independent_samples for point in points)
    estimate = Estimate(float(1 / slope), float(spread**-0.5 / slope**2), samples, theory=1.0)
    return estimate, float(middle - at_middle / slope)

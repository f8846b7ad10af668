"""Heat capacity by every route that logs allow, side by side: slopes of the energy, and fluctuations of it.

A thermometer must not know the energy whose capacity it helps to find: it is the pressure on the walls where all energy
is kinetic, the temperature of thermal walls in a heat bath, and the kinetic energy where that is a part of the whole.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from idealgas.analysis.core.equilibrium import kept_momentum
from idealgas.analysis.core.statistics import Estimate, estimate, mean, mean_of_replicates, mean_theory
from idealgas.analysis.heat_capacity.energy_series import EnergySeries, energy_series
from idealgas.analysis.pressure.measure import WALLS, pressure
from idealgas.analysis.theory import hard_discs
from idealgas.errors import UserError
from idealgas.log import Log

CLOSED, BATH, ROUGH, GRAVITY, PISTON = "closed box", "heat bath", "rough discs", "gravity", "piston"

ROUTES = {
    "dE/dT": "it takes logs of one kind of gas at several energies",
    "E/T": "it takes the pressure on the walls of a closed box, in a log with events",
    "Var(E)/T²": "it takes thermal walls of one temperature",
    "fluctuations of the kinetic energy": "it takes an isolated gas with spin, gravity or a piston",
    "γ": "it takes a piston with a mass",
}
"""Each route, and what a set of logs lacks that does not allow it."""


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


@dataclass(frozen=True)
class Route:
    """C per disc (or γ) of one kind of gas by one way of measuring."""

    name: str
    kind: str
    value: Estimate

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"route": self.name, "kind": self.kind, "value": self.value.as_dict()}


@dataclass(frozen=True)
class HeatCapacity:
    """routes: those the logs allow. refused: why others do not apply, by route."""

    routes: tuple[Route, ...]
    refused: dict[str, str]
    logs: tuple[Measured, ...]

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "routes": [route.as_dict() for route in self.routes],
            "refused": self.refused,
            "logs": [measured.as_dict() for measured in self.logs],
        }


# ── one log ──


def measure_heat(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Measured:
    """All that one log tells of a heat capacity, between two times or from detected equilibrium on."""
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


# ── all logs ──


def heat_capacity(logs: Sequence[Measured]) -> HeatCapacity:
    """Put the logs of a kind together: slopes over them, means of what each gives, and γ."""
    routes = [route for kind in dict.fromkeys(m.kind for m in logs) for route in _of_kind(kind, logs)]
    routes += _gammas(routes, logs)
    used = {route.name for route in routes}
    return HeatCapacity(tuple(routes), {name: why for name, why in ROUTES.items() if name not in used}, tuple(logs))


def _of_kind(kind: str, logs: Sequence[Measured]) -> Iterator[Route]:
    members = [m for m in logs if m.kind == kind]
    if (slope := _slope(members)) is not None:
        yield Route("dE/dT", kind, slope)
    for name in dict.fromkeys(name for m in members for name in m.routes):
        values = [m.routes[name] for m in members if name in m.routes]
        yield Route(name, kind, mean_of_replicates(values))


def _slope(members: Sequence[Measured]) -> Estimate | None:
    """dE/dT per disc by weighted least squares, whichever of E and T is the exact one; None if all are alike."""
    energy, t = (np.array([getattr(m, name).value for m in members]) for name in ("energy", "temperature"))
    if len(members) < 2 or not np.ptp(t) > 0.05 * np.abs(t).max():
        return None
    errors = np.array([(m.energy.standard_error, m.temperature.standard_error) for m in members])
    guess = np.polyfit(t, energy, 1)[0]
    weight = (errors[:, 0] ** 2 + (guess * errors[:, 1]) ** 2) ** -1.0
    if not np.isfinite(weight).all():
        return None
    given, measured = (t, energy) if errors[:, 1].max() == 0 else (energy, t)
    middle = (weight * given).sum() / weight.sum()
    spread = (weight * (given - middle) ** 2).sum()
    slope = (weight * (given - middle) * measured).sum() / spread
    if given is energy:
        slope = 1 / slope
        error = spread**-0.5 * slope**2 / abs(guess)
    else:
        error = spread**-0.5
    other = 1.5 / members[0].number if PISTON in members[0].kind else 0.0
    samples = sum(min(m.energy.independent_samples, m.temperature.independent_samples) for m in members)
    return Estimate(float(slope) - other, float(error), samples, mean_theory([m.theory for m in members]))


def _gammas(routes: Sequence[Route], logs: Sequence[Measured]) -> Iterator[Route]:
    """γ = C_P/C_A: C_A as the same discs have it without the piston where a log tells, else by theory's C_P - C_A."""
    for route in routes:
        excess = next((m.excess for m in logs if m.kind == route.kind and m.excess), None)
        c_p = route.value
        if excess is None or c_p.theory is None:
            continue
        other = (ROUGH, f"{BATH}, {ROUGH}") if ROUGH in route.kind else (CLOSED, BATH)
        at_area = [r.value for r in routes if r.kind in other]
        expected = c_p.theory / (c_p.theory - excess)
        if at_area:
            c_a = min(at_area, key=lambda value: value.standard_error)
            value = c_p.value / c_a.value
            error = value * math.hypot(c_p.standard_error / c_p.value, c_a.standard_error / c_a.value)
        else:
            value = c_p.value / (c_p.value - excess)
            error = excess * c_p.standard_error / (c_p.value - excess) ** 2
        yield Route("γ", f"{route.kind}: {route.name}", Estimate(value, error, c_p.independent_samples, expected))

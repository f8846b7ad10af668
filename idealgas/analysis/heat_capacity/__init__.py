"""Measure the heat capacity by every route that the logs allow.

Logs at several temperatures give the slope dE/dT. One log gives E/T by the pressure on the walls of a closed box,
Var(E)/T² in a heat bath, and with spin, gravity or a piston the fluctuations of the kinetic energy. DIR is the
folder of a sweep with the analysis "heat-capacity".
"""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from idealgas.analysis.core.analysis import Analysis, Progress, Section
from idealgas.analysis.core.check import agreement
from idealgas.analysis.core.ensemble import centre_of_mass_energy, degrees_of_freedom, nonequilibrium_reason
from idealgas.analysis.core.fields import OPTIONAL, Key
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, mean, mean_of_replicates, mean_theory
from idealgas.analysis.core.tables import Table, estimates, format_estimate
from idealgas.analysis.heat_capacity.fluctuations import (
    bath_fluctuations,
    energy_series,
    expected_capacity,
    kinetic_fluctuations,
    too_few,
)
from idealgas.analysis.pressure.measure import WALLS, pressure
from idealgas.errors import UserError
from idealgas.log import Log

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CLOSED, BATH, ROUGH, GRAVITY, PISTON = "closed box", "heat bath", "rough discs", "gravity", "piston"

ROUTES = {
    "dE/dT": "it takes logs of one gas at several energies",
    "E/T": "it takes the pressure on the walls of a closed box, in a log with events",
    "Var(E)/T²": "it takes thermal walls of one temperature, or a thermostat",
    "fluctuations of the kinetic energy": "it takes an isolated gas with spin, gravity or a piston",
    "γ": "it takes a piston with a mass",
}
"""Reason why a route does not apply to a set of logs, by the name of the route."""

MANY = 12
"""Largest number of logs that the table lists one by one."""


@dataclass(frozen=True)
class Measured(Result):
    """Measurements of one log that concern the heat capacity.

    The temperature must be measured independently of the energy: by the pressure on the walls where all energy is
    kinetic, as the temperature of thermal walls or of a thermostat in a heat bath, and by the kinetic energy where that
    is a part of the energy.

    Attributes:
        path: of the log.
        kind: kind of gas, such as a closed box or a heat bath.
        number: of discs.
        energy: mean energy per disc from an arbitrary zero, energy.
        temperature: energy (k_B = 1).
        thermometer: how the temperature was measured.
        routes: heat capacity per disc (k_B = 1) by the name of each route.
        refused: reason why the log gives no value by a route that applies to it, by the name of the route.
        theory, theory_error: heat capacity per disc by theory, and its error.
        excess: C_P - C_A per disc by theory, None without a piston.
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
    refused: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Route:
    """Heat capacity per disc (k_B = 1), or γ (no unit), of one gas by one way of measuring.

    name: of the route. kind: of gas. gas: its number of discs, box and effects; None if the logs hold one gas of this
    kind.
    """

    name: Annotated[str, Key("route")]
    kind: str
    value: Estimate
    gas: Annotated[str | None, OPTIONAL] = None


@dataclass(frozen=True)
class HeatCapacity(Result):
    """Heat capacity by every route that a set of logs allows.

    routes: heat capacities, one for each route and kind of gas. refused: reason why a route does not apply, by the name
    of the route. logs: what was measured in each log.
    """

    routes: tuple[Route, ...]
    refused: dict[str, str]
    logs: tuple[Measured, ...]


class HeatCapacityAnalysis(Analysis):
    """Heat capacity per disc."""

    position = 100
    headline = "routes.*"
    results = (Measured, HeatCapacity)
    sections = (Section("Heat capacity", "Heat capacity per disc by every route with its standard error, and theory"),)
    averages = True

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: Progress | None = None
    ) -> Measured:
        """Measure the heat capacity per disc, in units of k_B, by all the routes that one log allows.

        A closed box gives E/T, with T from the pressure on its walls; a heat bath Var(E)/T²; discs with spin, gravity
        or a piston the fluctuations of the kinetic energy at fixed total energy. Too few independent samples give
        none; `caveats` says so.

        Args:
            log: log with positions.
            start: time; by default detected equilibrium.
            end: time; by default the end of the log.
            progress: called as progress(done, total) while events are read.

        Raises:
            UserError: if no equilibrium exists or is known: walls of two temperatures, collisions that lose energy, a
                driven piston, a gas without positions.
        """
        scene, properties, n = log.scene, log.scene.properties, len(log.discs)
        if nonequilibrium_reason(log) or not log.has_positions:
            raise UserError(f"{log.path}: no known equilibrium, and so no heat capacity")
        has_piston = bool(scene.piston and scene.piston.mass)
        if has_piston and scene.piston.inner:
            raise UserError(f"{log.path}: no heat capacity of two gases with a piston between them")
        present = {
            BATH: not properties.isolated,
            ROUGH: properties.spins,
            GRAVITY: not properties.straight_flight,
            PISTON: has_piston,
        }
        kinds = [kind for kind, there in present.items() if there]
        if not kinds:
            return _closed_box(log, start, end, progress)
        series, dof = energy_series(log, start, end), degrees_of_freedom(log)
        capacity, excess = expected_capacity(log, series)
        other = 1.5 if has_piston else 0.0
        if BATH in kinds:
            (bath,) = properties.temperatures
            temperature = Estimate(bath, 0.0, math.inf)
            thermometer = "the walls' own" if properties.bath is None else "the heat bath's own"
            route, fluctuating = "Var(E)/T²", series.energy
            found = bath_fluctuations(series.energy, n, bath, other, capacity)
        else:
            temperature, thermometer = mean(2 * series.kinetic / dof), "kinetic energy"
            route, fluctuating = "fluctuations of the kinetic energy", series.kinetic
            found = kinetic_fluctuations(series.kinetic, n, dof, other, capacity)
        why = too_few(found, fluctuating)
        return Measured(
            str(log.path),
            ", ".join(kinds),
            n,
            _mean_energy(series.energy / n),
            temperature,
            thermometer,
            {} if why else {route: found},
            None if capacity is None else capacity.value,
            excess,
            0.0 if capacity is None else capacity.error,
            refused={route: why} if why else {},
            caveats=(f"No heat capacity from {route}: {why}.",) if why else (),
        )

    @staticmethod
    def combine(logs: Sequence[Measured]) -> HeatCapacity:
        """Combine the logs of each gas: slopes dE/dT, means of the routes of single logs, and γ."""
        groups = _groups(logs)
        routes = [route for (kind, gas), members in groups.items() for route in _of_gas(kind, gas, members)]
        routes += _gammas(tuple(routes), groups)
        used = {route.name for route in routes}
        reasons = ROUTES | {name: why for log in logs for name, why in log.refused.items()}
        if any(log.excess is not None for log in logs):
            reasons["γ"] = "no heat capacity of the gas with the piston was measured, or theory has none"
        refused = {name: why for name, why in reasons.items() if name not in used}
        return HeatCapacity(tuple(routes), refused, tuple(logs), caveats=tuple(_apart(groups)))

    @staticmethod
    def restore(found: dict[str, Any], label: str) -> Measured:
        """Result of one point of a sweep, named by the path of its log."""
        energy, temperature = (Estimate.from_dict(found[key]) for key in ("energy_per_disc", "temperature"))
        routes = {name: Estimate.from_dict(route) for name, route in found["routes"].items()}
        plain = {
            key: found[key] for key in ("path", "kind", "number", "thermometer", "theory", "excess", "theory_error")
        }
        return Measured(energy=energy, temperature=temperature, routes=routes, **plain)

    @staticmethod
    def tables(result: HeatCapacity) -> list[Table]:
        """Tables of energy and temperature of each log, and of the heat capacity by every route."""
        tables = []
        if len(result.logs) <= MANY:
            rows = [(f"{log.path}: E/N", log.energy) for log in result.logs]
            rows += [(f"{log.path}: T by {log.thermometer}", log.temperature) for log in result.logs]
            tables.append(estimates("Logs (energy)", rows))
        routes = [(_listed(route.name, route.kind, route.gas), route.value) for route in result.routes]
        refused = [f"no {name}: {why}" for name, why in result.refused.items()]
        return [*tables, estimates("C per disc, and γ (no unit, k_B = 1)", routes, refused)]

    @staticmethod
    def summary(result: HeatCapacity) -> str:
        """Heat capacity per disc by the first route, and whether all routes agree with theory."""
        rows = [(_listed(route.name, route.kind, route.gas), route.value) for route in result.routes]
        if not rows:
            return "No route gives a heat capacity here, so that there is nothing to compare with theory."
        name, found = rows[0]
        return f"C = {format_estimate(found)} per disc by {name} (1 for a large ideal gas, k_B = 1); {agreement(rows)}."

    @staticmethod
    def figure(result: HeatCapacity) -> "Figure":
        """Picture of C per disc (and of γ) by every route with its error bar, and of its theory."""
        from idealgas.analysis.core.style import COLOURS, name_rows, panels

        figure, (ax,) = panels(1)
        names = []
        for k, route in enumerate(result.routes[::-1]):
            ax.errorbar(route.value.value, k, xerr=route.value.standard_error, fmt="o", color=COLOURS[0], capsize=3)
            ax.theory_of_row(k, route.value, None)
            gas = _listed(route.kind, route.gas)
            names.append((f"{gas}: {route.name}" if gas else route.name).replace(" of the kinetic energy", ""))
        name_rows(ax, names, fontsize="small")
        ax.locator_params(axis="x", nbins=6)
        ax.plot([], [], "o", color=COLOURS[0], label="measured")
        ax.plot([], [], color=COLOURS[1], label="theory")
        ax.set(xlabel="C/N, and γ (no unit, k_B = 1)", ylabel="by every route")
        ax.legend()
        figure.set_figheight(1.5 + 0.3 * len(names))
        return figure


def _listed(*parts: str | None) -> str:
    return ", ".join(filter(None, parts))


def _mean_energy(energy: np.ndarray) -> Estimate:
    """Mean of a series of energies; known exactly if only rounding changes it."""
    if np.ptp(energy) <= 1e-9 * np.abs(energy).max():
        return Estimate(float(energy.mean()), 0.0, math.inf)
    return mean(energy)


def _closed_box(log: Log, start: float | None, end: float | None, progress: Progress | None) -> Measured:
    """Heat capacity E/T of a gas in a closed box: hard discs have no energy scale, so that E is proportional to T."""
    measured = pressure(log, start, end, progress)
    walls = next((route.compressibility_factor for route in measured.routes if route.name.startswith(WALLS)), None)
    if walls is None or walls.theory is None or not walls.value > 0:
        raise UserError(f"{log.path}: no temperature from walls: none, never hit, or without a theory")
    temperature, relative = measured.temperature, walls.theory_error / walls.theory
    t = replace(walls.times(temperature / walls.theory), theory=temperature)  # undoes that Z has E/N as temperature
    n, expected = measured.number, degrees_of_freedom(log) / (2 * measured.number)
    energy = (log.discs.kinetic_energy - centre_of_mass_energy(log)) / n
    error = energy * t.standard_error / t.value**2
    routes = {"E/T": Estimate(energy / t.value, error, t.independent_samples, expected, relative * expected)}
    exact, how, theory = Estimate(energy, 0.0, math.inf), "pressure on the walls", (expected, None, relative * expected)
    return Measured(str(log.path), CLOSED, n, exact, t, how, routes, *theory, caveats=measured.caveats)


# ── several logs ──


Groups = dict[tuple[str, str], list[Measured]]
"""Logs by kind of gas and gas in words; the words are empty where all logs of the kind are of one gas."""


def _groups(logs: Sequence[Measured]) -> Groups:
    by_digest: dict[tuple[str, str], list[Measured]] = {}
    for log in logs:
        by_digest.setdefault((log.kind, log.origin.gas if log.origin else ""), []).append(log)
    kinds = Counter(kind for kind, _ in by_digest)
    groups: Groups = {}
    for (kind, _), members in by_digest.items():
        origin = members[0].origin
        words = origin.words if origin and kinds[kind] > 1 else ""
        if (kind, words) in groups and origin:
            words = f"{words}, as in {origin.path}"  # gases that differ in what the words leave out
        groups[kind, words] = members
    return groups


def _apart(groups: Groups) -> Iterator[str]:
    """Sentence for each kind of gas of which there is more than one gas."""
    for kind in dict.fromkeys(kind for kind, _ in groups):
        if len(gases := [gas for other, gas in groups if other == kind]) > 1:
            words = "; ".join(gases)
            yield f"Different gases ({kind}) are kept apart, each with a slope dE/dT and means of its own: {words}."


def _of_gas(kind: str, gas: str, members: Sequence[Measured]) -> Iterator[Route]:
    if (slope := _slope(members)) is not None:
        yield Route("dE/dT", kind, slope, gas or None)
    for name in dict.fromkeys(name for m in members for name in m.routes):
        values = [m.routes[name] for m in members if name in m.routes]
        yield Route(name, kind, mean_of_replicates(values), gas or None)


def _slope(members: Sequence[Measured]) -> Estimate | None:
    """Slope dE/dT per disc by weighted least squares with errors of E or of T; None if all are the same."""
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
    theory_error = sum(m.theory_error for m in members) / len(members)
    return Estimate(float(slope) - other, float(error), samples, mean_theory([m.theory for m in members]), theory_error)


def _gammas(routes: Sequence[Route], groups: Groups) -> Iterator[Route]:
    """Ratio γ = C_P/C_A: C_A is measured in a log without the piston if there is one, else C_P - C_A is from theory."""
    for route in routes:
        excess = next((m.excess for m in groups[route.kind, route.gas or ""] if m.excess), None)
        c_p = route.value
        if excess is None or c_p.theory is None:
            continue
        without_piston = (ROUGH, f"{BATH}, {ROUGH}") if ROUGH in route.kind else (CLOSED, BATH)
        at_area = [r.value for r in routes if r.kind in without_piston]
        expected = c_p.theory / (c_p.theory - excess)
        if at_area:
            c_a = min(at_area, key=lambda value: value.standard_error)
            value = c_p.value / c_a.value
            error = value * math.hypot(c_p.standard_error / c_p.value, c_a.standard_error / c_a.value)
        else:
            value = c_p.value / (c_p.value - excess)
            error = excess * c_p.standard_error / (c_p.value - excess) ** 2
        gamma = Estimate(value, error, c_p.independent_samples, expected)
        yield Route("γ", f"{route.kind}: {route.name}", gamma, route.gas)

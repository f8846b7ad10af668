"""Heat capacity from several logs: the slope dE/dT of each gas, averages over single logs for each route, and γ."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result, RunResult
from idealgas.fields import OPTIONAL, Key
from idealgas.presentation.tables import Table, estimates, format_estimate
from idealgas.statistics.estimates import Estimate, mean_of_replicates, mean_theory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CLOSED, BATH, ROUGH, GRAVITY, PISTON = "closed box", "heat bath", "rough discs", "gravity", "piston"

MANY = 12
"""Largest number of logs that a table lists individually."""

ROUTES = {
    "dE/dT": "it requires logs of one gas at several energies",
    "E/T": "it requires the pressure on the walls of a closed box, in a log with events",
    "Var(E)/T²": "it requires thermal walls at a common temperature, or a thermostat",
    "fluctuations of the kinetic energy": "it requires an isolated gas with spin, gravity or a piston",
    "γ": "it requires a piston of finite mass",
}
"""Reason why a route does not apply to a set of logs, by name of the route."""


@dataclass(frozen=True)
class Measured(RunResult):
    """Energy, temperature and heat capacities of one log.

    The temperature must be known independently of the energy. In a closed box, where all energy is kinetic, it is
    measured from the pressure on the walls. In a heat bath, it is the temperature of the thermal walls or of the
    thermostat. If the kinetic energy is only one term of the energy, it is measured from the kinetic energy.

    Attributes:
        path: path of the log.
        kind: kind of gas, such as a closed box or a heat bath.
        number: number of discs.
        energy: mean energy per disc, relative to an arbitrary zero, energy.
        temperature: temperature, energy (k_B = 1).
        thermometer: how the temperature was measured.
        routes: heat capacity per disc (k_B = 1), by name of the route.
        theory: theoretical heat capacity per disc (k_B = 1); None if theory is not available.
        excess: theoretical C_P - C_A per disc (k_B = 1); None without a piston or without theory.
        theory_error: error of the theoretical heat capacity.
        refused: why a route that applies to the log gives no value, by name of the route.
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
class HeatCapacityRoute:
    """Heat capacity per disc (k_B = 1), or γ (no unit), of one gas from one route.

    Attributes:
        name: name of the route.
        kind: kind of gas.
        value: heat capacity or γ.
        gas: description of the gas by discs, box and effects; None if the logs contain only one gas of this kind.
    """

    name: Annotated[str, Key("route")]
    kind: str
    value: Estimate
    gas: Annotated[str | None, OPTIONAL] = None


@dataclass(frozen=True)
class HeatCapacity(Result):
    """Heat capacity from every route that a set of logs allows.

    Attributes:
        routes: heat capacities, one for each route and kind of gas.
        refused: why a route does not apply or gives no value, by name of the route.
        logs: measurements from each log.
    """

    routes: tuple[HeatCapacityRoute, ...]
    refused: dict[str, str]
    logs: tuple[Measured, ...]

    def plain_tables(self) -> list[Table]:
        """Return the table of energies and temperatures of the logs, and that of the heat capacity from every route."""
        tables = []
        if len(self.logs) <= MANY:
            rows = [(f"{log.path}: E/N", log.energy) for log in self.logs]
            rows += [(f"{log.path}: T from {log.thermometer}", log.temperature) for log in self.logs]
            tables.append(estimates("Logs (energy)", rows))
        routes = [(_listed(route.name, route.kind, route.gas), route.value) for route in self.routes]
        refused = [f"no {name}: {why}" for name, why in self.refused.items()]
        return [*tables, estimates("C per disc, and γ (no unit, k_B = 1)", routes, refused)]

    def summary(self) -> str:
        """Return the heat capacity per disc from the first route, and whether all routes agree with theory."""
        rows = [(_listed(route.name, route.kind, route.gas), route.value) for route in self.routes]
        if not rows:
            return "No route gives a heat capacity for these logs."
        name, estimate = rows[0]
        return (
            f"C = {format_estimate(estimate)} per disc from {name} (1 for a large ideal gas, k_B = 1); "
            f"{agreement(rows)}."
        )

    def figure(self) -> "Figure":
        """Draw C per disc (and γ) from every route with error bars and theoretical values."""
        from idealgas.presentation.style import COLOURS, name_rows, panels

        figure, (ax,) = panels(1)
        names = [] if self.routes else [f"no {name}" for name in self.refused]
        for k, route in enumerate(self.routes[::-1], len(names)):
            ax.errorbar(route.value.value, k, xerr=route.value.standard_error, fmt="o", color=COLOURS[0], capsize=3)
            ax.theory_of_row(k, route.value, None)
            gas = _listed(route.kind, route.gas)
            names.append(f"{gas}: {route.name}" if gas else route.name)
        name_rows(ax, [name.replace(" of the kinetic energy", "") for name in names], fontsize="small")
        ax.locator_params(axis="x", nbins=6)
        ax.plot([], [], "o", color=COLOURS[0], label="measured")
        ax.plot([], [], color=COLOURS[1], label="theory")
        ax.set(xlabel="C/N, and γ (no unit, k_B = 1)", ylabel="route")
        ax.legend()
        figure.set_figheight(1.5 + 0.3 * len(names))
        return figure


Groups = dict[tuple[str, str], list[Measured]]
"""Logs by kind of gas and description of the gas, which is empty if all logs of the kind contain the same gas."""


def _listed(*parts: str | None) -> str:
    return ", ".join(filter(None, parts))


def combine_logs(logs: Sequence[Measured]) -> HeatCapacity:
    """Combine the logs of each gas: slopes dE/dT, averages over single logs for each route, and γ."""
    groups = _groups(logs)
    routes = [route for (kind, gas), members in groups.items() for route in _of_gas(kind, gas, members)]
    routes += _gammas(tuple(routes), groups)
    used = {route.name for route in routes}
    reasons = ROUTES | {name: why for log in logs for name, why in log.refused.items()}
    if any(log.excess is not None for log in logs):
        reasons["γ"] = "the heat capacity of the gas with the piston was not measured, or theory is not available"
    refused = {name: why for name, why in reasons.items() if name not in used}
    return HeatCapacity(tuple(routes), refused, tuple(logs), caveats=tuple(_apart(groups)))


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
            words = f"{words}, as in {origin.path}"  # the gases differ in something that the description omits
        groups[kind, words] = members
    return groups


def _apart(groups: Groups) -> Iterator[str]:
    """Yield a caveat for each kind of gas that occurs as several different gases."""
    for kind in dict.fromkeys(kind for kind, _ in groups):
        if len(gases := [gas for kind_of_gas, gas in groups if kind_of_gas == kind]) > 1:
            words = "; ".join(gases)
            yield f"Different gases ({kind}) are analysed separately, each with its own dE/dT and averages: {words}."


def _of_gas(kind: str, gas: str, members: Sequence[Measured]) -> Iterator[HeatCapacityRoute]:
    if (slope := _slope(members)) is not None:
        yield HeatCapacityRoute("dE/dT", kind, slope, gas or None)
    for name in dict.fromkeys(name for m in members for name in m.routes):
        values = [m.routes[name] for m in members if name in m.routes]
        yield HeatCapacityRoute(name, kind, mean_of_replicates(values), gas or None)


def _slope(members: Sequence[Measured]) -> Estimate | None:
    """Return dE/dT per disc from least squares weighted by the errors of E and T; None if all T are nearly the same."""
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
    of_piston = 1.5 / members[0].number if PISTON in members[0].kind else 0.0
    samples = sum(min(m.energy.independent_samples, m.temperature.independent_samples) for m in members)
    theory_error = sum(m.theory_error for m in members) / len(members)
    return Estimate(
        float(slope) - of_piston, float(error), samples, mean_theory([m.theory for m in members]), theory_error
    )


def _gammas(routes: Sequence[HeatCapacityRoute], groups: Groups) -> Iterator[HeatCapacityRoute]:
    """Yield the ratio γ = C_P/C_A for each gas with a piston.

    C_A is taken from logs without a piston if there are any; otherwise C_P - C_A is taken from theory.
    """
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
        yield HeatCapacityRoute("γ", f"{route.kind}: {route.name}", gamma, route.gas)

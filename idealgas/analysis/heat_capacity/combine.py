"""Heat capacities from several logs: slopes of the energy against the temperature, and means over the logs."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from idealgas.analysis.core.fields import OPTIONAL, Key
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, mean_of_replicates, mean_theory
from idealgas.analysis.heat_capacity.measure import BATH, CLOSED, PISTON, ROUGH, Measured

ROUTES = {
    "dE/dT": "it takes logs of one gas at several energies",
    "E/T": "it takes the pressure on the walls of a closed box, in a log with events",
    "Var(E)/T²": "it takes thermal walls of one temperature, or a thermostat",
    "fluctuations of the kinetic energy": "it takes an isolated gas with spin, gravity or a piston",
    "γ": "it takes a piston with a mass",
}
"""Reason why a route does not apply to a set of logs, by the name of the route."""


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


def combine_heat_capacity(logs: Sequence[Measured]) -> HeatCapacity:
    """Combine the logs of each gas: slopes dE/dT, means of the routes of single logs, and γ."""
    groups = _groups(logs)
    routes = [route for (kind, gas), members in groups.items() for route in _of_gas(kind, gas, members)]
    routes += _gammas(tuple(routes), groups)
    used = {route.name for route in routes}
    refused = {name: why for name, why in ROUTES.items() if name not in used}
    return HeatCapacity(tuple(routes), refused, tuple(logs), caveats=tuple(_apart(groups)))


Groups = dict[tuple[str, str], list[Measured]]


def _groups(logs: Sequence[Measured]) -> Groups:
    """Logs by kind of gas and gas in words; the words are empty where all logs of the kind are of one gas."""
    by_digest: dict[tuple[str, str], list[Measured]] = {}
    for log in logs:
        by_digest.setdefault((log.kind, log.origin.gas if log.origin else ""), []).append(log)
    kinds = Counter(kind for kind, _ in by_digest)
    groups: Groups = {}
    for (kind, _), members in by_digest.items():
        origin = members[0].origin
        words = origin.words if origin and kinds[kind] > 1 else ""
        if (kind, words) in groups and origin:
            words = f"{words}, as in {origin.path}"  # gases that differ in what words do not tell
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
    doubt = sum(m.theory_error for m in members) / len(members)
    return Estimate(float(slope) - other, float(error), samples, mean_theory([m.theory for m in members]), doubt)


def _gammas(routes: Sequence[Route], groups: Groups) -> Iterator[Route]:
    """Ratio γ = C_P/C_A: C_A is measured in a log without the piston if there is one, else C_P - C_A is from theory."""
    for route in routes:
        excess = next((m.excess for m in groups[route.kind, route.gas or ""] if m.excess), None)
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
        gamma = Estimate(value, error, c_p.independent_samples, expected)
        yield Route("γ", f"{route.kind}: {route.name}", gamma, route.gas)


def restore_heat_capacity(found: dict[str, Any], label: str) -> Measured:
    """Result of one point of a sweep; it is named by the path of its log, `label` is not needed."""
    return Measured.from_dict(found)

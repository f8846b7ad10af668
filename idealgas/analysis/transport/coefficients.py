"""Viscosities, heat conductivity and pressure tensor of a periodic gas, from the currents of momentum and energy."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from idealgas.analysis.core.composition import Composition
from idealgas.analysis.core.equilibrium import Ensemble
from idealgas.analysis.core.statistics import Estimate, mean
from idealgas.analysis.core.stream import stream
from idealgas.analysis.core.window import Window
from idealgas.analysis.theory.values import Theory
from idealgas.analysis.transport.currents import CARRIED, HEAT_X, HEAT_Y, PASSED_ON, XX, XY, YY, Currents
from idealgas.analysis.transport.enskog import Enskog
from idealgas.analysis.transport.helfand import Lags, growth, lags_of
from idealgas.log import Log

STEPS = 100  # number of steps up to the longest lag
MOST_BLOCKS = 2**18  # of the currents; a longer run has longer steps
PLATEAU_FROM = 0.5  # share of the longest lag from which on a coefficient is averaged

SYMBOLS = {"viscosity": "η", "heat_conductivity": "λ", "bulk_viscosity": "ζ"}
"""Symbols of the coefficients, by their names."""


@dataclass(frozen=True)
class Coefficient:
    """Transport coefficient of the whole gas, by Einstein's and Helfand's route.

    unit: its unit. times: (L,), time. running, running_error: (L,), half the slope of the spread of the current's
    integral after these times, and its standard error, in this unit. value: the coefficient, mean of the running one
    over the plateau; its theory is Enskog's. routes: by the current of each direction alone. difference: of the first
    two routes, 0 in an isotropic gas; None for a single route.
    """

    unit: str
    times: np.ndarray
    running: np.ndarray
    running_error: np.ndarray
    value: Estimate
    routes: dict[str, Estimate]
    difference: Estimate | None

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        return {
            "unit": self.unit,
            "coefficient": self.value.as_dict(),
            "routes": {name: route.as_dict() for name, route in self.routes.items()},
            "difference": self.difference.as_dict() if self.difference else None,
            **{name: getattr(self, name).tolist() for name in ("times", "running", "running_error")},
        }


@dataclass(frozen=True)
class Collective:
    """What the currents of a whole gas tell.

    plateau: first and last time over which coefficients are averaged. coefficients: by name; no heat conductivity for
    several species, where energy also comes along with discs that diffuse. pressure: xx, yy and xy component of the
    pressure tensor, energy/length².
    """

    plateau: tuple[float, float]
    coefficients: dict[str, Coefficient]
    pressure: dict[str, Estimate]

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        return {
            "plateau": list(self.plateau),
            **{name: found.as_dict() for name, found in self.coefficients.items()},
            "pressure_tensor": {name: found.as_dict() for name, found in self.pressure.items()},
        }


def collective(
    log: Log,
    discs: Composition,
    window: Window,
    equilibrium: Ensemble,
    longest: float,
    theory: tuple[Enskog | None, Theory | None],
    progress: Callable[[int, int], None] | None = None,
) -> Collective:
    """Coefficients of the gas of a log in a periodic box, from its events in a window of time.

    longest: lag up to which currents are followed, time. theory: Enskog's coefficients, and Z = PA/NT of this gas.
    """
    blocks = min(round(STEPS * window.duration / longest), MOST_BLOCKS)
    edges = np.linspace(window.start, window.end, blocks + 1)
    currents = Currents()
    stream(log, edges, [currents], progress)
    width = window.duration / blocks
    lags = lags_of(width, longest, PLATEAU_FROM)
    return Collective(
        lags.plateau,
        _coefficients(currents.flow, lags, log.discs.area, equilibrium.temperature, len(discs.name) == 1, theory[0]),
        _pressure(currents.flow / width, log, equilibrium, theory[1]),
    )


def _coefficients(
    flow: np.ndarray, lags: Lags, area: float, temperature: float, conducts: bool, enskog: Enskog | None
) -> dict[str, Coefficient]:
    """Coefficients by name from integrals (B, 2, 5) of the currents; conducts: whether heat goes by conduction only."""
    whole = flow.sum(axis=1).T
    shear = {"xy": whole[XY], "(xx - yy)/2": (whole[XX] - whole[YY]) / 2}
    heat, trace = {"x": whole[HEAT_X], "y": whole[HEAT_Y]}, {"(xx + yy)/2": (whole[XX] + whole[YY]) / 2}
    factor = 1 / (area * temperature)
    found = {"viscosity": _coefficient(shear, lags, factor, "mass/time", enskog.viscosity if enskog else None)}
    if conducts:
        theory = enskog.conductivity if enskog else None
        found["heat_conductivity"] = _coefficient(heat, lags, factor / temperature, "1/time", theory)
    found["bulk_viscosity"] = _coefficient(trace, lags, factor, "mass/time", enskog.bulk_viscosity if enskog else None)
    return found


def _coefficient(
    currents: dict[str, np.ndarray], lags: Lags, factor: float, unit: str, theory: Theory | None
) -> Coefficient:
    found = growth(np.array([*currents.values()]), lags)
    return Coefficient(
        unit,
        lags.times,
        factor * found.running,
        factor * found.error,
        mean(factor * found.series.mean(axis=0), theory),
        {name: mean(factor * series) for name, series in zip(currents, found.series, strict=True)},
        mean(factor * (found.series[0] - found.series[1]), 0.0) if len(currents) > 1 else None,
    )


def _pressure(current: np.ndarray, log: Log, equilibrium: Ensemble, z: Theory | None) -> dict[str, Estimate]:
    """Pressure tensor from currents (B, 2, 5): what discs carry counts as the temperature 2E/D does.

    Along x and along y the theory is Z = PA/NT of a square box.
    """
    gas = log.discs
    square = gas.box[0] == gas.box[1]
    expected = z.times(len(gas) * equilibrium.temperature / gas.area) if z and square else None
    share = 2 * len(gas) / equilibrium.dof
    pressure = (share * current[:, CARRIED] + current[:, PASSED_ON]) / gas.area
    theory = {"xx": expected, "yy": expected, "xy": Theory(0.0, 0.0, "isotropy")}
    return {name: mean(pressure[:, k], theory[name]) for name, k in (("xx", XX), ("yy", YY), ("xy", XY))}

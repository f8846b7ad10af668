"""Viscosities, thermal conductivity and mutual diffusion coefficient of a periodic gas, from its currents."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from idealgas.analysis.transport.enskog import Enskog
from idealgas.analysis.transport.helfand import Lags, growth, lags_of
from idealgas.fields import INLINE, Key
from idealgas.log import Log
from idealgas.state import Gas
from idealgas.statistics.estimates import Estimate, mean
from idealgas.tallies.currents import APART_X, APART_Y, CARRIED, HEAT_X, HEAT_Y, XX, XY, YY, Currents
from idealgas.tallies.equilibration import Window
from idealgas.tallies.samples import in_blocks
from idealgas.tallies.stream import stream
from idealgas.theory.conserved import centre_of_mass_velocity
from idealgas.theory.ensemble import Ensemble
from idealgas.theory.values import Theory

STEPS = 100  # number of steps up to the longest lag
MOST_BLOCKS = 2**18  # largest number of blocks of the currents; in longer runs the steps are longer
PLATEAU_FROM = 0.5  # a coefficient is averaged over lags from this fraction of the longest lag

DIRECTIONS = 3.0
"""Relative difference between η from its two routes for N discs in a square periodic box, times N.

For 50 discs at φ = 0.2, η from the xy current is lower by (5.6 ± 1.1) %.
"""

SYMBOLS = {"viscosity": "η", "thermal_conductivity": "λ", "bulk_viscosity": "ζ", "mutual_diffusion": "D₁₂"}
"""Symbols of the coefficients, by their names."""


@dataclass(frozen=True)
class Coefficient:
    """Transport coefficient of the whole gas, from the Einstein-Helfand relation.

    Attributes:
        unit: unit of the coefficient.
        times: (L,), times t.
        running: (L,), half the slope of the mean square of the integrated current at these times, in `unit`.
        running_error: (L,), standard error of `running`.
        value: the coefficient, which is the mean of `running` over the plateau; compared with Enskog's value.
        routes: the coefficient from the current in each direction alone.
        difference: difference between the first two routes, which is 0 in an isotropic gas; None if there is a single
            route.
    """

    unit: str
    times: np.ndarray
    running: np.ndarray
    running_error: np.ndarray
    value: Annotated[Estimate, Key("coefficient")]
    routes: dict[str, Estimate]
    difference: Estimate | None


@dataclass(frozen=True)
class Collective:
    """Transport coefficients from the currents of a whole gas.

    Attributes:
        plateau: first and last times of the range over which the coefficients are averaged.
        coefficients: coefficients by name. The thermal conductivity is missing if there are several species, because
            diffusing discs then also carry energy, and if the samples of a log without events have no sums of the heat
            current. The mutual diffusion coefficient is given for two species if the log has events.
    """

    plateau: tuple[float, float]
    coefficients: Annotated[dict[str, Coefficient], INLINE]


def flow_in_events(
    log: Log, window: Window, longest: float, progress: Callable[[int, int], None] | None = None
) -> tuple[np.ndarray, float]:
    """Return the integrals of the currents over blocks of a window, (B, 2, 7), from events, and the width of a block.

    Args:
        log: log of the gas.
        window: window of time.
        longest: longest lag up to which currents are followed, time.
        progress: called as progress(done, total) while events are read.
    """
    currents = Currents()
    blocks = min(round(STEPS * window.duration / longest), MOST_BLOCKS)
    stream(log, np.linspace(window.start, window.end, blocks + 1), [currents], progress)
    return currents.flow, window.duration / blocks


def flow_in_samples(log: Log, window: Window, longest: float) -> tuple[np.ndarray, float]:
    """Return the same integrals from the sums in the samples of a log, and the width of a block.

    Blocks are no shorter than the time between two samples. If the log has snapshots, blocks begin and end at
    snapshots, so that the integrals are exact; otherwise the sums are interpolated between samples. The currents of
    species are nan, and so is the heat current if the samples do not contain its sums.
    """
    observed, still = log.observables, centre_of_mass_velocity(log.scene, log.discs)
    edges = _sample_edges(log, window, longest)
    flow = np.full((len(edges) - 1, 2, 7), np.nan)
    for part, (momentum, heat) in enumerate(
        (("kinetic_flow", "kinetic_heat_flow"), ("collision_flow", "collision_heat_flow"))
    ):
        flow[:, part, : YY + 1] = in_blocks(*observed[momentum], edges)[:, : YY + 1]
        if heat in observed:
            flow[:, part, HEAT_X : HEAT_Y + 1] = in_blocks(*observed[heat], edges)
    whole = log.discs.mass.sum() * still[[0, 0, 1]] * still[[0, 1, 1]]  # samples include the motion of the whole gas
    flow[:, CARRIED, : YY + 1] -= np.diff(edges)[:, None] * whole
    return flow, float(edges[1] - edges[0])


def _sample_edges(log: Log, window: Window, longest: float) -> np.ndarray:
    """Return the boundaries (B + 1,) of blocks of equal width in a window, time, at snapshots if there are any."""
    time = log.observables["kinetic_flow"][0]
    inside = (time >= window.start) & (time <= window.end)
    every = log.scene.log.snapshot_every
    if every is None or every > longest:
        every, first = window.duration / (inside.sum() - 1), window.start
    else:
        first = math.ceil(window.start / every) * every
    least = max(longest / STEPS, (window.end - first) / MOST_BLOCKS)
    width = every * max(round(least / every), 1)
    return first + width * np.arange(int((window.end - first) / width * (1 + 1e-12)) + 1)


def collective(
    flow: np.ndarray,
    width: float,
    log: Log,
    equilibrium: Ensemble,
    longest: float,
    theory: tuple[Enskog | None, Theory | None],
) -> Collective:
    """Return the coefficients of a gas in a periodic box, given the integrals of its currents over blocks.

    Args:
        flow: (B, 2, 7), integrals of the currents.
        width: width of a block, time.
        log: log of the gas.
        equilibrium: ensemble of the gas.
        longest: longest lag up to which currents are followed, time.
        theory: Enskog's coefficients, and the theoretical mutual diffusion coefficient of two species.
    """
    lags, gas = lags_of(width, longest, PLATEAU_FROM), log.discs
    conducts = len(gas.species_names) == 1 and not np.isnan(flow[0, CARRIED, HEAT_X])
    coefficients = _coefficients(flow, lags, gas, equilibrium.temperature, conducts, theory[0])
    if len(gas.species_names) == 2 and not np.isnan(flow[0, CARRIED, APART_X]):
        coefficients["mutual_diffusion"] = _mutual_diffusion(flow[:, CARRIED], lags, gas, theory[1])
    return Collective(lags.plateau, coefficients)


def _mutual_diffusion(flow: np.ndarray, lags: Lags, gas: Gas, theory: Theory | None) -> Coefficient:
    """Return the Maxwell–Stefan coefficient of two species from integrals (B, 7) of the currents.

    It is N₁N₂/N times half the slope of the mean square displacement, along one direction, of the mean position of one
    species relative to that of the other: Zhou & Miller, J. Phys. Chem. 100, 5516 (1996). Fick's coefficient equals
    this coefficient times the thermodynamic factor of the mixture.
    """
    first, second = np.bincount(gas.species, minlength=2)
    apart = {"x": flow[:, APART_X], "y": flow[:, APART_Y]}
    return _coefficient(apart, lags, first * second / len(gas), "length²/time", gas, theory)


def _coefficients(
    flow: np.ndarray, lags: Lags, gas: Gas, temperature: float, conducts: bool, enskog: Enskog | None
) -> dict[str, Coefficient]:
    """Return the coefficients by name, given integrals (B, 2, 7) of the currents.

    conducts: whether the thermal conductivity can be measured, see `Collective`.
    """
    whole = flow.sum(axis=1).T
    shear = {"xy": whole[XY], "(xx - yy)/2": (whole[XX] - whole[YY]) / 2}
    heat, trace = {"x": whole[HEAT_X], "y": whole[HEAT_Y]}, {"(xx + yy)/2": (whole[XX] + whole[YY]) / 2}
    factor = 1 / (gas.area * temperature)
    coefficients = {
        "viscosity": _coefficient(shear, lags, factor, "mass/time", gas, enskog.viscosity if enskog else None)
    }
    if conducts:
        theory = enskog.conductivity if enskog else None
        coefficients["thermal_conductivity"] = _coefficient(heat, lags, factor / temperature, "1/time", gas, theory)
    coefficients["bulk_viscosity"] = _coefficient(
        trace, lags, factor, "mass/time", gas, enskog.bulk_viscosity if enskog else None
    )
    return coefficients


def _coefficient(
    currents: dict[str, np.ndarray], lags: Lags, factor: float, unit: str, gas: Gas, theory: Theory | None
) -> Coefficient:
    measured = growth(np.array([*currents.values()]), lags)
    return Coefficient(
        unit,
        lags.times,
        factor * measured.running,
        factor * measured.error,
        mean(factor * measured.series.mean(axis=0), theory),
        {name: mean(factor * series) for name, series in zip(currents, measured.series, strict=True)},
        _difference(factor * measured.series, gas) if len(currents) > 1 else None,
    )


def _difference(series: np.ndarray, gas: Gas) -> Estimate:
    """Return the difference between two routes, given the series of both.

    In a square box the difference vanishes in the limit of many discs; for N discs DIRECTIONS/N counts as the error.
    """
    error = DIRECTIONS / len(gas) * abs(float(series.mean()))
    theory = Theory(0.0, error, "isotropy") if gas.box[0] == gas.box[1] else None
    return mean(series[0] - series[1], theory)

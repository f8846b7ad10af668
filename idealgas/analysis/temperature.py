"""Measure the temperature of each species along each axis, and compare it with equipartition."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result
from idealgas.errors import NotApplicableError
from idealgas.fields import OMITTED, reported
from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates, format_estimate
from idealgas.statistics.estimates import Estimate, mean
from idealgas.tallies.equilibration import Window, measure
from idealgas.tallies.equilibrium import column_temperature, known_ensemble, nonequilibrium_reason, nonstationary_reason
from idealgas.tallies.exchange import with_pistons
from idealgas.tallies.flights import Moments
from idealgas.theory.barometric import DENSEST, column_rates
from idealgas.theory.conserved import conserved_momentum, is_ergodic
from idealgas.theory.ensemble import Ensemble, composition, ensemble_at
from idealgas.theory.values import Theory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CONSERVED = 1e-9
"""Largest relative change in a conserved energy due to rounding; fluctuations exceed it for fewer than 10¹⁸ discs."""

LEAST_RANGE = 0.05
"""Smallest relative range of the temperature axis; rounding errors of a conserved energy are then not visible."""


@dataclass(frozen=True)
class SpeciesTemperature:
    """Temperatures of the discs of one species (energy, k_B = 1), compared with equipartition.

    Attributes:
        species: name of the species.
        number: number of discs of the species.
        x: mean of m vx².
        y: mean of m vy².
        both: mean of m v²/2.
        directions: (B, 2), means of m vx² and m vy² in every block that was read, including blocks before the window.
    """

    species: str
    number: int
    x: Estimate
    y: Estimate
    both: Estimate
    directions: Annotated[np.ndarray, OMITTED]

    @property
    @reported
    def history(self) -> np.ndarray:
        """Mean of m v²/2 in every block that was read, (B,), energy."""
        return self.directions.mean(axis=1)


@dataclass(frozen=True)
class Temperature(Result):
    """Temperatures of each species; if there are several, the last entry is for all discs.

    Attributes:
        window: window of time that was averaged.
        expected: theoretical mean of m v²/2 over all discs, energy; None if theory is not available.
        law: equipartition in this gas, in words; None if theory is not available.
        species: temperatures of each species, followed by those of all discs if there are several species.
    """

    window: Window
    expected: float | None
    law: str | None
    species: tuple[SpeciesTemperature, ...]

    @property
    @reported
    def block_edges(self) -> np.ndarray:
        """Boundaries of the blocks of time that were read, (B + 1,), time."""
        return self.window.edges

    def plain_tables(self) -> list[Table]:
        """Return the table of the temperatures of each species."""
        notes = (str(self.window), f"theory: {self.law or 'none for this scene'}")
        return [estimates("Temperatures (energy, k_B = 1)", self._rows(), notes)]

    def summary(self) -> str:
        """Return the headline: the kinetic energy per disc, and whether all temperatures agree with equipartition."""
        energy = f"The kinetic energy per disc is {format_estimate(self.species[-1].both)} (k_B = 1)"
        return f"{energy}; {agreement(self._rows(), 'equipartition')}."

    def figure(self) -> "Figure":
        """Draw the temperature of each species, or of x and y, against time; times before the window are shaded."""
        from idealgas.presentation.style import GREY, curve_style, panels

        figure, (ax,) = panels(1)
        edges = self.window.edges
        if len(self.species) == 1:
            x, y = self.species[0].directions.T
            curves = {"m vx²": (x, self.species[0].x), "m vy²": (y, self.species[0].y)}
        else:
            curves = {f"{entry.species} (N = {entry.number})": (entry.history, entry.both) for entry in self.species}
        for k, (name, (values, _)) in enumerate(curves.items()):
            colour, line, _ = curve_style(k)
            ax.stairs(values, edges, baseline=None, color=colour, linestyle=line, linewidth=0.9, label=name)
        theories = sorted(
            {(estimate.theory, estimate.theory_error) for _, estimate in curves.values() if estimate.theory is not None}
        )
        for k, (theory, error) in enumerate(theories):
            ax.theory(None, theory, error, "theory" if k == 0 else None)
        if self.window.first:
            ax.axvspan(edges[0], self.window.start, color=GREY, alpha=0.2, linewidth=0, label="left out")
        ax.time_axis()
        ax.set_ylabel("temperature (energy, k_B = 1)")
        low, high = ax.get_ylim()
        middle, reach = (low + high) / 2, max(high - low, LEAST_RANGE * (low + high)) / 2
        ax.set_ylim(middle - reach, middle + reach)
        ax.legend()
        return figure

    def _rows(self) -> list[tuple[str, Estimate]]:
        """Return the names and values of the temperatures of each species: along x, along y, and their mean."""
        return [
            (f"{entry.species}: {direction}", estimate)
            for entry in self.species
            for direction, estimate in (("m vx²", entry.x), ("m vy²", entry.y), ("m v²/2", entry.both))
        ]


def temperature(
    log: Log, start: float | None = None, end: float | None = None, progress: Callable[[int, int], None] | None = None
) -> Temperature:
    """Measure the temperature of each species along each axis between two times of a log.

    According to equipartition, ⟨m vx²⟩ and ⟨m vy²⟩ of a disc are both T = 2E/D, where k_B = 1 and D is the number of
    degrees of freedom. Along an axis along which the total momentum is conserved, the value is T(1 - m/M), where M is
    the mass of all discs.

    Raises:
        UserError: if there are no events in the window, or if no start is given and the gas has no equilibrium.
    """
    if start is None and len(log.scene.properties.temperatures) > 1 and not nonstationary_reason(log):
        raise NotApplicableError(
            f"{log.path}: this analysis requires equilibrium, but {nonequilibrium_reason(log)}; "
            "use `idealgas profile` for T in strips, or --from T to set the start by hand"
        )
    moments = Moments(log.gravity)
    window = measure(log, [moments], start, end, progress)
    discs = composition(log.discs)
    equilibrium, relative = known_ensemble(log), 0.0
    isolated = equilibrium is not None and math.isfinite(equilibrium.dof)
    if equilibrium is None and (column := _column(log)):
        equilibrium, relative = column
    sums, shared = moments.flights[:, :, 1:3] / window.width, is_ergodic(log.scene, log.discs)

    def entry(name: str, chosen: slice) -> SpeciesTemperature:
        """Return the temperatures of the discs of the chosen species."""
        members = discs.number[chosen]
        number = int(members.sum())
        means = sums[:, chosen].sum(axis=1) / number
        x, y = means[window.first :].T
        along_x = along_y = both = None
        axes = np.zeros(2) if equilibrium is None else members @ equilibrium.of_axes[chosen] / number
        if axes.any():  # fixed discs have no temperature
            of_axes = [Theory(t, relative * t, "equipartition") for t in (*axes.tolist(), float(axes.mean()))]
            along_x, along_y = of_axes[:2] if shared else (None, None)
            both = of_axes[2]
        part = np.isin(log.discs.species, np.arange(len(discs.name))[chosen])
        of_x, of_y, energy = (
            with_pistons(mean(series, theory), log, part, window.duration)
            for series, theory in ((x, along_x), (y, along_y), ((x + y) / 2, both))
        )
        if isolated and number == len(log.discs) and np.ptp(x + y) < CONSERVED * (x + y).mean():
            energy = replace(energy, standard_error=0.0, independent_samples=math.inf)  # conserved up to rounding
        return SpeciesTemperature(name, number, of_x, of_y, energy, means)

    entries = [entry(name, slice(s, s + 1)) for s, name in enumerate(discs.name)]
    if len(entries) > 1:
        entries.append(entry("all discs", slice(None)))
    law = None if equilibrium is None else _equipartition(log, equilibrium, relative)
    return Temperature(window, entries[-1].both.theory, law, tuple(entries))


def _column(log: Log) -> tuple[Ensemble, float] | None:
    """Return the ensemble of an isolated column under gravity, and the relative error of its temperature.

    The temperature is that of a dilute gas with the same energy. Because of their finite size, discs lie higher: by
    hydrostatics their potential energy is N T ⟨Z⟩, so that T is lower by a fraction that equals half the packing
    fraction of the lowest layer. Return None if the ensemble is not known.
    """
    gas = composition(log.discs)
    axis = int(log.gravity[1] != 0)
    if not any(log.gravity) or log.gravity[1 - axis] or not log.scene.properties.empty or log.scene.properties.escapes:
        return None
    if log.scene.properties.later_accelerations or (t := column_temperature(log, axis)) is None:
        return None
    sizes = gas.mass, gas.radius, gas.number, abs(log.gravity[axis]), log.box[axis], log.box[1 - axis]
    densest = column_rates(t, *sizes).densest
    return (ensemble_at(log.scene, log.discs, t, math.inf), densest / 2) if densest <= DENSEST else None


def _equipartition(log: Log, equilibrium: Ensemble, relative: float) -> str:
    """Describe equipartition in words: T, where its value comes from, and axes along which momentum is conserved."""
    source = f"2E/D with D = {equilibrium.dof}"
    if relative:
        source = "of a dilute column at fixed energy"
    elif math.isinf(equilibrium.dof):
        source = "of the walls" if log.scene.properties.bath is None else "of the heat bath"
    conserved = [letter for letter, kept in zip("xy", conserved_momentum(log.scene), strict=True) if kept]
    along = f", T(1 - m/M) along {' and '.join(conserved)}" if conserved else ""
    return f"T = {equilibrium.temperature:.6g} ({source}){along}"


class TemperatureAnalysis(Analysis):
    """Declaration of the analysis `temperature`; users see the docstring of the function `temperature`."""

    position = 10
    headline = "species.*.both"
    results = (Temperature,)
    sections = (Section("Temperature", "Kinetic temperature of each species against time"),)

    measure = staticmethod(temperature)

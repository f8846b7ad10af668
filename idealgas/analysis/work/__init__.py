"""Measure the work done by a piston and derive the free energy from Jarzynski's equality and Crooks' theorem.

The strokes of several logs are combined. DIR is the folder of a sweep with the analysis "work".
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.caveats import must_be_one_gas
from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result, RunResult
from idealgas.analysis.work.processes import (
    DIGITS,
    Crossing,
    WorkProcess,
    crossings,
    joined,
    poorly_sampled,
    process,
)
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates, format_estimate
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.equilibrium import must_apply
from idealgas.tallies.stream import ReadProgress, span
from idealgas.theory.free_energy import log_configurations
from idealgas.theory.values import Theory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BINS = 30


@dataclass(frozen=True)
class Work(Result):
    """Work of a piston on a gas in a heat bath.

    Attributes:
        temperature: temperature of the heat bath, energy.
        number: number of discs.
        processes: results for each kind of stroke.
        crossings: crossing of the distributions for each kind of stroke that is also made in reverse.
    """

    temperature: float
    number: int
    processes: tuple[WorkProcess, ...]
    crossings: tuple[Crossing, ...]

    def plain_tables(self) -> list[Table]:
        """Return the tables of work and free energy for each kind of stroke, and of the crossings."""
        rows = [
            (f"{strokes.name}: {name}", estimate)
            for strokes in self.processes
            for name, estimate in (
                ("free energy, −T ln⟨exp(−W/T)⟩", strokes.free_energy),
                ("mean work", strokes.mean_work),
                ("kinetic energy before", strokes.kinetic_energy),
            )
        ]
        tables = [estimates(f"Work and free energy, T = {self.temperature:g}, N = {self.number}", rows)]
        crossings = [
            (f"{strokes.name}: {name}", estimate)
            for strokes in self.crossings
            for name, estimate in (
                ("crossing (energy)", strokes.free_energy),
                ("slope, T d ln(P_F/P_R)/dW", strokes.slope),
            )
        ]
        return [*tables, *([estimates("Work forward and minus work back", crossings)] if crossings else [])]

    def summary(self) -> str:
        """Return the headline: ΔF and mean work of the first kind of stroke, and whether all ΔF agree with theory."""
        rows = [(strokes.name, strokes.free_energy) for strokes in self.processes]
        rows += [(f"crossing {strokes.name}", strokes.free_energy) for strokes in self.crossings]
        first = self.processes[0]
        difference = f"Free energy difference of the strokes {first.name}: {format_estimate(first.free_energy)}"
        return f"{difference}; their mean work is {format_estimate(first.mean_work)}; {agreement(rows)}."

    def figure(self) -> "Figure":
        """Draw the distributions of W and of -W of the reverse strokes, and the ratio of the two."""
        from idealgas.presentation.style import COLOURS, panels

        if not self.crossings:
            figure, axes = panels(len(self.processes))
            for ax, strokes in zip(axes, self.processes, strict=True):
                ax.hist(strokes.work, BINS, density=True, histtype="step", color=COLOURS[0], label=strokes.name)
                _mark(ax, strokes.free_energy)
            return figure
        figure, axes = panels(len(self.crossings), 2)
        for crossing, works, ratio in zip(self.crossings, axes[::2], axes[1::2], strict=True):
            forward, back = crossing.forward, -crossing.back
            edges = np.histogram_bin_edges(np.concatenate((forward, back)), BINS)
            counts = [np.histogram(work[work != 0], edges)[0] for work in (forward, back)]
            names = f"W, {crossing.name}", "−W of the reverse strokes"
            for count, work, colour, label in zip(counts, (forward, back), COLOURS, names, strict=False):
                works.stairs(count / len(work) / np.diff(edges), edges, color=colour, label=label)
                if still := np.count_nonzero(work == 0):  # a discrete value has no density
                    share = f"{100 * still / len(work):.0f} % of {'W' if work is forward else '−W'} are 0"
                    marker = "^" if work is forward else "v"
                    works.plot(0, 0, marker, color=colour, clip_on=False, fillstyle="none", label=share)
            _mark(works, crossing.free_energy)
            middle, (a, b) = _pairs(forward, back, edges)
            logs, error = np.log(a / b * (len(back) / len(forward))), np.sqrt(1 / a + 1 / b)
            ratio.errorbar(middle, logs, error, fmt="o", ms=3, color=COLOURS[0], capsize=2, label="ln(P_F/P_R)")
            if (theory := crossing.free_energy.theory) is not None:
                ends = edges[[0, -1]]
                line, doubt = (ends - theory) / self.temperature, crossing.free_energy.theory_error
                ratio.theory(ends, line, doubt / self.temperature, "theory: (W − ΔF)/T")
            ratio.set(xlabel="W (energy)", ylabel="ratio of the distributions, logarithm (no unit)")
            ratio.legend()
        return figure


class WorkOfRun(RunResult, Work):
    """Work of a piston in one run."""


class WorkAnalysis(Analysis):
    """Work of a piston."""

    position = 115
    headline = "processes.*.free_energy"
    results = (WorkOfRun, Work)
    sections = (
        Section("Work", "Distribution of the work done by the piston forward and back, which cross at the free energy"),
    )
    averages = True
    supports_polydispersity = False
    start = "the log's start"
    reads = "samples"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> WorkOfRun:
        """Measure the work W of each stroke of a piston, and derive the free energy difference ΔF of the gas from it.

        At any speed of the piston, ⟨exp(-W/T)⟩ = exp(-ΔF/T) for strokes that begin in equilibrium with a heat bath
        (Jarzynski, Phys. Rev. Lett. 78, 2690 (1997)), and the distribution of W crosses the distribution of -W of the
        reverse strokes at ΔF (Crooks, Phys. Rev. E 60, 2721 (1999)). A stroke is a motion of the piston that follows a
        rest.

        Raises:
            UserError: if there is not exactly one driven piston, if there is neither a thermostat nor thermal walls at
                a single temperature, or if no stroke lies in the window.
        """
        must_apply(log, 0.0, ("elastic", "collisions_conserve_energy"))
        temperatures = log.scene.properties.temperatures
        if [piston.mass for piston in log.scene.piston] != [None] or len(temperatures) != 1:
            needs = "one piston with prescribed velocities, and a heat bath or thermal walls at one temperature"
            raise NotApplicableError(f"{log.path}: work requires {needs}")
        (piston,) = log.scene.piston
        first, last = span(log, start, end)
        observed, piston_wall = log.observables, [piston_wall.name for piston_wall in log.walls].index(piston.wall)
        time, given = observed["wall_energy"]
        place, energy = observed["piston_position"][1][:, 0], observed["kinetic_energy"][1]
        strokes: dict[tuple[Any, ...], list[tuple[float, float]]] = {}
        for begun, ended, protocol in _strokes(piston.velocity_steps, log.end_time):
            if first <= begun and ended <= last:
                before = int(time.searchsorted(begun, "right")) - 1
                after = min(int(time.searchsorted(ended)), len(time) - 1)
                ends = tuple(round(float(place[k]), DIGITS) for k in (before, after))
                work = float(given[after, piston_wall] - given[before, piston_wall])
                strokes.setdefault((ends, protocol), []).append((work, float(energy[before])))
        if not strokes:
            raise UserError(f"{log.path}: no stroke of the piston after a rest, from t = {first:g} to {last:g}")
        (temperature,), number = temperatures, len(log.discs)
        processes = tuple(
            process(ends, protocol, work, energy, temperature, number, _difference(log, ends, temperature))
            for (ends, protocol), pairs in strokes.items()
            for work, energy in [np.array(pairs).T]
        )
        return WorkOfRun(temperature, number, processes, crossings(processes, temperature))

    @staticmethod
    def combine(results: Sequence[Work]) -> Work:
        """Combine the strokes of one or several runs of the same gas.

        Raises:
            UserError: if the runs are of different gases.
        """
        must_be_one_gas(results)
        kinds: dict[tuple[Any, ...], list[WorkProcess]] = {}
        for strokes in (each for result in results for each in result.processes):
            kinds.setdefault((strokes.ends, strokes.protocol), []).append(strokes)
        temperature, number = results[0].temperature, results[0].number
        processes = tuple(joined(same, temperature, number) for same in kinds.values())
        caveats = tuple(sentence for strokes in processes for sentence in poorly_sampled(strokes, temperature))
        return Work(temperature, number, processes, crossings(processes, temperature), caveats=caveats)


def _pairs(forward: np.ndarray, back: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean work and the numbers of strokes in each bin that contains forward and reverse strokes.

    The mean work (n,) is an energy, and the numbers (2, n) are of forward and of reverse strokes. Strokes with W = 0
    are counted in a separate bin, because no disc may hit the piston.
    """
    works, rows = (forward, back), []
    for low, high in pairwise(edges):
        inside = [work[(work >= low) & (work < high) & (work != 0)] for work in works]
        rows.append((np.concatenate(inside).mean() if all(map(len, inside)) else 0.0, *map(len, inside)))
    rows.append((0.0, *(np.count_nonzero(work == 0) for work in works)))
    place, *counts = np.array(sorted(row for row in rows if all(row[1:])), float).reshape(-1, 3).T
    return place, np.array(counts)


def _mark(ax: Any, free_energy: Estimate) -> None:
    """Draw a line at the free energy in a panel with the distributions of the work."""
    from idealgas.presentation.style import BAND, BLACK

    where, error, label = free_energy.value, free_energy.standard_error, "free energy from the work"
    if free_energy.theory is not None:
        where, error, label = free_energy.theory, free_energy.theory_error, "theoretical free energy"
    ax.axvline(where, linestyle="--", color=BLACK, label=label)
    ax.axvspan(where - error, where + error, color=BLACK, alpha=BAND, linewidth=0)
    ax.set(xlabel="W (energy)", ylabel="distribution of the work (1/energy)")
    ax.legend()


def _strokes(
    steps: Sequence[tuple[float, float]], end: float
) -> Iterator[tuple[float, float, tuple[tuple[float, float], ...]]]:
    """Yield start, end and protocol (durations and velocities) of each motion of the piston that follows a rest."""
    begun, rested = 0.0, False
    pieces: list[tuple[float, float]] = []
    for (time, velocity), (later, _) in pairwise((*(step for step in steps if step[0] < end), (end, 0.0))):
        if velocity and rested:
            begun = begun if pieces else time
            pieces.append((round(later - time, DIGITS), velocity))
        elif not velocity:
            if pieces:
                yield begun, time, tuple(pieces)
            pieces, rested = [], True
    if pieces:
        yield begun, end, tuple(pieces)


def _difference(log: Log, ends: Sequence[float], temperature: float) -> Theory | None:
    """Return the theoretical ΔF between two positions of the piston.

    The result is None if there are walls inside the box or external fields, or if the discs do not fit.
    """
    properties, (piston,) = log.scene.properties, log.scene.piston
    if (
        piston.inner
        or not properties.straight_flight
        or not properties.empty
        or properties.vibrates
        or len(log.walls) > 4
    ):
        return None
    rooms = (piston.model_copy(update={"position": place}).room(log.box) for place in ends)
    before, after = (log_configurations(log.discs, (x1 - x0, y1 - y0), properties.periodic) for x0, y0, x1, y1 in rooms)
    if before is None or after is None:
        return None
    return Theory(-temperature * (after.value - before.value), temperature * abs(after.error - before.error), "")

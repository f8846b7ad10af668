"""Measure the work of a piston and compare it with the free energy, by Jarzynski's equality and Crooks' theorem.

DIR is the folder of a sweep with the analysis "work"; strokes of all runs count together.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from idealgas.analysis.core.analysis import Analysis, Progress, Section
from idealgas.analysis.core.caveats import must_be_one_gas
from idealgas.analysis.core.check import agreement
from idealgas.analysis.core.ensemble import must_apply
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.stream import span
from idealgas.analysis.core.tables import Table, estimates, format_estimate
from idealgas.analysis.theory.free_energy import log_configurations
from idealgas.analysis.theory.values import Theory
from idealgas.analysis.work.processes import (
    DIGITS,
    Crossing,
    Process,
    crossings,
    expectation_of,
    joined,
    poorly_sampled,
    process,
)
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import Log

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BINS = 30


@dataclass(frozen=True)
class Work(Result):
    """Work of a piston on a gas in a heat bath.

    temperature: of the heat bath, energy. number: of discs. processes: strokes of each kind. crossings: of every kind
    of strokes that are also made backwards.
    """

    temperature: float
    number: int
    processes: tuple[Process, ...]
    crossings: tuple[Crossing, ...]


class WorkAnalysis(Analysis):
    """Work of a piston."""

    position = 115
    headline = "processes.*.free_energy"
    results = (Work,)
    sections = (
        Section("Work", "Distribution of the work of the piston forward and back, which cross at the free energy"),
    )
    averages = True
    takes_unlike_discs = False
    start = "the log's start"
    reads = "samples"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: Progress | None = None
    ) -> Work:
        """Measure the work of each stroke of a piston and compare it with the free energy ΔF of the gas.

        Whatever the speed of the piston, ⟨exp(-W/T)⟩ = exp(-ΔF/T) over strokes that begin in equilibrium with a heat
        bath (Jarzynski, Phys. Rev. Lett. 78, 2690 (1997)), and the distributions of the work forward and of minus the
        work back cross at ΔF (Crooks, Phys. Rev. E 60, 2721 (1999)). A stroke is the time in which the velocity of the
        piston is not 0, after a time in which it is.

        Raises:
            UserError: without a single piston, of given velocities, without a thermostat or thermal walls of one
                temperature, or if no stroke lies in the window.
        """
        must_apply(log, 0.0, ("elastic", "collisions_conserve_energy"))
        temperatures = log.scene.properties.temperatures
        if [piston.mass for piston in log.scene.piston] != [None] or len(temperatures) != 1:
            needs = "one piston, of given velocities, and a heat bath or thermal walls of one temperature"
            raise NotApplicableError(f"{log.path}: work requires {needs}")
        (piston,) = log.scene.piston
        first, last = span(log, start, end)
        observed, own = log.observables, [wall.name for wall in log.walls].index(piston.wall)
        time, given = observed["wall_energy"]
        place, energy = observed["piston_position"][1][:, 0], observed["kinetic_energy"][1]
        found: dict[tuple[Any, ...], list[tuple[float, float]]] = {}
        for begun, ended, protocol in _strokes(piston.velocity_steps, log.end_time):
            if first <= begun and ended <= last:
                before = int(time.searchsorted(begun, "right")) - 1
                after = min(int(time.searchsorted(ended)), len(time) - 1)
                ends = tuple(round(float(place[k]), DIGITS) for k in (before, after))
                work = float(given[after, own] - given[before, own])
                found.setdefault((ends, protocol), []).append((work, float(energy[before])))
        if not found:
            raise UserError(f"{log.path}: no stroke of the piston after a rest, from t = {first:g} to {last:g}")
        (temperature,), number = temperatures, len(log.discs)
        processes = tuple(
            process(ends, protocol, work, energy, temperature, number, _difference(log, ends, temperature))
            for (ends, protocol), pairs in found.items()
            for work, energy in [np.array(pairs).T]
        )
        return Work(temperature, number, processes, crossings(processes, temperature))

    @staticmethod
    def combine(results: Sequence[Work]) -> Work:
        """Combine the strokes of one or several runs of one gas.

        Raises:
            UserError: if the runs are of different gases.
        """
        must_be_one_gas(results)
        kinds: dict[tuple[Any, ...], list[Process]] = {}
        for one in (each for result in results for each in result.processes):
            kinds.setdefault((one.ends, one.protocol), []).append(one)
        temperature, number = results[0].temperature, results[0].number
        processes = tuple(joined(same, temperature, number) for same in kinds.values())
        caveats = tuple(sentence for one in processes for sentence in poorly_sampled(one, temperature))
        return Work(temperature, number, processes, crossings(processes, temperature), caveats=caveats)

    @staticmethod
    def restore(found: dict[str, Any], label: str) -> Work:
        """Result of one point of a sweep."""
        processes = []
        for one in found["processes"]:
            theory = expectation_of(Estimate.from_dict(one["free_energy"]))
            ends, protocol = tuple(one["ends"]), tuple(map(tuple, one["protocol"]))
            series = np.array(one["work"]), np.array(one["start_energy"])
            processes.append(process(ends, protocol, *series, found["temperature"], found["number"], theory))
        temperature, number = found["temperature"], found["number"]
        return Work(temperature, number, tuple(processes), crossings(processes, temperature))

    @staticmethod
    def tables(result: Work) -> list[Table]:
        """Tables of work and free energy of each kind of strokes, and of the crossings."""
        rows = [
            (f"{one.name}: {name}", found)
            for one in result.processes
            for name, found in (
                ("free energy, −T ln⟨exp(−W/T)⟩", one.free_energy),
                ("mean work", one.mean_work),
                ("kinetic energy before", one.kinetic_energy),
            )
        ]
        tables = [estimates(f"Work and free energy, T = {result.temperature:g}, N = {result.number}", rows)]
        crossings = [
            (f"{one.name}: {name}", found)
            for one in result.crossings
            for name, found in (("crossing (energy)", one.free_energy), ("slope, T d ln(P_F/P_R)/dW", one.slope))
        ]
        return [*tables, *([estimates("Work forward and minus work back", crossings)] if crossings else [])]

    @staticmethod
    def summary(result: Work) -> str:
        """Free energy of the first kind of strokes, and whether all agree with theory."""
        rows = [(one.name, one.free_energy) for one in result.processes]
        rows += [(f"crossing {one.name}", one.free_energy) for one in result.crossings]
        first = result.processes[0]
        found = f"Free energy difference of the strokes {first.name}: {format_estimate(first.free_energy)}"
        return f"{found}; their mean work is {format_estimate(first.mean_work)}; {agreement(rows)}."

    @staticmethod
    def figure(result: Work) -> "Figure":
        """Picture of the distributions of the work forward and of minus the work back, and of their ratio."""
        from idealgas.analysis.core.style import COLOURS, panels

        if not result.crossings:
            figure, axes = panels(len(result.processes))
            for ax, one in zip(axes, result.processes, strict=True):
                ax.hist(one.work, BINS, density=True, histtype="step", color=COLOURS[0], label=one.name)
                _mark(ax, one.free_energy)
            return figure
        figure, axes = panels(len(result.crossings), 2)
        for crossing, works, ratio in zip(result.crossings, axes[::2], axes[1::2], strict=True):
            forward, back = crossing.forward, -crossing.back
            edges = np.histogram_bin_edges(np.concatenate((forward, back)), BINS)
            counts = [np.histogram(work[work != 0], edges)[0] for work in (forward, back)]
            names = f"W, {crossing.name}", "−W of the reverse strokes"
            for count, work, colour, label in zip(counts, (forward, back), COLOURS, names, strict=False):
                works.stairs(count / len(work) / np.diff(edges), edges, color=colour, label=label)
                if still := np.count_nonzero(work == 0):  # an atom, which has no density
                    share = f"{100 * still / len(work):.0f} % of {'W' if work is forward else '−W'} are 0"
                    marker = "^" if work is forward else "v"
                    works.plot(0, 0, marker, color=colour, clip_on=False, fillstyle="none", label=share)
            _mark(works, crossing.free_energy)
            middle, (a, b) = _pairs(forward, back, edges)
            logs, error = np.log(a / b * (len(back) / len(forward))), np.sqrt(1 / a + 1 / b)
            ratio.errorbar(middle, logs, error, fmt="o", ms=3, color=COLOURS[0], capsize=2, label="ln(P_F/P_R)")
            if (theory := crossing.free_energy.theory) is not None:
                ends = edges[[0, -1]]
                line, doubt = (ends - theory) / result.temperature, crossing.free_energy.theory_error
                ratio.theory(ends, line, doubt / result.temperature, "theory: (W − ΔF)/T")
            ratio.set(xlabel="W (energy)", ylabel="ratio of the distributions, logarithm (no unit)")
            ratio.legend()
        return figure


def _pairs(forward: np.ndarray, back: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Works (n,) and numbers (2, n) of strokes forward and back in the bins that have both, energy.

    Strokes without work are a value of their own, as no disc may meet the piston. The place of a bin is the mean of its
    works.
    """
    works, rows = (forward, back), []
    for low, high in pairwise(edges):
        inside = [work[(work >= low) & (work < high) & (work != 0)] for work in works]
        rows.append((np.concatenate(inside).mean() if all(map(len, inside)) else 0.0, *map(len, inside)))
    rows.append((0.0, *(np.count_nonzero(work == 0) for work in works)))
    place, *counts = np.array(sorted(row for row in rows if all(row[1:])), float).reshape(-1, 3).T
    return place, np.array(counts)


def _mark(ax: Any, free_energy: Estimate) -> None:
    """A line at the free energy in a panel of distributions of the work."""
    from idealgas.analysis.core.style import BAND, BLACK

    where, error, label = free_energy.value, free_energy.standard_error, "free energy by the work"
    if free_energy.theory is not None:
        where, error, label = free_energy.theory, free_energy.theory_error, "free energy by theory"
    ax.axvline(where, linestyle="--", color=BLACK, label=label)
    ax.axvspan(where - error, where + error, color=BLACK, alpha=BAND, linewidth=0)
    ax.set(xlabel="W (energy)", ylabel="distribution of the work (1/energy)")
    ax.legend()


def _strokes(
    steps: Sequence[tuple[float, float]], end: float
) -> Iterator[tuple[float, float, tuple[tuple[float, float], ...]]]:
    """Start, end and protocol (pieces of time and velocity) of each motion that follows a rest."""
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
    """ΔF between two positions of the piston by theory; None with walls inside, a field or discs that do not fit."""
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

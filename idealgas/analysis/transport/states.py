"""Transport coefficients of several logs, or of the points of a sweep, against the packing fraction."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.caveats import by_state, name_of_state, seeds_of
from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result
from idealgas.analysis.transport.coefficients import SYMBOLS
from idealgas.analysis.transport.result import Transport
from idealgas.fields import Key
from idealgas.presentation.tables import THEORY_ERROR, Cell, Number, Table, format_estimate, with_error
from idealgas.statistics.estimates import Estimate, mean_of_replicates

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DIFFUSION = "D"
"""Symbol of the diffusion coefficient of a single species."""


@dataclass(frozen=True)
class TransportState:
    """Transport coefficients at one packing fraction and one number of discs, averaged over runs of one kind of gas.

    Attributes:
        name: φ, N, seeds and kind of gas in words.
        packing_fraction: packing fraction φ.
        number: number of discs.
        kind: kind of gas in words; empty if unknown.
        runs: number of runs.
        seeds: seeds of the runs.
        coefficients: coefficients in units of Enskog's values, by symbol (no unit).
    """

    name: str
    packing_fraction: float
    number: int
    kind: Annotated[str, Key("gas")]
    runs: int
    seeds: tuple[int, ...]
    coefficients: Annotated[dict[str, Estimate], Key("over_enskog")]


@dataclass(frozen=True)
class TransportStates(Result):
    """Transport coefficients in units of Enskog's values, for each state in order of φ."""

    states: tuple[TransportState, ...]

    def plain_tables(self) -> list[Table]:
        """Return the table of the coefficients of each state."""
        rows: list[tuple[Cell, ...]] = [
            (
                f"{symbol} at φ = {state.packing_fraction:.5g}",
                Number(state.number, "d"),
                Number(state.runs, "d"),
                *with_error(estimate.value, estimate.standard_error),
                Number(estimate.theory_error, ".2g"),
                Number(estimate.deviation, "+.2f"),
            )
            for state in self.states
            for symbol, estimate in state.coefficients.items()
        ]
        heads = ("", "N", "runs", "value", "± s.e.", THEORY_ERROR, "deviation (σ)")
        return [Table("Transport coefficients over Enskog's", heads, rows)]

    def summary(self) -> str:
        """Return the headline: coefficients of the densest state, and whether all coefficients agree with theory."""
        rows = [
            (f"{symbol} at φ = {state.packing_fraction:.5g}", estimate)
            for state in self.states
            for symbol, estimate in state.coefficients.items()
        ]
        last = self.states[-1]
        values = ", ".join(f"{symbol} = {format_estimate(value)}" for symbol, value in last.coefficients.items())
        values = values or "no coefficient has a theory"
        densest = f"At φ = {last.packing_fraction:.5g}, in units of Enskog's values, {values}"
        return f"{densest}; {agreement(rows, 'Enskog')}."

    def figure(self) -> "Figure":
        """Draw the coefficients in units of Enskog's values against φ, or against N if all logs have the same φ."""
        from idealgas.analysis.transport.figure import draw_band
        from idealgas.presentation.style import COLOURS, GREY, panels

        figure, (ax,) = panels(1)
        by_number = len({round(state.packing_fraction, 9) for state in self.states}) == 1 < len(self.states)
        for symbol, colour in zip((DIFFUSION, *SYMBOLS.values()), COLOURS, strict=False):
            shown = [state for state in self.states if symbol in state.coefficients]
            measured = [state.coefficients[symbol] for state in shown]
            places = [state.number if by_number else state.packing_fraction for state in shown]
            values, errors, of_theory = (
                np.array([getattr(estimate, name) for estimate in measured])
                for name in ("value", "standard_error", "theory_error")
            )
            if shown:
                ax.errorbar(places, values, errors, fmt="o-", ms=4, capsize=3, color=colour, label=symbol)
                draw_band(ax, places, np.ones(len(shown)), of_theory, colour)
        ax.axhline(1.0, color=GREY, linewidth=0.8, label="Enskog's theory, bands: its errors")
        ax.set(xlabel="packing fraction φ (no unit)", ylabel="coefficient over Enskog's (no unit)")
        if by_number:
            numbers = [state.number for state in self.states]
            ax.set_xscale("log")
            ax.set_xticks(numbers, [str(number) for number in numbers])
            ax.minorticks_off()
            ax.set_xlabel("number of discs")
        ax.legend()
        return figure


def transport_states(results: Sequence[Transport]) -> TransportStates:
    """Return the coefficients of several runs, averaged over runs with the same kind of gas, φ and N.

    The coefficients are in units of Enskog's values.
    """
    return TransportStates(tuple(_state(kind, runs) for kind, runs in by_state(results)))


def _over_theory(result: Transport) -> dict[str, Estimate]:
    """Return the coefficients of a run for which theory is available, in units of the theoretical values, by symbol."""
    alone = result.diffusion[0].coefficient if len(result.diffusion) == 1 else None
    coefficients = {DIFFUSION: alone} if alone else {}
    if result.collective:
        coefficients |= {
            SYMBOLS[name]: coefficient.value for name, coefficient in result.collective.coefficients.items()
        }
    return {symbol: estimate.times(1 / estimate.theory) for symbol, estimate in coefficients.items() if estimate.theory}


def _state(kind: str, runs: Sequence[Transport]) -> TransportState:
    """Return the means over the runs of one state, for coefficients that every run has."""
    first, *others = measured = [_over_theory(run) for run in runs]
    symbols = [symbol for symbol in first if all(symbol in coefficients for coefficients in others)]
    means = {symbol: mean_of_replicates([coefficients[symbol] for coefficients in measured]) for symbol in symbols}
    phi, number, seeds = runs[0].packing_fraction, runs[0].number, seeds_of(runs)
    return TransportState(name_of_state(phi, number, kind, seeds), phi, number, kind, len(runs), seeds, means)

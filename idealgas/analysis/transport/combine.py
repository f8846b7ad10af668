"""Transport coefficients of several logs, or of the points of a sweep, against the packing fraction."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from idealgas.analysis.core.caveats import by_state, name_of_state, seeds_of
from idealgas.analysis.core.fields import Key
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, mean_of_replicates
from idealgas.analysis.transport.coefficients import SYMBOLS
from idealgas.analysis.transport.measure import Transport

DIFFUSION = "D"
"""Symbol of the diffusion coefficient of a single species."""


@dataclass(frozen=True)
class Sample(Result):
    """Transport coefficients of one run over Enskog's, by their symbols.

    packing_fraction: φ. number: of discs. coefficients: those that the run and theory have (no unit).
    """

    packing_fraction: float
    number: int
    coefficients: dict[str, Estimate]


@dataclass(frozen=True)
class State:
    """Transport coefficients at one packing fraction and one number of discs, means over runs of one kind of gas.

    name: φ, N, seeds and kind of gas in words. packing_fraction: φ. number: of discs. kind: kind of gas in words; empty
    if unknown. runs: number of runs. seeds: of the runs. coefficients: over Enskog's, by symbol (no unit).
    """

    name: str
    packing_fraction: float
    number: int
    kind: Annotated[str, Key("gas")]
    runs: int
    seeds: tuple[int, ...]
    coefficients: Annotated[dict[str, Estimate], Key("over_enskog")]


@dataclass(frozen=True)
class States(Result):
    """Transport coefficients over Enskog's, state by state in order of φ."""

    states: tuple[State, ...]


def combine_transport(results: Sequence[Transport | Sample]) -> Transport | States:
    """Transport in the gas of a single log, or the coefficients of several logs or of a sweep."""
    if len(results) == 1 and isinstance(results[0], Transport):
        return results[0]
    samples = (_sample_of(found) if isinstance(found, Transport) else found for found in results)
    return States(tuple(_state(kind, runs) for kind, runs in by_state(samples)))


def restore_transport(found: dict[str, Any], label: str) -> Sample:
    """Coefficients of one point of a sweep, whose name is `label`."""
    whole, diffusion = found["collective"] or {}, found["diffusion"]
    coefficients = {DIFFUSION: diffusion[0]["coefficient"]} if len(diffusion) == 1 else {}
    coefficients |= {symbol: whole[name]["coefficient"] for name, symbol in SYMBOLS.items() if name in whole}
    estimates = {symbol: Estimate.from_dict(one) for symbol, one in coefficients.items() if one}
    return Sample(found["packing_fraction"], found["number"], _over_theory(estimates))


def _sample_of(found: Transport) -> Sample:
    alone = found.diffusion[0].coefficient if len(found.diffusion) == 1 else None
    coefficients = {DIFFUSION: alone} if alone else {}
    if found.collective:
        coefficients |= {SYMBOLS[name]: one.value for name, one in found.collective.coefficients.items()}
    return Sample(found.packing_fraction, found.number, _over_theory(coefficients), origin=found.origin)


def _over_theory(coefficients: dict[str, Estimate]) -> dict[str, Estimate]:
    """Coefficients that have a theory, in units of it."""
    return {symbol: one.times(1 / one.theory) for symbol, one in coefficients.items() if one.theory}


def _state(kind: str, runs: Sequence[Sample]) -> State:
    """Mean over runs of one state, of all coefficients that every run has."""
    symbols = [symbol for symbol in runs[0].coefficients if all(symbol in run.coefficients for run in runs)]
    means = {symbol: mean_of_replicates([run.coefficients[symbol] for run in runs]) for symbol in symbols}
    phi, number, seeds = runs[0].packing_fraction, runs[0].number, seeds_of(runs)
    return State(name_of_state(phi, number, kind, seeds), phi, number, kind, len(runs), seeds, means)

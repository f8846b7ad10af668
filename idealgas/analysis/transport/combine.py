"""Transport coefficients of several logs, or of the points of a sweep, against the packing fraction."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from idealgas.analysis.caveats import by_state, name_of_state, seeds_of
from idealgas.analysis.result import Result
from idealgas.analysis.transport.coefficients import SYMBOLS
from idealgas.analysis.transport.measure import Transport
from idealgas.fields import Key
from idealgas.statistics.estimates import Estimate, mean_of_replicates

DIFFUSION = "D"
"""Symbol of the diffusion coefficient of a single species."""


@dataclass(frozen=True)
class TransportSample(Result):
    """Transport coefficients of one run over Enskog's, by their symbols.

    Attributes:
        packing_fraction: packing fraction φ.
        number: number of discs.
        coefficients: coefficients that the run measured and theory predicts, over theory (no unit).
    """

    packing_fraction: float
    number: int
    coefficients: dict[str, Estimate]


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
        coefficients: coefficients over Enskog's, by symbol (no unit).
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

    states: tuple[TransportState, ...]


def combine_transport(results: Sequence[Transport | TransportSample]) -> Transport | States:
    """Return the transport in the gas of a single log, or the coefficients of several logs or points of a sweep."""
    if len(results) == 1 and isinstance(results[0], Transport):
        return results[0]
    samples = (_sample_of(result) if isinstance(result, Transport) else result for result in results)
    return States(tuple(_state(kind, runs) for kind, runs in by_state(samples)))


def restore_transport(values: dict[str, Any], label: str) -> TransportSample:
    """Return the coefficients of the point of a sweep that is named `label`, from its stored values."""
    whole, diffusion = values["collective"] or {}, values["diffusion"]
    coefficients = {DIFFUSION: diffusion[0]["coefficient"]} if len(diffusion) == 1 else {}
    coefficients |= {symbol: whole[name]["coefficient"] for name, symbol in SYMBOLS.items() if name in whole}
    estimates = {symbol: Estimate.from_dict(estimate) for symbol, estimate in coefficients.items() if estimate}
    return TransportSample(values["packing_fraction"], values["number"], _over_theory(estimates))


def _sample_of(result: Transport) -> TransportSample:
    alone = result.diffusion[0].coefficient if len(result.diffusion) == 1 else None
    coefficients = {DIFFUSION: alone} if alone else {}
    if result.collective:
        coefficients |= {
            SYMBOLS[name]: coefficient.value for name, coefficient in result.collective.coefficients.items()
        }
    return TransportSample(result.packing_fraction, result.number, _over_theory(coefficients), origin=result.origin)


def _over_theory(coefficients: dict[str, Estimate]) -> dict[str, Estimate]:
    """Return the coefficients that have a theory, in units of it."""
    return {symbol: estimate.times(1 / estimate.theory) for symbol, estimate in coefficients.items() if estimate.theory}


def _state(kind: str, runs: Sequence[TransportSample]) -> TransportState:
    """Return the mean over the runs of one state, for all coefficients that every run has."""
    symbols = [symbol for symbol in runs[0].coefficients if all(symbol in run.coefficients for run in runs)]
    means = {symbol: mean_of_replicates([run.coefficients[symbol] for run in runs]) for symbol in symbols}
    phi, number, seeds = runs[0].packing_fraction, runs[0].number, seeds_of(runs)
    return TransportState(name_of_state(phi, number, kind, seeds), phi, number, kind, len(runs), seeds, means)

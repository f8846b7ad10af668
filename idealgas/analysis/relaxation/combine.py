"""Relaxation of several gases, log by log."""

from collections.abc import Sequence
from dataclasses import dataclass

from idealgas.analysis.core.result import Result
from idealgas.analysis.relaxation.measure import Relaxation


@dataclass(frozen=True)
class Relaxations(Result):
    """Relaxation of the gas of each log."""

    logs: tuple[Relaxation, ...]


def combine_relaxation(results: Sequence[Relaxation]) -> Relaxations:
    """Combine the relaxation of several logs, in their order."""
    return Relaxations(tuple(results))

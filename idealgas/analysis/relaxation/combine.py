"""Relaxations of several gases side by side."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from idealgas.analysis.relaxation.measure import Relaxation


@dataclass(frozen=True)
class Relaxations:
    """What was seen in each log."""

    logs: tuple[Relaxation, ...]

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"logs": [found.as_dict() for found in self.logs]}


def combine_relaxation(results: Sequence[Relaxation]) -> Relaxations:
    """One log after another."""
    return Relaxations(tuple(results))

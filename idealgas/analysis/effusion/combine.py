"""Gases that leave through a slit: runs of one kind together."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from idealgas.analysis.core.statistics import Estimate, mean_of_replicates
from idealgas.analysis.effusion.measure import Effusion


@dataclass(frozen=True)
class Effusions:
    """groups: runs that differ in their seeds alone, by their name; together: the mean of their flux over density."""

    groups: dict[str, tuple[Effusion, ...]]
    together: dict[str, Estimate]

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {name: estimate.as_dict() for name, estimate in self.together.items()}


def combine_effusion(results: Sequence[Effusion]) -> Effusions:
    """Put runs of one name together."""
    names = dict.fromkeys(found.name for found in results)
    groups = {name: tuple(found for found in results if found.name == name) for name in names}
    together = {name: mean_of_replicates([found.speed for found in runs]) for name, runs in groups.items()}
    return Effusions(groups, together)


def restore_effusion(found: dict[str, Any], label: str) -> Effusion:
    """A point of a sweep, named by the values of its axes."""
    return Effusion.from_dict(found, label)

"""Flow of gases through a slit: runs of the same gas combined, and their table."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from idealgas.analysis.core.fields import INLINE, OMITTED
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, mean_of_replicates
from idealgas.analysis.core.tables import Table, estimates
from idealgas.analysis.effusion.measure import Effusion
from idealgas.errors import UserError


@dataclass(frozen=True)
class Effusions(Result):
    """Flow through a slit in groups of runs that differ only in their seeds.

    groups: runs of each group, by its name. together: mean flux over density of each group, length/time.
    """

    groups: Annotated[dict[str, tuple[Effusion, ...]], OMITTED]
    together: Annotated[dict[str, Estimate], INLINE]


def combine_effusion(results: Sequence[Effusion]) -> Effusions:
    """Combine runs of the same name into groups and average their flux.

    Raises:
        UserError: if runs of one name are of different gases.
    """
    names = dict.fromkeys(found.name for found in results)
    groups = {name: tuple(found for found in results if found.name == name) for name in names}
    for name, runs in groups.items():
        if len(gases := {run.origin.gas: run.origin.words for run in runs if run.origin is not None}) > 1:
            raise UserError(f"{name}: different gases under one name ({'; '.join(gases.values())}): analyse them apart")
    together = {name: mean_of_replicates([found.speed for found in runs]) for name, runs in groups.items()}
    return Effusions(groups, together)


def restore_effusion(found: dict[str, Any], label: str) -> Effusion:
    """Result of one point of a sweep, named by `label`, the values of its axes."""
    return Effusion.from_dict(found, label)


def effusion_tables(found: Effusions) -> list[Table]:
    """Table of the flux over density of each gas, length/time."""
    return [estimates("Flux over density (length/time), theory ⟨v⟩/π", found.together.items())]

"""Thermostats that leave no time for anything but kicks."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.scene.defaults import number_of_discs
from idealgas.toml.error import Issue

if TYPE_CHECKING:
    from idealgas.scene.tables.document import Document

MOST_KICKS = 1e10
"""Bound on the kicks of a run: hours."""


def issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """A rate at which the kicks of a run with an end in time do not end."""
    thermostat, until = scene.thermostat, scene.run.until if scene.run else None
    if thermostat is None or until is None or invalid:
        return
    kicks = thermostat.rate * until * number_of_discs(scene.species, scene.disc)
    if kicks > MOST_KICKS:
        allowed = f"<= {MOST_KICKS:g}, by a rate <= {thermostat.rate * MOST_KICKS / kicks:.3g}"
        yield Issue((("thermostat", "rate"), ("run", "until")), "too many kicks", f"about {kicks:.3g}", allowed)

"""Discs that do not interact: they collide with walls and pistons, but never with each other."""

from pydantic import Field

from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.toml.table import Table


class InteractionsTable(Table):
    """`[interactions]`: discs that do not interact are many starts of one billiard, or an ideal gas."""

    discs: bool = Field(default=True, description="whether discs collide with each other")


class NonInteractingEffect(Effect[bool]):
    """Discs that do not interact."""

    name = "non-interacting discs"
    field = "noninteracting"
    key = "interactions"
    table = InteractionsTable
    description = "[interactions]: discs"
    samples = (BenchmarkSample(tables=lambda side: "[interactions]\ndiscs = false\n"),)
    sample_together = BenchmarkSample()

    def properties(self, tables: Tables) -> Properties | None:
        if tables.table.discs:
            return None
        return Properties(interacting=False, allows_monte_carlo=False, allows_time_steps=False)

    def make(self, tables: Tables, start: GasAtStart) -> bool:
        return True


EFFECT = NonInteractingEffect()

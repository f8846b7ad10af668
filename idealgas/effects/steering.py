"""Velocities that are changed from outside: reversed at given times, or set by a program."""

from collections.abc import Iterable, Iterator

from pydantic import Field

from idealgas.columns import Kind
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.effects.schedule import Change, Times, as_times, without_past
from idealgas.toml.issues import Issue
from idealgas.toml.table import Table


class SteeringTable(Table):
    """`[steering]`: velocities are changed from outside, at given times or by a Python program (`idealgas.open_run`).

    After all velocities and spins are reversed, an elastic gas retraces its path.
    """

    reversed_at: Times | None = Field(
        default=None, description="time > 0, or list of times, at which all velocities and spins are reversed"
    )

    def after(self, time: float) -> "SteeringTable":
        """Return the table for a scene whose clock starts at a later time."""
        return self.model_copy(update={"reversed_at": without_past(self.reversed_at, time)})


class SteeringEffect(Effect[tuple[float, ...]]):
    """Velocities that are changed from outside: reversed at given times, or set by a program."""

    name = "steering"
    field = "steering"
    key = "steering"
    table = SteeringTable
    description = "[steering]: reversed_at"
    events = Kind.STEERED
    samples = (BenchmarkSample(tables=lambda side: "[steering]\nreversed_at = 1\n"),)

    def properties(self, tables: Tables) -> Properties:
        return Properties(
            allows_monte_carlo=False, allows_time_steps=False, varies=True, changes=as_times(tables.table.reversed_at)
        )

    def check(self, tables: Tables) -> Iterator[Issue]:
        times = as_times(tables.table.reversed_at)
        if sorted(set(times)) != list(times) or 0 in times:
            yield Issue((("steering", "reversed_at"),), "not in order", str(list(times)), "increasing times > 0")

    def exists(self, tables: Tables, start: GasAtStart) -> bool:
        """Return whether the discs are steered, either by `[steering]` or by steps of gravity."""
        return tables.table is not None or bool(start.later_accelerations)

    def make(self, tables: Tables, start: GasAtStart) -> tuple[float, ...]:
        """Return the times of the reversals; an empty tuple if only gravity steers the discs."""
        return () if tables.table is None else as_times(tables.table.reversed_at)

    def schedule(self, tables: Tables, start: GasAtStart) -> Iterable[Change]:
        return (Change(time, 0, 0.0) for time in as_times(tables.table.reversed_at))


EFFECT = SteeringEffect()

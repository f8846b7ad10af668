"""Gravity: a uniform acceleration of all discs, which may change in steps."""

import math
from collections.abc import Iterator

import numpy as np
from pydantic import Field

from idealgas.columns import Column
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.effects.schedule import Change, SteppedTable, VectorInSteps, steps_of
from idealgas.physics import gravity as law
from idealgas.state import Gas
from idealgas.toml.issues import Issue, Key


class GravityTable(SteppedTable):
    """`[gravity]`: a uniform acceleration of all discs."""

    in_steps = ("acceleration",)

    acceleration: VectorInSteps = Field(description="[gx, gy], length/time², or steps [[0, [gx, gy]], [t, …], …]")

    @property
    def steps(self) -> tuple[tuple[float, tuple[float, float]], ...]:
        """Pairs of a time and the acceleration that holds from this time on."""
        return steps_of(self.acceleration)


class GravityEffect(Effect[law.Gravity]):
    """Gravity: a uniform acceleration of all discs, which may change in steps."""

    name = "gravity"
    field = "gravity"
    key = "gravity"
    table = GravityTable
    description = "[gravity]: acceleration"
    energy_part = "potential"
    energy_column = Column("potential_energy", "f8", (), "energy")
    samples = (BenchmarkSample(tables=lambda side: f"[gravity]\nacceleration = [0, {-1 / side!r}]\n"),)

    def properties(self, tables: Tables) -> Properties:
        (_, first), *later = steps_of(tables.table.acceleration)
        return Properties(
            uniform=False,
            straight_flight=False,
            allows_monte_carlo=False,
            drives_discs=True,
            allows_time_steps=not later,
            acceleration=first,
            later_accelerations=tuple(acceleration for _, acceleration in later),
            changes=tuple(time for time, _ in later),
            varies=bool(later),
        )

    def check(self, tables: Tables) -> Iterator[Issue]:
        """Yield an issue if the acceleration is always zero."""
        key: Key = ("gravity", "acceleration")
        steps = [acceleration for _, acceleration in steps_of(tables.table.acceleration)]
        if not any(map(any, steps)):
            yield Issue((key,), "no acceleration", str(list(steps[0])), "a nonzero acceleration, or no [gravity]")

    def exists(self, _: Tables, start: GasAtStart) -> bool:
        """Return whether the discs are accelerated, by `[gravity]` or by another effect."""
        return any(start.acceleration) or bool(start.later_accelerations)

    def make(self, _: Tables, start: GasAtStart) -> law.Gravity:
        """Return the acceleration of the discs, summed over all effects."""
        return law.Gravity(*start.acceleration)

    def driving_speed(self, gravity: law.Gravity, gas: Gas) -> float:
        return math.sqrt(math.hypot(*gravity) * sum(gas.box))

    def energy(self, gravity: law.Gravity, gas: Gas, _: float) -> float:
        """Return the potential energy.

        If gravity acts along a periodic axis, the decrease in this energy is the work done on the flowing gas.
        """
        return -float((gas.mass * (gas.position @ np.array(gravity))).sum())

    def schedule(self, tables: Tables, _: GasAtStart) -> Iterator[Change]:
        """Yield the changes of the acceleration along x (item 0) and along y (item 1)."""
        for time, acceleration in steps_of(tables.table.acceleration)[1:]:
            yield from (Change(time, axis, component) for axis, component in enumerate(acceleration))

    def change(self, gravity: law.Gravity, axis: int, component: float) -> law.Gravity:
        return gravity._replace(**{"xy"[axis]: component})


EFFECT = GravityEffect()

"""A thermostat: a heat bath that gives discs new velocities at random times."""

import math
from collections.abc import Iterable

import numpy as np
from pydantic import Field

from idealgas.columns import Arrays, Column, Kind
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.effects.schedule import Change, PositiveInSteps, SteppedTable, changes_of, steps_of, value_at
from idealgas.physics import thermostat as law
from idealgas.state import Gas
from idealgas.toml.table import Positive

NEXT_THERMOSTAT_COLLISION = Column("next_thermostat_collision", "f8", (), "time")
"""Time of a disc's next collision with the bath, counted from the checkpoint."""
THERMOSTAT_COLLISION_NUMBER = Column("thermostat_collision_number", "u8")
"""Index of a disc's next collision with the bath, from 0."""


class ThermostatTable(SteppedTable):
    """`[thermostat]`: a heat bath gives each disc a new velocity at random times, wherever the disc is.

    The velocity, and the spin of a disc that has one, are drawn from the equilibrium distribution at the bath's
    temperature (Andersen, J. Chem. Phys. 72, 2384 (1980)).
    """

    in_steps = ("temperature",)

    temperature: PositiveInSteps = Field(
        description="temperature > 0 of the heat bath, energy, or steps [[0, T], [t, T], …]"
    )
    rate: Positive = Field(description="rate > 0 at which each disc collides with the heat bath, 1/time")


class ThermostatEffect(Effect[law.Thermostat]):
    """A thermostat: a heat bath that gives discs new velocities at random times."""

    name = "thermostat"
    field = "thermostat"
    key = "thermostat"
    table = ThermostatTable
    description = "[thermostat]: temperature, rate"
    events = Kind.THERMOSTAT
    shearable = True
    samples = (BenchmarkSample(tables=lambda side: "[thermostat]\ntemperature = 1\nrate = 0.053\n"),)

    def properties(self, tables: Tables) -> Properties:
        first, *later = steps_of(tables.table.temperature)
        return Properties(
            allows_monte_carlo=False,
            allows_time_steps=False,
            drives_discs=True,
            bath=first[1],
            later_temperatures=tuple(temperature for _, temperature in later),
            changes=tuple(time for time, _ in later),
            varies=bool(later),
            thermostat_rate=tables.table.rate,
        )

    def make(self, tables: Tables, start: GasAtStart) -> law.Thermostat:
        table, n = tables.table, len(start.gas)
        temperature = value_at(table.temperature, 0.0)
        thermostat = law.Thermostat(temperature, table.rate, np.uint64(start.seed), np.empty(n), np.zeros(n, np.uint64))
        law.draw_first_collisions(thermostat)
        return thermostat

    def disc_state(self, thermostat: law.Thermostat) -> Arrays:
        return {
            NEXT_THERMOSTAT_COLLISION: thermostat.time,
            THERMOSTAT_COLLISION_NUMBER: thermostat.number,
        }

    def driving_speed(self, thermostat: law.Thermostat, gas: Gas) -> float:
        fastest = math.sqrt(float((gas.velocity[:, 0] ** 2 + gas.velocity[:, 1] ** 2).max()))
        return max(math.sqrt(thermostat.temperature / float(gas.mass.min())) - fastest, 0.0)

    def end_epoch(self, thermostat: law.Thermostat, length: float) -> None:
        law.end_epoch(thermostat, length)

    def schedule(self, tables: Tables, start: GasAtStart) -> Iterable[Change]:
        return changes_of(tables.table.temperature, 0)

    def change(self, thermostat: law.Thermostat, item: int, temperature: float) -> law.Thermostat:
        return thermostat._replace(temperature=temperature)


EFFECT = ThermostatEffect()

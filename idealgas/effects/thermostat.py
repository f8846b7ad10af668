"""A thermostat: a heat bath that gives discs new velocities at random times."""

import numpy as np
from pydantic import Field

from idealgas.columns import Column
from idealgas.effects.effect import EffectSpec, Sample, Start, Tables
from idealgas.effects.properties import Properties
from idealgas.effects.schedule import PositiveInSteps, SteppedTable, changes_of, steps_of, value_at
from idealgas.physics import thermostat as law
from idealgas.toml.table import Positive

THERMOSTAT_COLLISIONS = Column("thermostat_collisions", "i8")
NEXT_THERMOSTAT_COLLISION = Column("next_thermostat_collision", "f8", (), "time")
"""Time of a disc's next collision with the bath, counted from the checkpoint."""
THERMOSTAT_COLLISION_NUMBER = Column("thermostat_collision_number", "u8")
"""Number of a disc's next collision with the bath, from 0."""


class Thermostat(SteppedTable):
    """`[thermostat]`: a heat bath gives each disc a new velocity at random times, wherever it is.

    The velocity, and the spin of a disc that has one, are drawn from the distribution at the bath's temperature
    (Andersen, J. Chem. Phys. 72, 2384 (1980)).
    """

    in_steps = ("temperature",)

    temperature: PositiveInSteps = Field(
        description="temperature > 0 of the heat bath, energy, or steps [[0, T], [t, T], …]"
    )
    rate: Positive = Field(description="rate of thermostat collisions of each disc > 0, 1/time")


def _properties(tables: Tables) -> Properties:
    first, *later = steps_of(tables.own.temperature)
    return Properties(
        allows_monte_carlo=False,
        allows_time_steps=False,
        drives_discs=True,
        bath=first[1],
        later_temperatures=tuple(temperature for _, temperature in later),
        changes=tuple(time for time, _ in later),
        varies=bool(later),
        thermostat_rate=tables.own.rate,
    )


def _make(tables: Tables, start: Start) -> law.Thermostat:
    table, n = tables.own, len(start.gas)
    temperature = value_at(table.temperature, 0.0)
    thermostat = law.Thermostat(temperature, table.rate, np.uint64(start.seed), np.empty(n), np.zeros(n, np.uint64))
    law.draw_first_collisions(thermostat)
    return thermostat


EFFECT = EffectSpec(
    name="thermostat",
    field="thermostat",
    key="thermostat",
    table=Thermostat,
    description="[thermostat]: temperature, rate",
    properties=_properties,
    make=_make,
    disc_state=lambda thermostat: {
        NEXT_THERMOSTAT_COLLISION: thermostat.time,
        THERMOSTAT_COLLISION_NUMBER: thermostat.number,
    },
    counted=THERMOSTAT_COLLISIONS,
    schedule=lambda tables, start: changes_of(tables.own.temperature, 0),
    change=lambda thermostat, item, temperature: thermostat._replace(temperature=temperature),
    end_epoch=law.end_epoch,
    samples=(Sample(tables=lambda side: "[thermostat]\ntemperature = 1\nrate = 0.053\n"),),  # a tenth of all collisions
)

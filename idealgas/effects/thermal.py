"""Thermal walls: sides and segments that re-emit discs with velocities drawn at the temperature of the wall."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from pydantic import Field

from idealgas.columns import SIDES, Arrays, Column
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.effects.schedule import Change, SteppedTable, WallTemperature, changes_of, description, steps_of, value_at
from idealgas.physics import thermal as law

EMISSIONS = Column("emissions", "u8")


class ThermalSide(SteppedTable):
    """`{ thermal = T }`: a side at temperature T, which re-emits the discs that hit it."""

    in_steps = ("thermal",)

    thermal: WallTemperature = Field(
        description='temperature > 0, energy, or steps [[0, T], [t, T], …], where T may also be "reflecting"'
    )

    @property
    def action(self) -> str:
        """Short description for output."""
        return f"thermal, temperature {description(self.thermal)}"


def _temperatures(tables: Tables) -> tuple[Any, ...]:
    """Temperature of each wall by its number, starting with the sides of the box; None for walls that reflect."""
    of_sides = (side.thermal if isinstance(side, ThermalSide) else None for side in tables.sides)
    return *of_sides, *(None if wall is None else wall.temperature for wall in tables.walls)


def _number(temperature: Any) -> float:
    """Temperature in the form that the law requires: negative for a wall that reflects."""
    return temperature if isinstance(temperature, float) else -1.0


def _hot(*names: str) -> str:
    return "".join(f"{name} = {{ thermal = 1 }}\n" for name in names)


class ThermalEffect(Effect[law.Thermal]):
    """Thermal walls: sides and segments that re-emit discs with velocities drawn at the temperature of the wall."""

    name = "thermal walls"
    field = "thermal"
    side = ThermalSide
    side_text = "{ thermal = T }"
    samples = (BenchmarkSample(box=lambda side: _hot(*SIDES)),)
    sample_together = BenchmarkSample()

    def properties(self, tables: Tables) -> Properties | None:
        temperatures = _temperatures(tables)
        if not any(temperatures):
            return None
        first = (value_at(temperature, 0.0) for temperature in temperatures)
        later = [step for temperature in temperatures for step in steps_of(temperature)[1:]]
        return Properties(
            allows_monte_carlo=False,
            allows_time_steps=not later,
            has_rough_walls=True,
            emits=tuple(t if isinstance(t, float) else None for t in first),
            later_temperatures=tuple(t for _, t in later if isinstance(t, float)),
            changes=tuple(time for time, _ in later),
            varies=bool(later),
        )

    def make(self, tables: Tables, start: GasAtStart) -> law.Thermal:
        temperature = np.array([_number(value_at(t, 0.0)) for t in _temperatures(tables)])
        return law.Thermal(temperature, np.uint64(start.seed), np.zeros(len(start.gas), np.uint64))

    def disc_state(self, thermal: law.Thermal) -> Arrays:
        return {EMISSIONS: thermal.emissions}

    def gives_energy(self, thermal: law.Thermal) -> bool:
        return True

    def schedule(self, tables: Tables, _: GasAtStart) -> Iterator[Change]:
        for wall, temperature in enumerate(_temperatures(tables)):
            for change in changes_of(temperature, wall):
                yield change._replace(value=_number(change.value))

    def change(self, thermal: law.Thermal, wall: int, temperature: float) -> law.Thermal:
        thermal.temperature[wall] = temperature
        return thermal


EFFECT = ThermalEffect()

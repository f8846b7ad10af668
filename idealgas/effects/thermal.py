"""Thermal walls: sides and segments that re-emit the discs that hit them, at a temperature."""

import numpy as np
from pydantic import Field

from idealgas.columns import SIDES, Column
from idealgas.effects.effect import EffectSpec, Sample, Start, Tables
from idealgas.effects.properties import Properties
from idealgas.physics import thermal as law
from idealgas.toml.table import Positive, Table

EMISSIONS = Column("emissions", "u8")


class ThermalSide(Table):
    """`{ thermal = T }`: a side that emits the discs it takes at a temperature."""

    thermal: Positive = Field(description="temperature > 0, energy")


def _temperatures(tables: Tables) -> tuple[float | None, ...]:
    """Temperature of each wall by its number, sides of the box first; None for those that reflect."""
    of_sides = (side.thermal if isinstance(side, ThermalSide) else None for side in tables.sides)
    return *of_sides, *(None if wall is None else wall.temperature for wall in tables.walls)


def _properties(tables: Tables) -> Properties | None:
    temperatures = _temperatures(tables)
    if not any(temperatures):
        return None
    return Properties(allows_monte_carlo=False, has_rough_walls=True, emits=temperatures)


def _make(tables: Tables, start: Start) -> law.Thermal:
    temperature = np.array([-1.0 if t is None else t for t in _temperatures(tables)])
    return law.Thermal(temperature, np.uint64(start.seed), np.zeros(len(start.gas), np.uint64))


def _hot(*names: str) -> str:
    return "".join(f"{name} = {{ thermal = 1 }}\n" for name in names)


EFFECT = EffectSpec(
    name="thermal walls",
    field="thermal",
    side=ThermalSide,
    side_text="{ thermal = T }",
    properties=_properties,
    make=_make,
    disc_state=lambda thermal: {EMISSIONS: thermal.emissions},
    gives_energy=lambda thermal: True,
    samples=(Sample(box=lambda side: _hot(*SIDES)),),
    sample_together=Sample(box=lambda side: _hot("bottom")),
)

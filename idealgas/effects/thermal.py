"""Thermal walls: sides and segments that re-emit the discs that hit them, at a temperature."""

import numpy as np
from pydantic import Field

from idealgas.columns import SIDES, Column
from idealgas.effects.effect import EffectSpec, Sample, Start, Tables
from idealgas.effects.properties import ActiveEffect, Properties
from idealgas.physics import thermal as law
from idealgas.toml.issues import Key
from idealgas.toml.table import Positive, Table

NAME = "thermal walls"

EMISSIONS = Column("emissions", "u8")


class ThermalSide(Table):
    """`{ thermal = T }`: a side that emits the discs it takes at a temperature."""

    thermal: Positive = Field(description="temperature > 0, energy")


def _temperatures(tables: Tables) -> tuple[float | None, ...]:
    """Temperature of each wall by its number, sides of the box first; None for those that reflect."""
    of_sides = (side.thermal if isinstance(side, ThermalSide) else None for side in tables.sides)
    return *of_sides, *(None if wall is None else wall.temperature for wall in tables.walls)


def _find(tables: Tables) -> ActiveEffect | None:
    """Thermal walls, if there are any; segments stand for themselves among the keys of a scene."""
    temperatures = _temperatures(tables)
    if not any(temperatures):
        return None
    of_sides = temperatures[: len(tables.sides)]
    keys: tuple[Key, ...] = tuple(("box", name) for name, there in zip(SIDES, of_sides, strict=False) if there)
    properties = Properties(allows_monte_carlo=False, has_rough_walls=True, emits=temperatures)
    return ActiveEffect(NAME, keys, properties)


def _make(tables: Tables, start: Start) -> law.Thermal | None:
    temperature = np.array([-1.0 if t is None else t for t in _temperatures(tables)])
    if not (temperature >= 0).any():
        return None
    return law.Thermal(temperature, np.uint64(start.seed), np.zeros(len(start.gas), np.uint64))


def _hot(*names: str) -> str:
    return "".join(f"{name} = {{ thermal = 1 }}\n" for name in names)


EFFECT = EffectSpec(
    name=NAME,
    field="thermal",
    side=ThermalSide,
    side_text="{ thermal = T }",
    find=_find,
    make=_make,
    disc_state=lambda thermal: {EMISSIONS: thermal.emissions},
    gives_energy=lambda thermal: True,
    samples=(Sample(box=lambda side: _hot(*SIDES)),),
    sample_together=Sample(box=lambda side: _hot("bottom")),
)

"""Thermal walls: sides, and segments, that emit the discs they take at a temperature."""

from collections.abc import Iterable

from pydantic import Field

from idealgas.scene.properties import Effect, Properties
from idealgas.scene.tables.wall import Wall
from idealgas.sides import SIDES
from idealgas.toml.error import Key
from idealgas.toml.table import Positive, Table

NAME = "thermal walls"


class ThermalSide(Table):
    """`{ thermal = T }`: a side that emits the discs it takes at a temperature."""

    thermal: Positive = Field(description="temperature > 0, energy")


def wall_temperatures(sides: Iterable[object], walls: Iterable[Wall | None]) -> tuple[float | None, ...]:
    """By the numbers of the walls, sides of the box first; None for those that reflect."""
    of_sides = (side.thermal if isinstance(side, ThermalSide) else None for side in sides)
    return *of_sides, *(None if wall is None else wall.temperature for wall in walls)


def effect(sides: Iterable[object], walls: Iterable[Wall | None]) -> Effect | None:
    """What thermal walls change, if there are any; segments stand for themselves among the keys of a scene."""
    temperatures = wall_temperatures(sides, walls)
    if not any(temperatures):
        return None
    keys: tuple[Key, ...] = tuple(("box", name) for name, there in zip(SIDES, temperatures, strict=False) if there)
    return Effect(NAME, keys, Properties(allows_monte_carlo=False, has_rough_walls=True, emits=temperatures))

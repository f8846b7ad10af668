"""Wall segments that let discs of some species pass, from both sides or from one."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from idealgas.columns import OUTWARD, SIDES
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.physics import permeable as law
from idealgas.toml.issues import Issue


def _to_left(wall: Any) -> float:
    """Return a positive number if the side from which a wall lets discs pass is on the left of the wall.

    Left and right are as seen from start to end. The number is negative for the right, and 0 if the wall is parallel to
    the direction of passage.
    """
    outward = OUTWARD[SIDES.index(wall.permeable_from)]
    return (wall.end[0] - wall.start[0]) * outward[1] - (wall.end[1] - wall.start[1]) * outward[0]


def _passage(wall: Any) -> int:
    """Sides from which a wall lets those discs pass to which it is permeable."""
    if wall.permeable_from is None:
        return law.OPEN
    return law.FROM_LEFT if _to_left(wall) > 0 else law.FROM_RIGHT


def _door(x: float, height: float) -> str:
    """`[[wall]]` table of a wall from the bottom up to a height (length) that lets all discs pass from the left."""
    return f'[[wall]]\nfrom = [{x}, 0]\nto = [{x}, {height}]\npermeable_from = "left"\n'


class PermeableEffect(Effect[law.Permeable]):
    """Wall segments that let discs of some species pass, from both sides or from one."""

    name = "permeable walls"
    field = "permeable"
    samples = (BenchmarkSample(tables=lambda side: _door(side / 4, side)),)
    sample_together = BenchmarkSample(tables=lambda side: _door(side / 4, 9.0))

    def properties(self, tables: Tables) -> Properties | None:
        walls = [wall for wall in tables.walls if wall is not None and wall.is_permeable]
        return Properties(one_way=any(wall.permeable_from for wall in walls)) if walls else None

    def check(self, tables: Tables) -> Iterator[Issue]:
        """Yield issues of walls without a side `permeable_from`, and of gates that let discs pass from one side."""
        for wall in tables.walls:
            if wall is None or wall.permeable_from is None:
                continue
            key, got = wall.key("permeable_from"), f'"{wall.permeable_from}"'
            if wall.via is not None:
                yield Issue(
                    (key, wall.key("via")),
                    "an arc cannot be permeable from one side only",
                    got,
                    "a straight wall, or both sides",
                )
            elif wall.start != wall.end and _to_left(wall) == 0:
                sides = SIDES[2:] if wall.permeable_from in SIDES[:2] else SIDES[:2]
                yield Issue((key,), f"not a side of {wall.title}", got, " or ".join(f'"{side}"' for side in sides))
            if wall.absences:
                keys = (key, wall.key("opens_at"), wall.key("closes_at"))
                allowed = "a wall that is always present; if necessary, add a gate at the same place"
                yield Issue(keys, "a gate that lets discs pass from one side", got, allowed)

    def make(self, tables: Tables, start: GasAtStart) -> law.Permeable:
        gas = start.gas
        names = np.array(gas.species_names)
        passage = np.full((len(tables.walls), len(names)), law.SOLID, np.uint8)
        for wall, row in zip(tables.walls, passage, strict=True):
            if wall.is_permeable:
                row[slice(None) if wall.permeable_to is None else np.isin(names, wall.permeable_to)] = _passage(wall)
        return law.Permeable(gas.species.astype(np.uint16), passage)


EFFECT = PermeableEffect()

"""Periodic sides: a disc that leaves through one side enters through the opposite side."""

from collections.abc import Iterator

import numpy as np

from idealgas.columns import IMAGE, SIDES, Arrays, sides_across
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.physics import periodic as law
from idealgas.toml.issues import Issue, Key

PERIODIC = "periodic"
"""Word for a periodic side of the box in a scene."""


def _joined(*names: str) -> str:
    return "".join(f'{name} = "periodic"\n' for name in names)


class PeriodicEffect(Effect[law.Periodic]):
    """Periodic sides: a disc that leaves through one side enters through the opposite side."""

    name = "periodic sides"
    field = "periodic"
    side = PERIODIC
    side_text = f'"{PERIODIC}"'
    shearable = True
    samples = (BenchmarkSample(box=lambda side: _joined(*SIDES)),)
    sample_together = BenchmarkSample(box=lambda side: _joined("left", "right"))

    def properties(self, tables: Tables) -> Properties | None:
        sides = tables.sides
        if PERIODIC not in sides:
            return None
        return Properties(allows_monte_carlo=False, periodic=(sides[0] == PERIODIC, sides[2] == PERIODIC))

    def check(self, tables: Tables) -> Iterator[Issue]:
        """Yield an issue for each periodic side whose opposite side is not periodic."""
        for axis in range(2):
            names = [SIDES[side] for side in sides_across(axis)]
            periodic = [tables.sides[side] == PERIODIC for side in sides_across(axis)]
            if any(periodic) and not all(periodic):
                side_name, opposite = names if periodic[0] else names[::-1]
                keys: tuple[Key, ...] = (("box", side_name), ("box", opposite))
                yield Issue(
                    keys,
                    "periodic on one side only",
                    f"{opposite} not periodic",
                    f"{side_name} and {opposite} periodic",
                )

    def make(self, tables: Tables, start: GasAtStart) -> law.Periodic:
        image = np.zeros((len(start.gas), *IMAGE.shape), IMAGE.dtype)
        return law.Periodic(tables.sides[0] == PERIODIC, tables.sides[2] == PERIODIC, *tables.size, image)

    def disc_state(self, periodic: law.Periodic) -> Arrays:
        return {IMAGE: periodic.image}


EFFECT = PeriodicEffect()

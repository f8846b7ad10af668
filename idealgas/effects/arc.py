"""Arcs and circles among the walls inside the box."""

import numpy as np

from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.jit import aligned
from idealgas.physics import arc as law
from idealgas.physics.arc_geometry import Arc

FLATTEST = 100.0
"""Largest radius of an arc in units of the box's longer side; rounding errors of contacts grow with this radius."""


def make_arcs(arcs_of_walls: list[Arc | None]) -> np.recarray:
    """Return the arcs (W,) ARC of all W walls inside the box.

    arcs_of_walls: the arc of each wall, None for a straight wall.
    """
    arcs = aligned(len(arcs_of_walls), law.ARC)
    for k, arc in enumerate(arcs_of_walls):
        if arc is not None:
            arcs[k] = tuple(arc)
    return arcs


def _circle(side: float) -> str:
    """`[[wall]]` table of a circle in a square box with the given side length."""
    low, high, middle = 0.1 * side, 0.9 * side, 0.5 * side
    return f"[[wall]]\nfrom = [{low}, {middle}]\nto = [{low}, {middle}]\nvia = [{high}, {middle}]\n"


class ArcEffect(Effect[np.recarray]):
    """Arcs and circles among the walls inside the box."""

    name = "arcs"
    field = "arcs"
    samples = (BenchmarkSample(tables=_circle),)
    sample_together = BenchmarkSample(tables=lambda side: "[[wall]]\nfrom = [2, 2]\nto = [8, 2]\nvia = [5, 5]\n")

    def properties(self, tables: Tables) -> Properties | None:
        return Properties() if any(wall is not None and wall.arc for wall in tables.walls) else None

    def make(self, tables: Tables, _: GasAtStart) -> np.recarray:
        return make_arcs([wall.arc for wall in tables.walls])


EFFECT = ArcEffect()

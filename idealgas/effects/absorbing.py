"""Wall segments that absorb discs: holes through which discs leave the gas."""

import numpy as np

from idealgas.columns import Kind
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties


def _hole(side: float) -> str:
    """`[[wall]]` table of a hole that is removed at t = 5 in a square box with the given side length."""
    return f"[[wall]]\nfrom = [{side / 2}, 9.5]\nto = [{side / 2 + 20}, 9.5]\nabsorbing = true\nopens_at = 5\n"


class AbsorbingEffect(Effect[np.ndarray]):
    """Wall segments that absorb discs: holes through which discs leave the gas."""

    name = "absorbing walls"
    field = "absorbing"
    events = Kind.ESCAPED
    samples = (BenchmarkSample(tables=_hole),)

    def properties(self, tables: Tables) -> Properties | None:
        return Properties(escapes=True) if any(wall is not None and wall.absorbing for wall in tables.walls) else None

    def make(self, tables: Tables, _: GasAtStart) -> np.ndarray:
        return np.array([wall.absorbing for wall in tables.walls])

    def gives_energy(self, absorbing: np.ndarray) -> bool:
        return True


EFFECT = AbsorbingEffect()

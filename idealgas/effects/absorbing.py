"""Wall segments that absorb discs: holes through which discs leave the gas."""

import numpy as np

from idealgas.columns import Column
from idealgas.effects.effect import EffectSpec, Sample, Start, Tables
from idealgas.effects.properties import Properties

ESCAPED = Column("escaped", "i8")


def _properties(tables: Tables) -> Properties | None:
    return Properties(escapes=True) if any(wall is not None and wall.absorbing for wall in tables.walls) else None


def _make(tables: Tables, _: Start) -> np.ndarray:
    return np.array([wall.absorbing for wall in tables.walls])


def _hole(side: float) -> str:
    """Table `[[wall]]` of a hole that is removed at t = 5, in a square box; side: of the box, length."""
    return f"[[wall]]\nfrom = [{side / 2}, 9.5]\nto = [{side / 2 + 20}, 9.5]\nabsorbing = true\nopens_at = 5\n"


EFFECT = EffectSpec(
    name="absorbing walls",
    field="absorbing",
    properties=_properties,
    make=_make,
    gives_energy=lambda absorbing: True,
    counted=ESCAPED,
    samples=(Sample(tables=_hole),),
)

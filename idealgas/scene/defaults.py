"""Defaults that follow from several tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from idealgas.scene.tables.discs import Disc, Species
    from idealgas.scene.tables.run import Run


def mean_speed(species: Sequence[Species], disc: Sequence[Disc]) -> float:
    """Expected mean speed of the discs at the start, length/time."""
    speeds = [math.hypot(*d.velocity) for d in disc]
    for s in species:
        if s.velocities is not None:
            speeds += [math.hypot(*v) for v in s.velocities]
    spread = sum(
        s.count * (s.speed or math.sqrt(math.pi * (s.temperature or 0.0) / (2 * s.mass)))
        for s in species
        if s.velocities is None
    )
    return (sum(speeds) + spread) / (len(disc) + sum(s.count for s in species))


def reference_speed(run: Run, largest: float) -> float:
    """As given, or five times the largest speed at the start."""
    return run.v_ref or 5.0 * largest

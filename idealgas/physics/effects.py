"""The effects of a scene as the engines take them: one field each, None if the scene does not call for it.

A field is only ever handed on as an argument: numba prunes `if gravity is not None` in a function whose argument it is,
so no machine code of an absent effect is made.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from idealgas.physics import periodic, piston, restitution, wall
from idealgas.physics.gravity import Gravity
from idealgas.physics.periodic import Periodic
from idealgas.physics.restitution import Restitution
from idealgas.physics.rotation import Rotation
from idealgas.physics.thermal import Thermal


class Effects(NamedTuple):
    """segments: (S,) SEGMENT. piston: (1,) PISTON.

    wall_energy: (walls,) f8, energy that each wall gave to discs; where any wall can give some.
    """

    gravity: Gravity | None = None
    periodic: Periodic | None = None
    segments: np.recarray | None = None
    rotation: Rotation | None = None
    restitution: Restitution | None = None
    thermal: Thermal | None = None
    piston: np.ndarray | None = None
    wall_energy: np.ndarray | None = None


AT_BEGIN: dict[str, Callable[[Any, float], None]] = {"periodic": periodic.begin_epoch, "segments": wall.begin_epoch}
"""What happens to effects when an epoch begins at a time."""

AT_END: dict[str, Callable[[Any, float], None]] = {
    "restitution": restitution.end_epoch,
    "piston": piston.end_epoch,
}
"""What happens to effects when an epoch of some length ends."""

CHANGES: dict[str, Callable[[Any, float], float]] = {"segments": wall.next_change}
"""When effects next change by themselves after a time: an epoch ends there."""


def begin_epoch(effects: Effects, time: float) -> None:
    """Make the effects ready for an epoch that begins at a time."""
    for name, begin in AT_BEGIN.items():
        if (effect := getattr(effects, name)) is not None:
            begin(effect, time)


def end_epoch(effects: Effects, length: float) -> None:
    """Count all local times from the end of an epoch."""
    for name, end in AT_END.items():
        if (effect := getattr(effects, name)) is not None:
            end(effect, length)


def next_change(effects: Effects, time: float) -> float:
    """When an effect next changes by itself after a time; infinite if none does."""
    present = ((getattr(effects, name), change) for name, change in CHANGES.items())
    return min((change(effect, time) for effect, change in present if effect is not None), default=math.inf)

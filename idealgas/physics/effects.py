"""The effects of a scene as the engines take them: one field each, None if the scene does not call for it.

A field is only ever handed on as an argument: numba prunes `if gravity is not None` in a function whose argument it is,
so no machine code of an absent effect is made.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.physics.motion import Gravity
from idealgas.physics.periodic import Periodic
from idealgas.physics.piston import advance_piston
from idealgas.physics.restitution import Restitution
from idealgas.physics.rotation import Rotation
from idealgas.physics.thermal import Thermal


class Effects(NamedTuple):
    """segments: (S,) SEGMENT. piston: (1,) PISTON.

    ledger: (walls,) f8, energy that each wall gave to discs; where any wall can give some.
    """

    gravity: Gravity | None = None
    periodic: Periodic | None = None
    segments: np.recarray | None = None
    rotation: Rotation | None = None
    restitution: Restitution | None = None
    thermal: Thermal | None = None
    piston: np.ndarray | None = None
    wall_energy: np.ndarray | None = None


def copy_of(periodic: Periodic | None) -> Periodic | None:
    """One whose counts can change without changing the original's."""
    if periodic is None:
        return None
    return periodic._replace(boundary_crossings=periodic.boundary_crossings.copy(), image=periodic.image.copy())


def time_of_next_gate(segments: np.recarray | None, time: float) -> float:
    """When a gate next opens or closes after a time; infinite if none does."""
    if segments is None:
        return math.inf
    switches = np.concatenate((segments.opens, segments.closes))
    return float(switches[switches > time].min(initial=math.inf))


def begin_epoch(effects: Effects, time: float) -> None:
    """Set the gates as they are from a time on, and count ways through joined sides from there."""
    if effects.segments is not None:
        open_now = (effects.segments.opens <= time) & (time < effects.segments.closes)
        effects.segments.active[:] = ~open_now
    if effects.periodic is not None:
        effects.periodic.boundary_crossings[:] = 0


def end_epoch(effects: Effects, length: float) -> None:
    """Count all local times from the end of an epoch."""
    if effects.restitution is not None:
        effects.restitution.last[:] -= length
    if effects.piston is not None:
        advance_piston(effects.piston[0], length)
        effects.piston[0].t = 0.0

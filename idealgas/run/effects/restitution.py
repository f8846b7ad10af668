"""Inelastic collisions in a run: when each disc last collided, and the energy that is lost."""

import math

import numpy as np

from idealgas.events import Column
from idealgas.physics.effects import Effects
from idealgas.physics.restitution import Restitution
from idealgas.run.effects.slice import Slice
from idealgas.scene import Scene
from idealgas.state import Gas

LAST_COLLISION = Column("last_collision", "f8", (), "time")
"""Counted from the checkpoint."""


def _make(scene: Scene, gas: Gas) -> Restitution | None:
    table = scene.restitution
    if table is None or table.elastic:
        return None
    return Restitution(table.normal, table.wall, scene.contact_duration, np.full(len(gas), -math.inf))


def _conserves(effects: Effects) -> bool:
    """What discs lose at walls is on the account of the walls, but for one that has energy of its own: a piston."""
    restitution, piston = effects.restitution, effects.piston
    if restitution is None:
        return True
    return not restitution.normal < 1 and not (restitution.wall < 1 and piston is not None and piston[0].m > 0)


SLICE = Slice(
    "restitution",
    _make,
    disc_state=lambda restitution: {LAST_COLLISION: restitution.last},
    gives_energy=lambda restitution: restitution.wall < 1,
    loses_energy=lambda restitution: True,
    conserves=_conserves,
)

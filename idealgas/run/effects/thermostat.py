"""A thermostat in a run: each disc's next kick, and how many there were."""

import numpy as np

from idealgas.events import Column
from idealgas.physics.thermostat import Thermostat, draw_first_kicks
from idealgas.run.effects.slice import Slice
from idealgas.scene import Scene
from idealgas.state import Gas

KICKS = Column("kicks", "i8")
NEXT_KICK = Column("next_kick", "f8", (), "time")
"""Counted from the checkpoint."""
KICK_NUMBER = Column("kick_number", "u8")
"""Of each disc's next kick, from 0."""


def _make(scene: Scene, gas: Gas) -> Thermostat | None:
    if (table := scene.thermostat) is None:
        return None
    n, seed = len(gas), np.uint64(scene.scene.seed)
    thermostat = Thermostat(table.temperature, table.rate, seed, np.empty(n), np.zeros(n, np.uint64))
    draw_first_kicks(thermostat)
    return thermostat


SLICE = Slice(
    "thermostat",
    _make,
    disc_state=lambda thermostat: {NEXT_KICK: thermostat.time, KICK_NUMBER: thermostat.number},
    counted=KICKS,
)

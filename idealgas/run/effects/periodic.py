"""Periodic sides in a run: the image that every disc is in."""

import numpy as np

from idealgas.events import IMAGE
from idealgas.physics.periodic import Periodic
from idealgas.run.effects.slice import Slice
from idealgas.scene import Scene
from idealgas.state import Gas


def _make(scene: Scene, gas: Gas) -> Periodic | None:
    if not any(scene.box.periodic):
        return None
    crossings, image = (np.zeros((len(gas), *IMAGE.shape), IMAGE.dtype) for _ in range(2))
    return Periodic(*scene.box.periodic, *scene.box.size, crossings, image)


SLICE = Slice("periodic", _make, disc_state=lambda periodic: {IMAGE: periodic.image})

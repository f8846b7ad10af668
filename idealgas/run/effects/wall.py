"""Wall segments and gates in a run: their arrays. Whether a gate is there follows from the time."""

import math

import numpy as np

from idealgas.jit import aligned
from idealgas.physics.wall import SEGMENT
from idealgas.run.effects.slice import Slice
from idealgas.scene import Scene
from idealgas.state import Gas


def make_segments(
    start: np.ndarray, end: np.ndarray, opens: np.ndarray | float = math.inf, closes: np.ndarray | float = math.inf
) -> np.recarray:
    """(S,) SEGMENT at time 0. start, end: (S, 2). opens, closes: times from and until which each is absent."""
    segments = aligned(len(start), SEGMENT)
    segments.x, segments.y = start.T
    segments.length = np.hypot(*(end - start).T)
    segments.tx, segments.ty = ((end - start) / segments.length[:, None]).T
    segments.opens, segments.closes = opens, closes
    segments.active = segments.opens > 0
    return segments


def _make(scene: Scene, _: Gas) -> np.recarray | None:
    if not scene.wall:
        return None
    start, end, absence = (
        np.array([getattr(wall, name) for wall in scene.wall]) for name in ("start", "end", "absence")
    )
    return make_segments(start, end, *absence.T)


SLICE = Slice("segments", _make)

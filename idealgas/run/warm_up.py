"""Compiling the machine code of a scene in advance; it is cached on disk for later runs."""

import tempfile
from pathlib import Path

from idealgas.run.simulate import simulate
from idealgas.scene import Scene


def warm_up(scene: Scene) -> float:
    """Compile the machine code of a scene and return the seconds it took; almost none if it was cached.

    The scene runs up to its first event, and its log is deleted. Raises the same errors as `simulate`.
    """
    first = {"events": 1, "collisions_per_disc": None, "trials": None}
    short = scene.model_copy(update={"run": scene.run.model_copy(update=first)})
    with tempfile.TemporaryDirectory(prefix="idealgas-warm-up-") as folder:
        return simulate(short, Path(folder) / "run.h5").compile_seconds

"""Compiling beforehand: the machine code that a scene takes, kept on disk for later runs."""

import tempfile
from pathlib import Path

from idealgas.run.simulate import simulate
from idealgas.scene import Scene


def warm_up(scene: Scene) -> float:
    """Compile what a run of a scene takes, and return the seconds that this took; next to none if it was there.

    The scene runs up to its first event, and its log is thrown away. Raises what `simulate` raises.
    """
    first = {"events": 1, "collisions_per_disc": None, "trials": None}
    short = scene.model_copy(update={"run": scene.run.model_copy(update=first)})
    with tempfile.TemporaryDirectory(prefix="idealgas-warm-up-") as folder:
        return simulate(short, Path(folder) / "run.h5").compile_seconds

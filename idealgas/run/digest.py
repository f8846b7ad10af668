"""Digests of short runs, which are the same on every machine."""

import tempfile
from pathlib import Path

from idealgas.log.digest import digest
from idealgas.log.reader import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import load_scene

EVENTS = 20_000
"""Number of events after which a run ends, unless the scene ends it before."""


def scene_digest(path: Path) -> str:
    """Digest of the log of a scene's first events.

    Raises:
        UserError: if the scene cannot be read or run.
    """
    with tempfile.TemporaryDirectory() as folder:
        log_path = Path(folder) / "run.h5"
        simulate(load_scene(path, [f"run.events={EVENTS}"]), log_path)
        with open_log(log_path) as log:
            return digest(log)

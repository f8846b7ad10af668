"""Digests of the logs of short runs; a digest is the same on every machine."""

import tempfile
from pathlib import Path

from idealgas.log.digest import digest
from idealgas.log.reader import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import load_scene

EVENTS = 20_000
"""Number of events after which a run ends, unless the scene ends it earlier."""


def scene_digest(path: Path) -> str:
    """Return the digest of a log that contains the first events of a scene.

    Raises:
        UserError: the scene cannot be read or run.
    """
    with tempfile.TemporaryDirectory() as folder:
        log_path = Path(folder) / "run.h5"
        simulate(load_scene(path, [f"run.events={EVENTS}"]), log_path)
        with open_log(log_path) as log:
            return digest(log)

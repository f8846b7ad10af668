"""From a scene to a finished log: the only part that imports scene, engine and log."""

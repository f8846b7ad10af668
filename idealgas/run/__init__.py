"""From a scene to a finished log: the one place that knows scene, engine and log."""

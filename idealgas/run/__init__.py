"""Running scenes: from a scene to a finished log. This is the only package that imports scene, engine and log."""

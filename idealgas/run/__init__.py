"""Running scenes: from a scene to a finished log. Only this package imports all three of scene, engine and log."""

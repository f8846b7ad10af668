"""The tables of a scene, one file a table."""

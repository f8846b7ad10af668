"""Export logs to files that other programs can read."""

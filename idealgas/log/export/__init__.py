"""Export of logs to files that other programs read."""
